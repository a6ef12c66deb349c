"""Records of the benchmark: a flow loop with a known hidden effect, or with none, as a historian would have kept it.

The loops are in ``settings``, what happens in them in ``physics``, how large it is in ``severities``.  The
generator shares no code with the diagnosis, its effects, the blocks or the engine.  Seeds for tuning and for reporting
are of different families, so that no record of one is a record of the other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from benchmarks.gap.compressor import doors
from benchmarks.gap.friction import LAWS, LUGRE, figure, with_friction
from benchmarks.gap.loop_numbers import NAMES, NEUTRAL, OUTSIDE_KINDS
from benchmarks.gap.physics import run
from benchmarks.gap.settings import LOAD_TIME, SETTINGS, Setting
from benchmarks.gap.severities import ACTS, OUTSIDE, SEVERITIES, Values, drawn

Floats = NDArray[np.float64]
# report_2 to report_4: records for states whose authors have seen the reports before
FAMILIES = {"tuning": 1, "report": 2, "report_2": 3, "report_3": 4, "report_4": 5}
STEPS = 20  # a second, where all is smooth
FINE = 100  # where something has memory
SLOW, FAST = 1.0 / 400.0, 1.0 / 60.0  # frequencies of a chirping load [1/s]
FINE_ONES = {"stiction", "deadband", "valve_rate_limit", "quantisation", "dead_time"}


@dataclass(frozen=True)
class Record:
    """What a log holds, and what is true of it.

    ``signals``: time [s], SP, PV, OP and MV, (rows,) each.  ``effects``: name -> parameters, of stiction as its
    MV-OP figure shows them.  ``outside``: the effect that no catalogue has, "" for none.  ``clean``: the same loop
    without the effects, same noise and load: what there is between the two is the gap.
    ``numbers`` and ``base``: the numbers of ``physics`` with the effects and without.  ``set_point``: SP a second;
    ``random``: noise of the sensor [PV unit] without the effects, a second stream, the load: (3, seconds).
    """

    setting: str
    severity: str
    seed: tuple[int, ...]
    effects: Mapping[str, Values]
    outside: str
    signals: Mapping[str, Floats]
    clean: Mapping[str, Floats]
    numbers: Mapping[str, float] = field(default_factory=dict)
    base: Mapping[str, float] = field(default_factory=dict)
    set_point: Floats = field(default_factory=lambda: np.zeros(0))
    random: Floats = field(default_factory=lambda: np.zeros((3, 0)))

    @property
    def gap(self) -> float:
        """Largest root mean square difference that the effect makes to PV or OP, in units of the sensor's noise."""
        differences = [self.signals[s] - self.clean[s] for s in ("PV", "OP")]
        return max(float(np.sqrt(np.mean(d**2))) for d in differences) / SETTINGS[self.setting].noise

    def write(self, path: Path, mv: bool = False) -> None:
        """Write the record as a CSV file: time [s], SP, PV, OP, of a cascade SP_L and L, and MV if asked for."""
        names = [name for name in self.signals if mv or name != "MV"]
        rows = np.column_stack([self.signals[name] for name in names])
        np.savetxt(path, rows, delimiter=",", header=",".join(names), comments="", fmt="%.9g")


def record(
    setting: str,
    effects: Sequence[str] = (),
    severity: str = "typical",
    seed: int = 0,
    *,
    family: str = "tuning",
    outside: str = "",
    hours: float | None = None,
    given: Mapping[str, Values] | None = None,
    noise: bool = True,
) -> Record:
    """Return one record: ``effects`` by name at a ``severity``, or an effect ``outside`` the catalogue, or neither.

    ``given`` sets parameters of effects in place of drawn ones, of stiction also the ``law``; without ``noise``
    nothing is drawn for sensor and load.
    Raises ``ValueError`` for a word that is none of those above.
    """
    for word, known in ((setting, tuple(SETTINGS)), (severity, SEVERITIES), (family, tuple(FAMILIES))):
        if word not in known:
            raise ValueError(f"{word!r} is none of {', '.join(known)}")
    if outside and outside not in OUTSIDE:
        raise ValueError(f"{outside!r} is none of {', '.join(OUTSIDE)}")
    level, loop = SEVERITIES.index(severity), SETTINGS[setting]
    words = (FAMILIES[family], list(SETTINGS).index(setting), level, seed)
    rng = np.random.default_rng([*words, *(hash_of(name) for name in (*effects, outside))])
    n = int(3600 * (loop.hours if hours is None else hours)) + 1
    sp = staircase(rng, n, loop)
    n_1, n_2 = rng.normal(size=n), rng.normal(size=n)
    base = {**NEUTRAL, **loop.numbers}
    for key, share in loop.within.items():
        factor = rng.uniform(1.0 - share, 1.0 + share)
        base[key] *= factor
        if key == "tau":
            base["second"] *= factor
    load = loop.load * autoregression(rng, n)
    if not noise:
        n_1, n_2, load = np.zeros(n), np.zeros(n), np.zeros(n)
    zero = np.zeros(n)
    clean = run(packed(base), sp, loop.noise * n_1, n_2, load, zero, STEPS, float(sp[0]))
    reach = 100.0 * float(clean[:, 3].max())
    values = {name: dict((given or {}).get(name) or drawn(name, level, rng, loop, reach, n - 1)) for name in effects}
    if "scan_time" in values and "present" not in values["scan_time"]:
        values["scan_time"]["present"] = 1.0 if loop.scanned else float(rng.integers(2))
    numbers, spread, switch = dict(base), 1.0, zero
    for name, its in values.items():
        if name == "stiction":
            law = its.pop("law", LAWS[int(rng.random() < 0.2)])
            numbers |= with_friction(its["S"] / 100.0, its["J"] / 100.0, law)
            its["S"], its["J"] = (100.0 * share for share in figure(numbers))
        elif name == "sensor_noise":
            spread = its["factor"]
        elif name in ACTS:
            numbers |= ACTS[name](its, base)
    shown = spread * loop.noise * n_1
    if outside:
        size, other = OUTSIDE[outside][level]
        size *= float(np.exp(rng.uniform(-0.18, 0.18))) if outside != "set_point_weight" else 1.0
        numbers |= {"outside": float(OUTSIDE_KINDS.index(outside)), "size": size, "other": other}
        switch, load = _stretches(outside, size, other, rng, n), load + _loads(outside, size, other, rng, n)
        if outside == "intermittent_dead_time":
            switch = _telegraph(rng, n, 120.0)
        if outside == "set_point_weight":
            numbers["other"] = 0.0
        shown = shown + _shown(outside, size, other, rng, loop.noise * n_1)
    steps = FINE if FINE_ONES & set(effects) or outside else STEPS
    if numbers["friction"] == LUGRE:
        steps = STEPS
    true = run(packed(numbers), sp, shown, n_2, load, switch, steps, float(sp[0]))
    deviation = values.get("compression", {}).get("deviation", 0.0)
    return Record(
        setting,
        severity,
        words,
        values,
        outside,
        _logged(true, setting, deviation),
        _logged(clean, setting, 0.0),
        numbers,
        base,
        sp,
        np.stack([loop.noise * n_1, n_2, load]),
    )


def hash_of(name: str) -> int:
    """Return a number that stands for a name, the same on every machine."""
    return sum((i + 1) * ord(letter) for i, letter in enumerate(name))


def staircase(rng: np.random.Generator, n: int, loop: Setting) -> Floats:
    """Return a random set point, one value a second, levels and times as the setting says."""
    sp, at = np.empty(n), 0
    while at < n:
        dwell = int(rng.uniform(*loop.dwell))
        sp[at : at + dwell] = round(float(rng.uniform(*loop.levels)), 2)
        at += dwell
    return sp


def autoregression(rng: np.random.Generator, n: int) -> Floats:
    """Return a load of standard deviation 1, one value a second."""
    return np.asarray(_remembered(rng.normal(size=n), float(np.exp(-1.0 / LOAD_TIME))))


@njit(cache=True)
def _remembered(w: Any, a: float) -> Any:
    """Return w (n,) so that a share ``a`` of each value stays in the next one."""
    load, takes = w.copy(), np.sqrt(1.0 - a * a)
    for k in range(1, len(w)):
        load[k] = a * load[k - 1] + takes * w[k]
    return load


def packed(numbers: Mapping[str, float]) -> Floats:
    """Return numbers of the loop in the order in which ``physics`` has them."""
    return np.array([numbers[name] for name in NAMES])


def _logged(out: Floats, setting: str, deviation: float) -> dict[str, Floats]:
    """Return the signals as the historian gives them back."""
    loop = SETTINGS[setting]
    rows, time = out[:: loop.every], np.arange(len(out), dtype=float)[:: loop.every]
    SP, PV, OP, MV = (rows[:, i] for i in range(4))
    if deviation > 0.0:
        PV = doors(time, PV, deviation)
    fine, coarse = loop.rounding
    found = {
        "time": time,
        "SP": SP,
        "PV": np.round(PV / fine) * fine,
        "OP": np.round(OP / coarse) * coarse,
        "MV": np.round(MV / coarse) * coarse,
    }
    if "outer_K" in loop.numbers:
        found |= {"SP": np.round(SP / coarse) * coarse, "L": np.round(rows[:, 5] / fine) * fine, "SP_L": rows[:, 6]}
    return found


def _stretches(kind: str, share: float, length: float, rng: np.random.Generator, n: int) -> Floats:
    """Return 1 in the seconds of random stretches that take up a share of the record, for effects that come and go."""
    switch = np.zeros(n)
    if kind in ("frozen_sensor", "jammed_stem"):
        for at in rng.integers(120, n - 120, max(2, int(share * n / length))):
            switch[at : at + max(2, int(rng.exponential(length)))] = 1.0
    return switch


def _telegraph(rng: np.random.Generator, n: int, mean: float) -> Floats:
    """Return 0 and 1 in turn, each for a random time of this mean [s]."""
    switch, at, on = np.zeros(n), 0, 0.0
    while at < n:
        dwell = 1 + int(rng.exponential(mean))
        switch[at : at + dwell] = on
        at, on = at + dwell, 1.0 - on
    return switch


def _loads(kind: str, size: float, other: float, rng: np.random.Generator, n: int) -> Floats:
    """Return the load of the effects that are one, a value a second."""
    t = np.arange(n, dtype=float)
    if kind == "wave_packet":
        at, wide = rng.uniform(0.3, 0.7) * n, 0.08 * n
        packet: Floats = size * np.sin(2.0 * np.pi * t / other) * np.exp(-(((t - at) / wide) ** 2))
        return packet
    if kind == "wandering_load":
        return size * np.sqrt(1.0 / other) * np.cumsum(rng.normal(size=n))
    if kind == "chirping_load":
        return np.asarray(size * np.sin(2.0 * np.pi * t * (SLOW + 0.5 * (FAST - SLOW) * t / n)))
    return np.zeros(n)


def _shown(kind: str, size: float, other: float, rng: np.random.Generator, noise: Floats) -> Floats:
    """Return what the effects of a sensor add to what it shows, a value a second."""
    n = len(noise)
    if kind == "switching_bias":
        return size * _telegraph(rng, n, other)
    if kind == "bursting_noise":
        return size * _telegraph(rng, n, other) * noise
    if kind == "spiking_sensor":
        return np.asarray(size * rng.choice([-1.0, 1.0], n) * (rng.random(n) < 1.0 / other))
    return np.zeros(n)
