# SPDX-License-Identifier: BSD-3-Clause
"""Words and letters by which plants name signals: English, German, Polish, French, Spanish; no accents."""


def word_set(text: str) -> frozenset[str]:
    """The words of a text."""
    return frozenset(text.split())


COMMAND_ENDINGS = word_set("op co mv cv lmn cmd dmd")
# of a controller only; elsewhere they mean an outlet, or a valve
CONTROLLER_ENDINGS = word_set("out y")
VALVE_LETTERS = word_set("fv fcv pv pcv lv lcv tv tcv hv hcv xv v va")
COMMAND_WORDS = word_set(
    """command demand output setoutput controlleroutput stellgroesse stellsignal stellwert stellbefehl
    ansteuerung sterowanie sterujacy sterujaca sterujace wysterowanie commande ordre mando orden"""
)
OPENING_ENDINGS = word_set("zi zt zit zic pos xt xi gt x xn fb fbk rm")
OPENING_WORDS = word_set(
    """opening position travel stroke stem lift feedback stellung ventilstellung hub ventilhub rueckmeldung
    stellungsrueckmeldung polozenie otwarcie skok pozycja ouverture course recopie apertura posicion
    carrera openness"""
)
SETPOINT_ENDINGS = word_set("sp spt rsp lsp sv w")
SETPOINT_WORDS = word_set(
    """setpoint sollwert fuehrungsgroesse zadana zadany nastawa consigne consigna setvalue"""
)
# modes, limits and settings that a loop has beside its signals
STATE_ENDINGS = word_set(
    """mode modus betriebsart tryb auto man manual status state stat alarm alm fault trip enable enabled
    quality qual kp ki kd kc gain hilim lolim hlim llim totalizer totaliser"""
)
STATE_WORDS = word_set("mode modus betriebsart alarm")

VALUE_ENDINGS = word_set("pv me meas measurement")
VALUE_WORDS = word_set("istwert regelgroesse mierzona mesure medida processvalue")

FLOW_LETTERS = word_set("f fn fi ft fit fe fs fc fic fr fir frc fy")
FLOW_WORDS = word_set(
    """flow flowrate durchfluss durchflussmenge volumenstrom massenstrom menge foerdermenge przeplyw
    strumien natezenie debit caudal gasto throughput"""
)
PRESSURE_LETTERS = word_set("p pi pt pit ps pc pic pr pe")
PRESSURE_WORDS = word_set("pressure press druck cisnienie pression presion")
TEMPERATURE_LETTERS = word_set("t ti tt tit te tc tic ts tr")
TEMPERATURE_WORDS = word_set("temperature temp temperatur temperatura")
LEVEL_LETTERS = word_set("l li lt lit ls lc lic lr")
LEVEL_WORDS = word_set("level niveau fuellstand stand poziom nivel")
CONTROLLER_LETTERS = word_set("fic fc pic pc tic tc lic lc")

UPSTREAM = word_set(
    """1 in inlet up upstream us before vor vordruck eintritt eingang zulauf ein przed wlot wlotowe doplyw
    amont entree entrada arriba antes"""
)
DOWNSTREAM = word_set(
    """2 out outlet down downstream ds after behind nach hinter hinterdruck nachdruck austritt ausgang
    ablauf aus za wylot wylotowe odplyw aval sortie salida abajo despues"""
)
DIFFERENTIAL = word_set("dp pd pdi pdt pdit delta differential differenz differenzdruck roznica deltap")
ACTUATOR = word_set("actuator diaphragm antrieb membran silownik actionneur actuador")
# air that is moved, not the air that moves an actuator
DUCT = word_set("duct static fan room zone outdoor return mixed")
AIR = word_set("air zuluft luft powietrze powietrza aire")
SIMULATED = word_set("sim simulated simulation model modell modelled symulacja symul simule simulado")

TIME = word_set(
    """time timestamp date datetime zeit zeitstempel datum uhrzeit datumzeit czas data godzina datagodzina
    dataiczas horodate horodatage heure temps hora fecha fechahora t ts tstamp utc localtime utctime
    tsutc"""
)

# columns of the benchmark's three actuators: role, and whether larger numbers shut the valve
_DAMADICS = {
    "P74_00": "p1", "P74_01": "p2", "T74_00": "temperature", "F74_00": "flow",
    "LC74_20CV": "command", "LC74_20X": "opening", "LC74_20PV": "process_value",
    "P51_05": "p1", "P51_06": "p2", "T51_01": "temperature", "F51_01": "flow",
    "LC51_03CV": "command", "LC51_03X": "opening", "LC51_03PV": "process_value",
    "P57_03": "p1", "P57_04": "p2", "T57_03": "temperature", "F57_03": "flow",
    "FC57_03CV": "command", "FC57_03X": "opening", "FC57_03PV": "process_value",
}  # fmt: skip
DAMADICS = {name.casefold(): role for name, role in _DAMADICS.items()}
