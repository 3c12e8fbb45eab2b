# SPDX-License-Identifier: BSD-3-Clause
"""Names as plants write them, and the roles and units that they mean."""

from time import process_time

import pytest

from sklvalve.recording.tags import bare, read_name, read_unit, split_unit

ROLES = {
    "command": [
        "CV",
        "OP",
        "FIC-101.OP",
        "FIC101.CO",
        "LIC7/MV",
        "fic101_out",
        "Stellgröße",
        "Stellsignal Y12",
        "sygnał sterujący",
        "commande vanne",
        "orden",
        "FV-101",
        "VA_A1",
        "controller output",
        "LC74_20CV",
    ],
    "opening": [
        "X",
        "ZI101",
        "ZT-101.PV",
        "FV101.POS",
        "XT101",
        "Ventilstellung",
        "Hub Ventil",
        "Położenie zaworu",
        "ouverture",
        "recopie",
        "apertura",
        "valve position",
        "StemTravel",
        "Xn",
    ],
    "flow": [
        "F",
        "FI-7",
        "FT101",
        "41FI203.PV",
        "FIC101.PV",
        "Durchfluss",
        "Volumenstrom",
        "Przepływ wody",
        "débit",
        "Caudal",
        "FlowRate",
        "FS_A1",
        "pv",
        "Q [m3/h]",
        "F74_00_tph",
    ],
    "p1": [
        "P1",
        "PT-101 inlet",
        "PI_up",
        "Vordruck",
        "Druck vor Ventil",
        "Ciśnienie przed",
        "pression amont",
        "presión entrada",
        "P74_00",
    ],
    "p2": [
        "P2",
        "PT_out",
        "PI_down",
        "Hinterdruck",
        "Druck nach Ventil",
        "Ciśnienie za zaworem",
        "pression aval",
        "presión salida",
        "P2n",
    ],
    "pressure": ["PT-105", "PI7.PV", "PS_A2", "Druck", "X9 [bar(g)]"],
    "temperature": ["T1", "TI-101", "TT7.PV", "Temperatur", "température", "T74_00_degC"],
    "setpoint": ["SP", "FIC101.SP", "Sollwert", "wartość zadana", "consigne", "consigna"],
    "process_value": ["LIC7.PV", "PIC101.PV", "LT-3", "Füllstand", "poziom", "TIC5.PV"],
    "actuator_pressure": ["actuator pressure", "Antrieb Druck"],
    "supply_pressure": ["instrument air pressure", "Zuluft Druck"],
    "simulated_flow": ["F_sim", "flow simulated"],
    "simulated_opening": ["X_sim", "model opening"],
    None: ["PDT-5", "delta p", "Zähler", "alpha", "123"],
}
UNITS = {
    "m3/h": ["m3/h", "m³/h", "M3/HR", "cbm/h", "[m3/h]"],
    "%": ["%", "pct", "Prozent", "(%)"],
    "degC": ["°C", "degC", "C", "deg C", "℃"],
    "t/h": ["t/h", "tph"],
    "l/min": ["l/min", "lpm"],
    "mbar": ["mbar", "hPa"],
}
PRESSURES = [
    ("bar(g)", "bar", True),
    ("barg", "bar", True),
    ("bar g", "bar", True),
    ("barü", "bar", True),
    ("psig", "psi", True),
    ("kPa (g)", "kPa", True),
    ("bara", "bar", False),
    ("kPa abs", "kPa", False),
    ("bar(a)", "bar", False),
    ("MPa", "MPa", None),
]


@pytest.mark.parametrize(("role", "name"), [(role, name) for role, names in ROLES.items() for name in names])
def test_role(role, name):
    assert read_name(name).role == role


@pytest.mark.parametrize("name", ["pv", "FV-101", "PT-105", "VA_A1", "F_sim", "PDT-5", "Y"])
def test_what_may_mean_something_else_is_not_sure(name):
    assert not read_name(name).sure


@pytest.mark.parametrize(
    ("name", "loop"),
    [
        ("FIC-101.PV", "101"),
        ("2111FIC40102C.OP", "40102C"),
        ("LC74_20X", "74"),
        ("VA_A1", "A1"),
        ("P1", ""),
        ("F", ""),
    ],
)
def test_loop(name, loop):
    assert read_name(name).loop == loop


@pytest.mark.parametrize(("unit", "text"), [(unit, text) for unit, texts in UNITS.items() for text in texts])
def test_unit(unit, text):
    assert read_unit(text).unit == unit


@pytest.mark.parametrize(("text", "unit", "gauge"), PRESSURES)
def test_pressure_above_the_atmosphere(text, unit, gauge):
    assert read_unit(text) == (unit, gauge)


@pytest.mark.parametrize("text", ["furlong", "", "Nm3/h", "kg/cm2", "g", "a"])
def test_unknown_unit(text):
    assert read_unit(text) is None


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("FIC101.PV [m3/h]", ("FIC101.PV", "m3/h")),
        ("P (bar(g))", ("P", "bar(g)")),
        ("Druck vor Ventil [bar(g)]", ("Druck vor Ventil", "bar(g)")),
        ("P74_00_kPa", ("P74_00", "kPa")),
        ("Valve position %", ("Valve position", "%")),
        ("F [Nm3/h]", ("F", "Nm3/h")),
        ("t_s", ("t_s", "")),
        ("FIC101 (old)", ("FIC101 (old)", "")),
        ("P.m", ("P.m", "")),
    ],
)
def test_unit_in_a_name(name, parts):
    assert split_unit(name) == parts


def test_brackets_go():
    assert [bare(text) for text in ("[kPa]", "bar(g)", "(%)", "[bar(g)]", "")] == [
        "kPa",
        "bar(g)",
        "%",
        "bar(g)",
        "",
    ]


PATHS = ["\\\\SRV\\PLANT\\", "Plant/Area/", "Plant/Pressure reduction/", "ns=2;s=Unit 7.", "Area1."]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    ("tag", "role"),
    [
        ("FIC-101.PV", "flow"),
        ("FIC101/PV", "flow"),
        ("FIC101.OP", "command"),
        ("FIC101.SP", "setpoint"),
        ("TIC-101.PV", "process_value"),
        ("TIC7.PV [degF]", "process_value"),
        ("TT101", "temperature"),
        ("FIC101.MODE", None),
    ],
)
def test_a_path_before_a_tag_says_nothing(path, tag, role):
    reading = read_name(path + tag)
    assert reading.role == role
    assert reading.loop == read_name(tag).loop
    assert reading.sure == (role is not None)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("MODE", None),
        ("FIC101.MODE", None),
        ("LC_7.Mode", None),
        ("FIC101.AUTO", None),
        ("FIC101 Status", None),
        ("PUMP7_Status", None),
        ("power_w", None),
        ("power_W", None),
        ("motor power [W]", None),
        ("LC7.W", "setpoint"),
        ("w", "setpoint"),
        ("Heating Coil Valve Control Signal", "command"),
        ("AHU: Cooling Coil Valve Control Signal", "command"),
        ("Valve signal", "command"),
        ("AHU: Supply Air Temperature Heating Set Point", "setpoint"),
        ("Duct pressure set point [bar]", "setpoint"),
        ("setpoint_position_%", "command"),
        ("feedback_position_%", "opening"),
        ("AHU: Supply Air Duct Static Pressure", "pressure"),
        ("TIC101.PV [degF]", "process_value"),
        ("PIC101.PV [bar]", "process_value"),
        ("Reactor temperature TIC101.PV", "process_value"),
        ("TIC-101 Process Value", "process_value"),
        ("FIC-101 Process Variable", "flow"),
        ("FIC101.OP [bar]", "command"),
    ],
)
def test_role_of_what_was_taken_for_another(name, role):
    assert read_name(name).role == role


@pytest.mark.parametrize(
    "text", ["degF", "deg F", "deg_F", "Deg. F", "°F", "degrees F", "degree F", "Fahrenheit", "(deg F)", "F"]
)
def test_fahrenheit(text):
    assert read_unit(text).unit == "degF"


@pytest.mark.parametrize("name", ["TI7 (deg F)", "TI7 deg F", "TI7_deg_F", "TI7.degF", "TI7 [°F]", "TI7 °F"])
def test_fahrenheit_in_a_name(name):
    rest, unit = split_unit(name)
    assert (rest, read_unit(unit).unit) == ("TI7", "degF")


def test_a_cell_of_thousands_of_brackets_is_a_name_without_a_unit_at_once():
    name = 10_000 * "["
    began = process_time()
    assert split_unit(name) == (name, "")
    # 5 s for each before long names were left alone
    assert process_time() - began < 1.0
    assert split_unit("a" * 400 + " [kPa]") == ("a" * 400, "kPa")
