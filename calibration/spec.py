"""The numbers that define a simulated record, and its truth."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

Setting: TypeAlias = Literal["training", "other_physics", "creeping"]
Kinds: TypeAlias = Literal["usual", "moved", "levels"]
Cause: TypeAlias = Literal[
    "stiction", "tight_tuning", "external_oscillation", "sensor", "saturation", "deadband", "dead_loop",
    "cascade_slave", "drift", "healthy",
]  # fmt: skip

CAUSES: tuple[Cause, ...] = (
    "stiction", "tight_tuning", "external_oscillation", "sensor", "saturation", "deadband", "dead_loop",
    "cascade_slave", "drift", "healthy",
)  # fmt: skip
"""What can be wrong with a simulated loop; every record has one."""


@dataclass(frozen=True)
class LoopSpec:
    """All numbers that make one record; equal specs give equal records.

    Times of process and controller [s] count in a time of the loop's own (the log has its own, ``dt``);
    OP and MV are in % of the OP span, PV in % of its span before ``unit_pv`` and ``zero_pv``.

    seed : int                 of the loop's random numbers
    setting : str              "training" and "creeping" to learn from, "other_physics" for tests that no
                               calibration has seen
    group : str                what was asked for, finer than the cause: "cycling", "excited", "external_sine", ...
    cause : str                one of ``CAUSES``
    valve : str                law of friction: "kano", "chen", "he", "stick_slip", "creeping", "stribeck", "lugre"
    S, J : float               deadband plus stickband, slip jump [% of OP]
    valve_lag : float          time constant of actuator and stem [s]; of "creeping" and the laws with mass only
    process : str              "one_lag", "two_lags", "integrating"
    K, tau1, tau2, theta : float   gain [% of PV per % of OP; per s where integrating], lags and dead time [s]
    controller : str           "pi", "pi_filtered", "pid_weighted", "pid_series"
    K_p, T_i, T_d, b, T_f : float   gain [% of OP per % of PV], times [s], set-point weight [-], filter of PV [s]
    natural : float            period at which the loop would ring [s]
    per_natural : float        scans of the controller per ``natural``, at least [-]
    driver, driver_on : str    what excites it: "none", "sine", "square", "saw", "triangle", "stochastic", "moves",
                               "drift"; on "load" or "SP"
    driver_time : float        period, correlation time or mean hold of the driver [s]
    driver_wander : float      standard deviation of the length of a period of a wave [periods]; 0: all are equal
    driver_swell : float       standard deviation of the logarithm of the size of a wave [-]; 0: all are equal
    driver_second, driver_second_size : float   period [periods] and amplitude [amplitudes] of a sine beside the wave,
                               as another loop makes it; 0: none
    swing : float              range of OP that the driver is scaled to [% of OP]; 0: it follows from S
    op0 : float                OP at rest [%]
    clip : float               where OP meets a limit, share of its half range; 0: nowhere
    authority : float          what of MV reaches the process [-]: 0 in a dead loop
    noise, noise_time : float  standard deviation [share of the range of PV], correlation time [s]
    coarse : float             steps of the transmitter per range of PV; 0: fine
    walk : float               random walk of the load over the record [share of the range of OP]
    sp_move, sp_hold : float   size of set-point moves [share of the range of PV], their mean hold [periods]
    points : float             logged samples per period
    samples : int              logged samples
    step_pv, step_op : float   steps of the log per range of PV and OP; 0: fine
    door : float               deviation of the historian's compression [share of the range]; 0: none
    stale : float              share of samples held, PV and OP together; stale_hold : mean length [samples]
    sp_logged, process_known, span_known : bool
    give, unevenness : float   of "creeping": its force to break away over the stiffness of its friction [share of S],
                               standard deviation of the logarithm of the jump from one slip to the next [-]
    dt : float                 sampling interval of the log [s]
    unit_pv, zero_pv, unit_op : float   scales and offset of the log
    """

    seed: int
    setting: Setting
    group: str
    cause: Cause
    valve: str
    S: float
    J: float
    valve_lag: float
    process: str
    K: float
    tau1: float
    tau2: float
    theta: float
    controller: str
    K_p: float
    T_i: float
    T_d: float
    b: float
    T_f: float
    natural: float
    per_natural: float
    driver: str
    driver_on: str
    driver_time: float
    swing: float
    op0: float
    clip: float
    authority: float
    noise: float
    noise_time: float
    coarse: float
    walk: float
    sp_move: float
    sp_hold: float
    points: float
    samples: int
    step_pv: float
    step_op: float
    door: float
    stale: float
    stale_hold: float
    sp_logged: bool
    process_known: bool
    span_known: bool
    dt: float
    unit_pv: float
    zero_pv: float
    unit_op: float
    give: float = 0.0
    unevenness: float = 0.0
    driver_wander: float = 0.0
    driver_swell: float = 0.0
    driver_second: float = 0.0
    driver_second_size: float = 0.0


@dataclass(frozen=True)
class Truth:
    """The truth of a simulated record.

    cause : str         one of ``CAUSES``
    group : str         as in the spec
    S, J : float        [% of OP span]; NaN where the valve has none
    process : str       "self_regulating" or "integrating"
    cycling : bool      whether OP crosses its mean at even intervals, at least six times
    travel : float      range of OP over S [-]; NaN without S
    op_range : float    range of OP [% of its span]
    period : float      mean period between crossings of OP [s of the record]; NaN for fewer than two
    defects : tuple     names of the defects of data that the record has
    """

    cause: Cause
    group: str
    S: float
    J: float
    process: str
    cycling: bool
    travel: float
    op_range: float
    period: float
    defects: tuple[str, ...]
