"""Which records the benchmark has: for tuning and for the report, other seeds, other effects outside the catalogue.

Nothing is drawn here that depends on a diagnosis; a run is named by its key, so that a benchmark can go on where it was
stopped.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from benchmarks.gap.generator import FAMILIES, Record, record
from benchmarks.gap.severities import IDEAL, NEVER_SEEN, OUTSIDE_FOR_REPORT, OUTSIDE_FOR_TUNING, SEVERITIES

VISIBLE = 0.05  # gap in units of the sensor's noise, below which an effect counts as having left no trace
# what no log of SP, PV and OP tells apart with linear blocks, and what still cannot be told apart with MV
CLASSES = (
    ("valve_gain", "process_gain", "sensor_span"),
    ("positioner_lag", "second_lag", "sensor_lag"),
    ("valve_leak", "sensor_bias"),
)
CLASSES_WITH_MV = (CLASSES[0], ("second_lag", "sensor_lag"), CLASSES[2])
# a level: gain, hold-up and span are one, and so are a leak, a step from the start and a drift, which its integral
# takes for an inflow; a flow under a level that is logged: what the sensor does shows in the level
CLASSES_OF = {
    "level": (
        ("process_gain", "process_time_constant", "sensor_span"), CLASSES[1],
        ("valve_leak", "sensor_drift", "step_disturbance"),
    ),
    "cascade": (
        ("valve_gain", "process_gain"), ("positioner_lag", "second_lag"), ("valve_leak", "step_disturbance"),
    ),
}  # fmt: skip
PLACES = {
    **dict.fromkeys(
        ("stiction", "deadband", "valve_leak", "valve_saturation", "valve_rate_limit", "positioner_lag",
         "valve_characteristic", "valve_gain"), "valve",
    ),
    **dict.fromkeys(("dead_time", "process_gain", "process_time_constant", "second_lag"), "process"),
    **dict.fromkeys(
        ("sensor_bias", "sensor_drift", "sensor_span", "sensor_lag", "sensor_noise", "quantisation"), "sensor"
    ),
    "compression": "historian",
    **dict.fromkeys(
        ("controller_gain", "controller_integral_time", "controller_limits", "controller_filter", "scan_time"),
        "controller",
    ),
    **dict.fromkeys(("sine_disturbance", "step_disturbance", "slug"), "feed"),
}  # fmt: skip


@dataclass(frozen=True)
class Run:
    """One record to make: setting, effects, severity, seed, an effect ``outside`` the catalogue, MV logged or not."""

    family: str
    setting: str
    effects: tuple[str, ...] = ()
    severity: str = "typical"
    seed: int = 0
    outside: str = ""
    mv: bool = False

    @property
    def key(self) -> str:
        """A name of the run that no other has."""
        what = "+".join(self.effects) or self.outside or "none"
        logged = "mv" if self.mv else "no_mv"
        return "/".join([self.family, self.setting, what, self.severity.replace(" ", "_"), str(self.seed), logged])

    @property
    def kind(self) -> tuple[str | int | bool, ...]:
        """What the run counts among: setting, how many effects, outside the catalogue or not, severity, MV or not."""
        return (self.setting, len(self.effects), bool(self.outside), self.severity, self.mv)

    def made(self) -> Record:
        """Return the record, always the same one."""
        return record(self.setting, self.effects, self.severity, self.seed, family=self.family, outside=self.outside)

    @property
    def places(self) -> tuple[str, ...]:
        """The blocks at which the effects are, () where there is none or it is outside the catalogue."""
        return tuple(PLACES[name] for name in self.effects)


def alike(name: str, mv: bool = False, setting: str = "") -> tuple[str, ...]:
    """Return the effects that the same log of a setting, by default a flow loop, could come from, itself among them.

    >>> alike("sensor_lag", mv=True), alike("stiction")
    (('second_lag', 'sensor_lag'), ('stiction',))
    """
    classes = CLASSES_OF.get(setting, CLASSES_WITH_MV if mv else CLASSES)
    return next((group for group in classes if name in group), (name,))


def singles(family: str, setting: str, severities: tuple[str, ...], seeds: int, mv: bool = False) -> Iterator[Run]:
    """Yield every effect of the catalogue of loops at these severities, ``seeds`` times each."""
    for name in IDEAL:
        for severity in severities:
            for seed in range(seeds):
                yield Run(family, setting, (name,), severity, seed, mv=mv)


def without(family: str, setting: str, count: int) -> Iterator[Run]:
    """Yield runs without any effect."""
    for seed in range(count):
        yield Run(family, setting, seed=1000 + seed)


KINDS = {"tuning": OUTSIDE_FOR_TUNING, "report_4": OUTSIDE_FOR_REPORT + NEVER_SEEN}  # else those of the first report


def outside(family: str, setting: str, severities: tuple[str, ...], seeds: int) -> Iterator[Run]:
    """Yield runs with effects that no catalogue has: other kinds for the report than for tuning."""
    for kind in KINDS.get(family, OUTSIDE_FOR_REPORT):
        for severity in severities:
            for seed in range(seeds):
                yield Run(family, setting, (), severity, 2000 + seed, outside=kind)


def pairs(family: str, setting: str, count: int) -> Iterator[Run]:
    """Yield runs with two effects at typical severity that a log can tell apart, drawn from all such pairs."""
    known = [
        (a, b)
        for a, b in combinations(IDEAL, 2)
        if b not in alike(a) and {a, b} != {"stiction", "deadband"} and "compression" not in (a, b)
        and {a, b} != {"valve_saturation", "controller_limits"} and "valve_rate_limit" not in (a, b)
    ]  # fmt: skip
    rng = np.random.default_rng(6 + FAMILIES[family])
    for k in rng.permutation(len(known))[:count]:
        yield Run(family, setting, known[k], seed=3000 + int(k))


@dataclass(frozen=True)
class Counts:
    """How many seeds or records of each kind a family has."""

    ideal: int
    none: int
    outside: int
    pairs: int
    with_mv: int
    coarse: int
    coarse_none: int
    site: int
    site_none: int
    site_outside: int
    general: int
    general_none: int


LARGE = Counts(4, 300, 7, 110, 3, 2, 40, 6, 100, 7, 2, 20)
ASKED = Counts(2, 300, 7, 64, 1, 3, 20, 6, 100, 7, 1, 10)  # as many as are asked for, to be made in an evening
COUNTS = {
    "tuning": Counts(1, 60, 2, 20, 1, 1, 10, 1, 20, 2, 1, 5),
    "report": LARGE,
    "report_2": LARGE,
    "report_3": ASKED,
    "report_4": Counts(2, 300, 6, 64, 1, 1, 20, 6, 100, 4, 1, 10),  # more kinds outside the catalogue
}


def benchmark(family: str) -> tuple[Run, ...]:
    """Return all runs of a family, "tuning", "report" or a later report, kind by kind.

    >>> runs = benchmark("report")
    >>> len({run.key for run in runs}) == len(runs), sum(run.setting == "site" for run in runs)
    (True, 544)
    """
    two, of = SEVERITIES[1:], COUNTS[family]
    found = [
        *singles(family, "ideal", SEVERITIES, of.ideal),
        *without(family, "ideal", of.none),
        *outside(family, "ideal", SEVERITIES, of.outside),
        *pairs(family, "ideal", of.pairs),
        *singles(family, "ideal", two, of.with_mv, mv=True),
        *singles(family, "coarse", two, of.coarse),
        *without(family, "coarse", of.coarse_none),
        *singles(family, "site", two, of.site),
        *without(family, "site", of.site_none),
        *outside(family, "site", two, of.site_outside),
    ]
    if family != "tuning":
        found += outside(family, "site", SEVERITIES[:1], 1)
    for setting in ("second_order", "level", "cascade"):
        found += [*singles(family, setting, ("typical",), of.general), *without(family, setting, of.general_none)]
    return tuple(found)
