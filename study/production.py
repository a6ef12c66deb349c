"""The production plant as the subject of a study, with all that moves its rest as quantities.

F_in, Z_I        where the plant rests [mol/s, -], its hardware unchanged; design.F_in and design.Z_I rebuild it
F_s, VPCS1.F_s   static friction [N] of all sticky valves, or of one: a number, or none, normal, high
sticky           the valves that stick, e.g. VPCS1 or VLCS1+VPCS1
stem, turbine    quasi_static or full; direct or lag               anti_surge   on, off, gradient
slug.*           flow [mol/s], gas [-], period [s] of severe slugging about F_in and Z_I instead of the case's feed
sine.*           amplitude [-], period [s] of the methane fraction, as in case 2
D, J, S1.K_p_pressure, C2.margin ...   every number of ``Production``; the plant is sized and brought to rest again
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from stickslip.diagram.diagram import Diagram
from stickslip.diagram.settings import Settings
from stickslip.plant import feed as feeds
from stickslip.plant import kicked, production_plant
from stickslip.plant.parameters import DEFAULT, SETS, Production
from stickslip.plant.parts import VALVES
from stickslip.study.axes import StudyError, Value
from stickslip.study.subject import Subject

CHAIN: Mapping[str, tuple[str, ...]] = {
    "valve": ("OP_VPCS1", "MV_VPCS1", "F_G1"),
    "separator 1": ("p_1", "V_1"),
    "compressor 2": ("p_in2", "m_2", "p_out2"),
    "separator 2": ("p_2", "OP_VPCS2"),
    "shaft": ("tau_d", "w"),
}
STICKY = ("VLCS1", "VPCS1")
ANTI_SURGE: Mapping[str, bool | str] = {"on": True, "off": False, "gradient": "gradient"}
CONTENTS = ("S1.N_oil", "S1.N_metL", "S1.N_metG")  # of separator 1: what a start kick moves
WORDS: Mapping[str, tuple[str, ...]] = {
    "stem": ("quasi_static", "full"), "turbine": ("direct", "lag"), "anti_surge": ("on", "off", "gradient"),
}  # fmt: skip
SLUG = {"slug.flow": 400.0, "slug.gas": 0.05, "slug.period": 500.0}
SINE = {"sine.amplitude": 0.1, "sine.period": 500.0}
STIFF = Settings(method="stiff")


def production_subject(
    plant: str | Production = DEFAULT, F_s: float | str = "high", case: int = 1, name: str | None = None
) -> Subject:
    """Return the production plant as a subject; arguments as of ``production_plant``.

    With stiction under constant feed it starts from the kick of the tables, else at rest.

    Raises ``StudyError`` for an unknown set.

    >>> subject = production_subject("B", F_s="high")
    >>> subject.quantities["S1.K_p_pressure"], subject.quantities["F_in"]
    (8.8e-07, 8000.0)
    >>> round(float(subject.build({"F_in": 7000.0}).blocks[0].p[0]))
    7000
    """
    base = SETS[plant] if isinstance(plant, str) and plant in SETS else plant
    if isinstance(base, str):
        raise StudyError(f"no parameter set '{base}'; known: {', '.join(SETS)}; or give a Production")
    title = name or f"production_plant_{case}"
    quantities: dict[str, Value] = {
        "F_in": base.F_in, "Z_I": base.Z_I if case == 1 else 0.25, "F_s": F_s,
        **{f"{valve}.F_s": F_s if valve in STICKY else 0.0 for valve in VALVES},
        "sticky": "+".join(STICKY), **{key: words[0] for key, words in WORDS.items()},
        **SLUG, **SINE, "design.F_in": base.F_in, "design.Z_I": base.Z_I,
        **{key: value for key, value in _numbers(base) if key not in ("F_in", "Z_I")},
    }  # fmt: skip

    def build(values: Mapping[str, Value]) -> Diagram:
        return _plant(base, F_s, case, title, values)

    still = case == 2 or F_s == "none"
    return Subject(
        title, build, quantities, (lambda diagram: diagram) if still else kicked, CHAIN,
        CONTENTS, STIFF,
    )  # fmt: skip


def like_the_plant(diagram: Diagram) -> Subject | None:
    """Return a diagram that has the plant's signals as a subject with its chain and kicks, None if it has not.

    >>> from stickslip.plant import production_plant
    >>> like_the_plant(production_plant()).settings.method
    'stiff'
    """
    if not {signal for signals in CHAIN.values() for signal in signals} <= set(diagram.signals):
        return None
    return Subject(diagram.name, lambda _: diagram, stages=CHAIN, kicked=CONTENTS, settings=STIFF)


def _plant(base: Production, F_s: float | str, case: int, name: str, values: Mapping[str, Value]) -> Diagram:
    given = dict(values)
    for key, words in WORDS.items():
        if given.get(key, words[0]) not in words:
            raise StudyError(f"{key} = {given[key]!r}, but it is {' or '.join(words)}")
    word = {key: str(given.pop(key, words[0])) for key, words in WORDS.items()}
    listed = str(given.pop("sticky", "+".join(STICKY)))
    common = given.pop("F_s", F_s)
    single = {valve: given.pop(f"{valve}.F_s") for valve in VALVES if f"{valve}.F_s" in given}
    sticky = tuple(dict.fromkeys([*(v.strip() for v in listed.split("+") if v.strip()), *single]))
    friction = {valve: single.get(valve, common) for valve in sticky}
    slug = {key[5:]: _number(key, given.pop(key)) for key in SLUG if key in given}
    sine = {key[5:]: _number(key, given.pop(key)) for key in SINE if key in given}
    if slug and sine:
        raise StudyError("slug.* and sine.* exclude each other: the feed either slugs or swings; leave one out")
    F_in, Z_I = (_number(key, given.pop(key)) if key in given else None for key in ("F_in", "Z_I"))
    plant = _changed(base, {key.removeprefix("design."): _number(key, value) for key, value in given.items()})
    F_0 = plant.F_in if F_in is None else F_in
    Z_0 = (plant.Z_I if case == 1 else 0.25) if Z_I is None else Z_I
    feed = None
    if slug:
        feed = feeds.slugs(F_0, Z_0, **slug)
    elif sine:
        feed = feeds.sine(F_0, Z_0, **sine)
    return production_plant(
        plant, sticky, friction, case, feed=feed, stem=word["stem"], anti_surge=ANTI_SURGE[word["anti_surge"]],
        turbine=word["turbine"], F_in=F_0, Z_I=Z_0, name=name,
    )  # fmt: skip


def _number(key: str, value: Value) -> float:
    if isinstance(value, str):
        raise StudyError(f"{key} = '{value}', but it is a number; words are for F_s, sticky, {', '.join(WORDS)}")
    return value


def _numbers(data: Any, prefix: str = "") -> list[tuple[str, float]]:
    """Return all numbers of a dataclass and of those within it, names joined by dots."""
    found: list[tuple[str, float]] = []
    for item in fields(data):
        value = getattr(data, item.name)
        if is_dataclass(value):
            found += _numbers(value, f"{prefix}{item.name}.")
        elif isinstance(value, float):
            found.append((prefix + item.name, value))
    return found


def _changed(data: Any, changes: Mapping[str, float]) -> Any:
    """Return the dataclass with numbers replaced, those within it by dotted names."""
    own: dict[str, Any] = {}
    within: dict[str, dict[str, float]] = {}
    for key, value in changes.items():
        first, dot, rest = key.partition(".")
        if dot:
            within.setdefault(first, {})[rest] = value
        else:
            own[first] = value
    own |= {first: _changed(getattr(data, first), inner) for first, inner in within.items()}
    return replace(data, **own)
