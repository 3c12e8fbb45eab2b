# SPDX-License-Identifier: BSD-3-Clause
"""One drawn plant that can be run with and without effects on the same surroundings."""

import numpy as np

from sklvalve.datasets import _plant_draw as draw
from sklvalve.datasets._plant_effects import EFFECTS
from sklvalve.datasets._plant_loop import COLUMNS, run_plant

COMMAND, READING, PLUG, P1, P2, FLOW, FLOW_TURBULENT = range(7)
RESOLUTION = {"X": 0.05, "P1": 0.1, "P2": 0.1, "T1": 0.01, "F": 0.001}


class Plant:
    """One drawn plant and its surroundings; runs with any effects without drawing anew."""

    def __init__(self, rng, names, loop, noise, n):
        self.n = n
        total = n + draw.WARM_UP
        drawn = str(rng.choice(draw.LOOPS, p=[0.5, 0.35, 0.15]))
        if any(EFFECTS[name].needs_wide for name in names):
            drawn = "wide"
        self.loop = drawn if loop is None else loop
        self.sheet = draw.draw_sheet(rng)
        self.kv = self.sheet["kv_rated"]
        self.trim, self.other, self.fl = draw.draw_trims(rng, self.sheet)
        self.actuator, self.line, self.controller, self.healthy = draw.draw_hardware(rng, self.sheet)
        self.source, self.tank, self.celsius = draw.draw_surroundings(rng, total, self.loop)
        self.rho, vapour = draw.water(self.celsius)
        self.floor = draw.jet_floor(vapour)
        self.command = np.round(draw.draw_command(rng, total), 4)
        self.setpoint = np.round(draw.draw_setpoint(rng, total, self.kv), 2)
        self.noise, self.turbulence = draw.draw_noise(rng, total, self.kv, noise)
        takes_over = {"wide": total, "closed": 60, "mixed": draw.WARM_UP + n // 2}[self.loop]
        self.auto = np.arange(total) >= takes_over
        if self.loop == "closed":
            self.command[:] = 0.6

    def schedule(self, strengths, onset, seed):
        table = np.tile(np.array([self.healthy[name] for name in COLUMNS]), (self.n + draw.WARM_UP, 1))
        columns = {name: table[:, i] for i, name in enumerate(COLUMNS)}
        # an effect from the start acts in the warm-up too
        begin = 0 if onset <= 0.0 else draw.WARM_UP + int(np.ceil(onset))
        active = (np.arange(table.shape[0]) >= begin).astype(float)
        for i, (name, size) in enumerate(strengths.items()):
            if name == "no_choking":
                columns["choking"][:] = 0.0
            elif size != 0.0:
                rng = np.random.default_rng([seed, i])
                EFFECTS[name].apply(
                    columns, size, active, {"kv": self.kv, "celsius": self.celsius, "rng": rng}
                )
        return table

    def run(self, strengths, onset, seed, replay=None):
        """Rows of the loop's output after the warm-up, and the command of all rows, to be replayed."""
        auto, command = (self.auto, self.command) if replay is None else (np.zeros_like(self.auto), replay)
        weather = (self.source, self.tank, self.rho, self.floor, self.turbulence, self.noise["F"])
        hardware = (self.trim, self.other, self.fl, self.actuator, self.line, self.controller)
        out = run_plant(
            self.schedule(strengths, onset, seed), command, auto, self.setpoint, *weather, *hardware
        )
        return out[draw.WARM_UP :], out[:, COMMAND]

    def record(self, out):
        """What the instruments wrote down."""
        clean = {
            "X": 100.0 * out[:, READING],
            "P1": 1e-3 * out[:, P1],
            "P2": 1e-3 * out[:, P2],
            "T1": self.celsius[draw.WARM_UP :],
            "F": out[:, FLOW_TURBULENT],
        }
        table = {"time": np.arange(self.n), "CV": np.round(100.0 * out[:, COMMAND], 2)}
        for name, value in clean.items():
            step = RESOLUTION[name]
            noisy = value + self.noise[name][draw.WARM_UP :]
            table[name] = np.round(np.round(noisy / step) * step, 3)
        # a transmitter of 4 to 20 mA says no less than 3.8 mA
        table["F"] = np.maximum(table["F"], np.round(-0.0125 * 1.5 * self.kv, 3))
        table["X"] = np.clip(table["X"], -2.5, 102.5)
        if self.loop != "wide":
            auto = self.auto[draw.WARM_UP :]
            table["SP"] = np.where(auto, self.setpoint[draw.WARM_UP :], np.nan)
        return table

    def valve_table(self, sheet_physics):
        """What the engineer knows, in the structure of a valve.toml."""
        kpa = {"unit": "kPa", "gauge": False}
        return {
            "valve": {"tag": "FV-101"} | self.sheet,
            "fluid": {"name": "water"},
            "actuator": {
                "fail": "closed",
                "supply_pressure": 340.0,
                "spring_range": [20.0, 100.0],
                "effective_area": 290.0,
                "positioner": True,
            },
            "simulation": {"physics": list(sheet_physics)},
            "recording": {
                "time": "time",
                "command": {"column": "CV", "unit": "%"},
                "opening": {"column": "X", "unit": "%"},
                "p1": {"column": "P1"} | kpa,
                "p2": {"column": "P2"} | kpa,
                "temperature": {"column": "T1", "unit": "degC"},
                "flow": {"column": "F", "unit": "m3/h"},
            },
        }
