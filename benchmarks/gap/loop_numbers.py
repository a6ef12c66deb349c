"""What may differ from loop to loop in the flow loop of the benchmark, and where it stands in the array ``p``.

``NEUTRAL`` has the values of the loop without any effect.  ``OUTSIDE_KINDS`` are effects that no catalogue has.
"""

import math

NEUTRAL = {
    "K": 3.0, "tau": 10.0, "K_p": 0.4, "T_i": 10.0, "low": 0.0, "high": 1.0,
    "scan": 0.0, "scan_offset": 0.0, "present": 1.0, "filter": 0.0,
    "play": 0.0, "positioner": 0.0, "rate": math.inf, "stop_low": -math.inf, "stop_high": math.inf,
    "leak": 0.0, "rangeability": 1.0, "valve_gain": 1.0,
    "theta": 0.0, "second": 0.0,
    "bias": 0.0, "drift": 0.0, "span": 1.0, "sensor": 0.0, "step": 0.0, "range_low": -math.inf, "range_high": math.inf,
    "sine": 0.0, "sine_period": 60.0, "sine_phase": 0.0, "jump": 0.0, "jump_at": 0.0,
    "slug": 0.0, "slug_period": 600.0, "slug_phase": 0.0,
    "friction": 0.0, "k": 30000.0, "M": 2.0, "F_v": 900.0, "F_c": 0.0, "F_s": 0.0, "v_s": 0.0001,
    "outside": 0.0, "size": 0.0, "other": 0.0,
    "integrating": 0.0, "outflow": 0.0, "outer_K": 0.0, "outer_T": 400.0, "outer_noise": 0.0, "vessel": 200.0,
}  # fmt: skip
NAMES = tuple(NEUTRAL)
(
    K, TAU, K_P, T_I, LOW, HIGH, SCAN, SCAN_OFFSET, PRESENT, FILTER, PLAY, POSITIONER, RATE, STOP_LOW, STOP_HIGH,
    LEAK, R, VALVE_GAIN, THETA, SECOND, BIAS, DRIFT, SPAN, SENSOR, STEP, RANGE_LOW, RANGE_HIGH,
    SINE, SINE_PERIOD, SINE_PHASE, JUMP, JUMP_AT, SLUG, SLUG_PERIOD, SLUG_PHASE,
    FRICTION, SPRING, MASS, F_V, F_C, F_S, V_S, OUTSIDE, SIZE, OTHER,
    INTEGRATING, OUTFLOW, OUTER_K, OUTER_T, OUTER_NOISE, VESSEL,
) = range(len(NAMES))  # fmt: skip
KARNOPP, LUGRE = 1.0, 2.0
OUTSIDE_KINDS = (
    "", "sensor_hysteresis", "multiplicative_noise", "sticky_sensor", "gain_by_direction", "inverse_response",
    "intermittent_dead_time", "asymmetric_lag", "oscillating_gain", "quantised_output", "controller_gap",
    "frozen_sensor", "wavy_trim", "set_point_weight", "jammed_stem", "wave_packet", "wandering_load",
    "fouling_gain", "leaking_integral", "switching_bias", "spiking_sensor", "bursting_noise", "chirping_load",
)  # fmt: skip
(
    _NONE, HYSTERESIS, MULTIPLIED, STICKY, BY_DIRECTION, INVERSE, INTERMITTENT, ASYMMETRIC, OSCILLATING, ROUNDED_OP,
    GAP, FROZEN, WAVY, WEIGHT, JAMMED, PACKET, WANDERING, FOULING, LEAKING, _SWITCHING, _SPIKING, _BURSTING, _CHIRPING,
) = range(len(OUTSIDE_KINDS))  # fmt: skip
