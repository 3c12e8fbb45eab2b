# SPDX-License-Identifier: BSD-3-Clause
"""Effects of meters and sensors."""

from benchmarks.concealed.plant.effects.base import Effect, add, multiply, own, span


def _of_span(name, unit="m3/h"):
    return own(name, unit, of=lambda size, plant: size * span(plant))


def _drift(size, plant):
    return size * span(plant) * 3600.0 / max(plant.grown_for, 1.0)


EFFECTS = (
    Effect(
        "meter_gain",
        "flow_meter_gain",
        "measurement",
        multiply("meter_gain"),
        0.6,
        signed=True,
        free=0.1,
        parameter=own("gain"),
        when="within",
    ),
    Effect(
        "meter_bias",
        "flow_meter_bias",
        "measurement",
        add("meter_bias", span),
        0.25,
        "span",
        signed=True,
        parameter=_of_span("bias"),
        when="within",
    ),
    Effect(
        "meter_zero",
        "flow_meter_bias",
        "measurement",
        add("meter_bias", span),
        0.25,
        "span",
        signed=True,
        free=0.005,
        when="start",
    ),
    Effect(
        "meter_drift",
        "flow_meter_drift",
        "measurement",
        add("meter_bias", span),
        0.3,
        "span",
        signed=True,
        grows=True,
        parameter=own("drift", "m3/h/h", of=_drift),
    ),
    Effect(
        "meter_lag",
        "sensor_lag",
        "measurement",
        add("meter_lag"),
        60.0,
        "s",
        free=2.0,
        parameter=own("lag", "s", of=lambda size, plant: size + plant.sound["meter_lag"]),
    ),
    Effect(
        "sensor_bias",
        "position_sensor_bias",
        "measurement",
        add("x_bias"),
        0.15,
        signed=True,
        free=0.01,
        parameter=own("bias"),
        when="within",
    ),
    Effect(
        "loop_bias",
        "position_sensor_bias",
        "measurement",
        add("loop_bias"),
        0.15,
        signed=True,
        free=0.01,
        parameter=own("bias"),
        when="within",
    ),
    Effect(
        "sensor_gain",
        "position_sensor_gain",
        "measurement",
        multiply("x_gain"),
        0.3,
        signed=True,
        free=0.01,
        parameter=own("gain"),
    ),
    Effect(
        "loop_gain",
        "position_sensor_gain",
        "measurement",
        multiply("loop_gain"),
        0.3,
        signed=True,
        free=0.01,
        parameter=own("gain"),
    ),
    Effect(
        "inlet_bias",
        "inlet_pressure_bias",
        "measurement",
        add("p1_bias"),
        3e5,
        "Pa",
        signed=True,
        free=2.5e3,
        parameter=own("bias", "Pa"),
    ),
    Effect(
        "outlet_bias",
        "outlet_pressure_bias",
        "measurement",
        add("p2_bias"),
        1.5e5,
        "Pa",
        signed=True,
        free=2.5e3,
        parameter=own("bias", "Pa"),
    ),
)
