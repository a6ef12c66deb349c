"""Cascade with a nonlinear inner loop: a temperature controller sets the flow of hot oil, whose header sags.

    1.5 dq/dt = 10 x root(1 + load_p - (q/14)^2) - q            q flow of oil [kg/s], x flow share of the valve, linear
    120 dT/dt = 25 + load_T + 7 q(t - 10) - T                   T temperature [degC], t [s]

Blocks     temperature_controller, flow_controller, valve, pipe (x to q), flow_sensor, vessel (q to T: dead time, gain,
           lag), temperature_sensor, feed_pipe (load_p, into pipe), feed_vessel (load_T, into vessel)
Controller temperature_controller: K = 0.025 of its full output per degC, T_i = 110 s, output 0 to 1, which is a set
           point of 0 to 10 kg/s, scan 2 s;  flow_controller: K = 0.05 of full OP per kg/s, T_i = 2 s, OP 0 to 1, scan
           0.5 s.  Where both scan, temperature_controller comes first.  It does not know the limits of flow_controller.
Sensor     flow_sensor: lag 0.2 s, noise 0.04 kg/s; temperature_sensor: lag 4 s, noise 0.05 degC, new every 0.5 s (so
           temperature_controller uses every fourth value)
Load       load_p: AR(1), standard deviation 0.03, time constant 40 s; load_T: AR(1), 0.5 degC, 200 s
Log        SP_T, PV_T [degC] rounded to 0.01, SP_F, PV_F [kg/s] rounded to 0.005, OP [0 to 1] rounded to 0.0005; a row
           every 7 s for 4 h; SP_F is temperature_controller's output, PV_T what it last read
Set points 48 to 70 degC, a move every 20 min on average
Nonlinear: the header.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Pipe(NamedTuple):
    """Flow of the open valve [kg/s], time constant [s], flow that empties the header [kg/s]."""

    q: float = 10.0
    tau: float = 1.5
    sags: float = 14.0


class Vessel(NamedTuple):
    """Gain [degC s/kg], time constant [s], dead time [s]."""

    K: float = 7.0
    tau: float = 120.0
    theta: float = 10.0
    by_flow: float = 0.0


class Faults(NamedTuple):
    """What is outside: false pulses of the flow meter, an operator who takes the inner loop to manual."""

    pulses: float = 0.0
    manual: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    temperature_controller: PI = PI(K=0.025, T_i=110.0, scan=2.0)
    flow_controller: PI = PI(K=0.05, T_i=2.0, scan=0.5)
    valve: Valve = Valve()
    pipe: Pipe = Pipe()
    flow_sensor: Sensor = Sensor(sd=0.04, tau=0.2)
    vessel: Vessel = Vessel()
    temperature_sensor: Sensor = Sensor(sd=0.05, tau=4.0)
    feed_pipe: Feed = Feed()
    feed_vessel: Feed = Feed()
    faults: Faults = Faults()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, v = p.pipe, p.vessel
    scan_t, scan_f = round(p.temperature_controller.scan / dt), round(p.flow_controller.scan / dt)
    n = sp.shape[1]
    T = sp[0, 0]
    q = (T - 25.0) / v.K
    op = q / (g.q * np.sqrt(1.0 - (q / g.sags) ** 2))
    sp_t, pv_t, sp_f, pv_f = T, T, q, q
    held_t, held_f, x = pi_at(q / 10.0), pi_at(op), stem_at(op)
    m_t, m_f = sensor_at(T), sensor_at(q)
    late = np.full(round(v.theta / dt), q)
    for i in range(n):
        t = (i - first) * dt
        k = int(i * dt / 0.5 + 1e-6)
        if i % scan_t == 0:
            sp_t = sp[0, i]
            pv_t = read(p.temperature_sensor, m_t, noise[1, k], luck[k], t)
            sp_f = 10.0 * pi(p.temperature_controller, held_t, sp_t, pv_t, 0.0, luck[k])
        if i % scan_f == 0:
            pv_f = read(p.flow_sensor, m_f, noise[0, k], luck[k], t)
            if luck[k] < 0.02:
                pv_f += p.faults.pulses
            if t % 1500.0 < p.faults.manual and t > 0.0:
                held_f[0] = op - p.flow_controller.K * (sp_f - pv_f)
            else:
                op = pi(p.flow_controller, held_f, sp_f, pv_f, 0.0, luck[k])
        if i >= first and (i - first) % every == 0:
            row = out[(i - first) // every]
            row[0], row[1], row[2], row[3], row[4] = sp_t, pv_t, sp_f, pv_f, op
        s = int(i * dt)
        pressure = max(1.0 + load[0, s] + planned(p.feed_pipe, t) - (q / g.sags) ** 2, 0.0)
        q += dt / g.tau * (g.q * through(p.valve, stem(p.valve, x, op, t, dt)) * np.sqrt(pressure) - q)
        j = i % len(late)
        was = late[j]
        late[j] = q
        tau = v.tau * (5.0 / max(was, 1.0)) ** v.by_flow
        T += dt / tau * (25.0 + load[1, s] + planned(p.feed_vessel, t) + v.K * was - T)
        feel(p.flow_sensor, m_f, q, dt)
        feel(p.temperature_sensor, m_t, T, dt)


PLANT = Plant(
    "cascade", Parameters(), run,
    tags={"SP_T": 0.01, "PV_T": 0.01, "SP_F": 0.005, "PV_F": 0.005, "OP": 0.0005},
    set_points=(Moves(48.0, 70.0, 1200.0, 60.0),),
    loads=(Load(0.03, 40.0), Load(0.5, 200.0)), sensors=("flow_sensor", "temperature_sensor"),
    hours=4.0, dt=0.05, scan=0.5, row=7.0, warm=600.0,
    alike={
        "valve_gain": (("process_gain", "pipe"),),
        "positioner_lag": (("second_lag", "pipe"),),
        "sensor_lag": (("second_lag", "vessel"),),
    },
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.03 * s, "valve.J": 0.012 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.025 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 3.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.1**s}, signed=True),
        "sensor_span": Effect("flow_sensor", lambda s: {"flow_sensor.span": 1.0 + 0.06 * s}, signed=True),
        "sensor_lag": Effect("temperature_sensor", lambda s: {"temperature_sensor.tau": 4.0 + 12.0 * s}),
        "dead_time": Effect("vessel", lambda s: {"vessel.theta": 10.0 + 10.0 * s}),
        "process_time_constant": Effect("vessel", lambda s: {"vessel.tau": 120.0 * 1.3**s}, signed=True),
        "controller_gain": Effect(
            "temperature_controller", lambda s: {"temperature_controller.K": 0.025 * 1.4**s}, signed=True),
        "controller_integral_time": Effect(
            "flow_controller", lambda s: {"flow_controller.T_i": 2.0 * 1.8**s}, signed=True),
        "step_disturbance": Effect(
            "feed_pipe", lambda s: {"feed_pipe.step": 0.12 * s, "feed_pipe.at": 6000.0}, signed=True),
    },
    outside={
        # the vessel is quicker the larger the flow
        "quicker_with_flow": Effect("vessel", lambda s: {"vessel.by_flow": 0.25 * s}),
        # false pulses of the flow meter, one scan in fifty
        "pulses": Effect("flow_sensor", lambda s: {"faults.pulses": 1.0 * s}),
        # somebody takes the inner loop to manual every 25 min, for some
        "manual": Effect("flow_controller", lambda s: {"faults.manual": 90.0 * s}),
    },
)  # fmt: skip
