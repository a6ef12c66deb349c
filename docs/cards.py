"""The cards of blocks, effects, methods and remedies as short scripts that the gallery runs; ``docs/build.py`` asks.

A card has what the docstring says (equation, source, limits), facts as a list, and a snippet that draws a picture.
"""

import inspect
import math
import sys
from collections.abc import Iterator, Sequence

from docstrings import as_rst
from stickslip.detect import METHODS, Method
from stickslip.detect.cards import CARD_COLUMNS, card_rows
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect
from stickslip.remedy.measures import REMEDIES
from trials import TRIALS

from stickslip.commands.blocks import Entry, entries

# effect -> place, values and, where it is not a loop of SP, PV and OP, the signals to draw
SIZES: dict[str, tuple[str, dict[str, float], tuple[str, ...]]] = {
    "stiction": ("valve", {"S": 5.0, "J": 2.0}, ()),
    "deadband": ("valve", {"width": 3.0}, ()),
    "valve_leak": ("valve", {"flow": 2.0}, ()),
    "valve_saturation": ("valve", {"high": 55.0}, ()),
    "valve_rate_limit": ("valve", {"rate": 1.0}, ()),
    "positioner_lag": ("valve", {"tau": 3.0}, ()),
    "valve_characteristic": ("valve", {"rangeability": 10.0}, ()),
    "valve_gain": ("valve", {"factor": 1.2}, ()),
    "dead_time": ("process", {"theta": 3.0}, ()),
    "process_gain": ("process", {"factor": 1.2}, ()),
    "process_time_constant": ("process", {"factor": 1.3}, ()),
    "second_lag": ("process", {"tau": 3.0}, ()),
    "tank_overflow": ("tank_1", {"level": 6.0, "share": 0.5}, ("h_1", "y")),
    "sensor_bias": ("sensor", {"offset": -0.1}, ()),
    "sensor_drift": ("sensor", {"rate": 0.5}, ()),
    "sensor_span": ("sensor", {"factor": 1.1}, ()),
    "sensor_lag": ("sensor", {"tau": 3.0}, ()),
    "sensor_noise": ("sensor", {"factor": 4.0}, ()),
    "quantisation": ("sensor", {"step": 0.05}, ()),
    "sensor_saturation": ("sensor", {"high": 1.7}, ()),
    "compression": ("historian", {"deviation": 0.05}, ()),
    "controller_gain": ("controller", {"factor": 1.5}, ()),
    "controller_integral_time": ("controller", {"factor": 1.5}, ()),
    "controller_limits": ("controller", {"high": 58.0}, ()),
    "controller_filter": ("controller", {"tau": 3.0}, ()),
    "scan_time": ("controller", {"period": 4.0}, ()),
    "derivative_action": ("controller", {"T_d": 3.0}, ()),
    "gain_schedule": ("controller", {"slope": 1.0}, ()),
    "setpoint_filter": ("controller", {"tau": 5.0}, ()),
    "setpoint_ramp": ("controller", {"rate": 0.02}, ()),
    "setpoint_weight": ("controller", {"b": 0.4}, ()),
    "lead": ("process", {"T": -3.0}, ()),
    "sine_disturbance": ("feed", {"amplitude": 0.05, "period": 60.0}, ()),
    "step_disturbance": ("feed", {"amplitude": 0.05, "time": 50.0}, ()),
    "slug": ("feed", {"amplitude": 0.05, "period": 90.0}, ()),
    "horizontal_separator": ("S1", {"share": 1.0}, ("V_1", "p_1")),
    "boil_off_rate": ("S1", {"factor": 0.7}, ("p_1", "V_1")),
    "vapour_pressure": ("S2", {"factor": 1.05}, ("p_2", "V_2")),
    "real_gas": ("S1", {"factor": 0.92}, ("p_1", "V_1")),
    "gas_temperature": ("S1", {"factor": 0.97}, ("p_1", "V_1")),
    "compressor_fouling": ("C2", {"factor": 0.96}, ("p_out2", "tau_d")),
    "compressor_map_shift": ("C3", {"factor": 0.95}, ("p_out3", "tau_d")),
    "recycle_leak": ("VRVC2_body", {"flow": 3.0}, ("m_rv2", "tau_d")),
    "shaft_friction": ("shaft", {"coefficient": 0.5}, ("w", "tau_d")),
    "line_friction": ("C2_pipe", {"factor": 1.3}, ("p_out2", "tau_d")),
}
PLOT = """
figure = Figure(figsize=(8, 4), layout="constrained")
for panel, name in zip(figure.subplots(2, sharex=True), {signals}, strict=True):
    for run, label in ((model, "model"), (site, "with the effect")):
        panel.plot(run.t, run[name], label=label)
    panel.set_ylabel(name)
figure.axes[0].legend()
figure.axes[1].set_xlabel("time [s]")
figure"""
LOOP = """
model = ideal_flow(rest=1.5){quiet}
site = effect("{name}").insert(model, "{place}", {values})
inputs = {{"SP": Staircase("SP", [1.5, 1.8, 1.35, 1.65], dwell=100.0)}}
model, site = (simulate(diagram, 400.0, every=1.0, inputs=inputs).log for diagram in (model, site))"""
HISTORIAN = """
inputs = {{"SP": Staircase("SP", [1.5, 1.8, 1.35, 1.65], dwell=100.0)}}
model = simulate(ideal_flow(rest=1.5), 400.0, every=1.0, inputs=inputs).log
site = effect("{name}").on_log(model, "{place}", {values})"""
TANKS = """
model = cascaded_tanks()
site = effect("{name}").insert(model, "{place}", {values})
inputs = {{"u": Staircase("u", [2.0, 6.0, 3.0], dwell=300.0)}}
model, site = (simulate(diagram, 900.0, every=1.0, inputs=inputs).log for diagram in (model, site))"""
PLANT = """
model = kicked(production_plant())
site = effect("{name}").insert(model, "{place}", {values})
model, site = (simulate(diagram, 120.0, every=1.0, method="stiff").log for diagram in (model, site))"""


def cards() -> Iterator[tuple[str, str, str]]:
    """Yield gallery, name and script of every card, and the header of each gallery as ``GALLERY_HEADER.rst``."""
    for gallery, title, about in (
        ("blocks", "Blocks in pictures", "Each with its equation, ports and a run; :doc:`/blocks` is the table."),
        ("effects", "Effects in pictures", "Each with and without; :doc:`/effects` says where each may be."),
        ("detectors", "Methods in pictures", "What each needs and shows; :doc:`/methods` says which to take."),
    ):
        yield gallery, "GALLERY_HEADER.rst", f"{title}\n{'=' * len(title)}\n\n{about}\n"
    for entry in entries():
        yield "blocks", f"{entry.name}.py", block_card(entry)
    for effect in CATALOGUE:
        yield "effects", f"{effect.name}.py", effect_card(effect)
    for method, row in zip(METHODS, card_rows(METHODS), strict=True):
        yield "detectors", f"{method.CARD.name}.py", method_card(method, row)
    yield "remedies", "GALLERY_HEADER.rst", "All remedies\n============\n"
    yield "remedies", "remedies.py", remedies()


def block_card(entry: Entry) -> str:
    """Return the card of a block: its page, and its run among sines or in a small loop."""
    trial = TRIALS[entry.name]
    parts = [*trial.drives(), trial.code]
    names = sorted({part.partition("(")[0].partition(".")[0] for part in parts})
    shown = list(dict.fromkeys([*trial.block().input_labels, *trial.block().output_labels]))[:6]
    driven = "" if trial.around else f", outputs={shown}"
    code = [
        f"from stickslip.blocks import {', '.join(names)}", "from stickslip.diagram import simulate, wire", "",
        "diagram = wire([", *(f"    {part}," for part in parts), f"]{driven})",
        f"simulate(diagram, 100.0, every=0.25).plot({shown})",
    ]  # fmt: skip
    values = ", ".join(f"{k} = {'given' if v is None else f'{v:g}'}" for k, v in entry.parameters.items())
    facts = {
        "in": ", ".join(entry.inputs), "out": ", ".join(entry.outputs), "parameters": values,
        "states": ", ".join(entry.states), "modes": ", ".join(entry.modes), "source": entry.source,
        "file": entry.file,
    }  # fmt: skip
    return card(entry.name, entry.what, entry.page, facts, code)


def effect_card(effect: Effect) -> str:
    """Return the card of an effect: what it does, its parameters, and a loop or plant with and without it."""
    place, values, signals = SIZES[effect.name]
    form = PLANT if signals else LOOP
    named = ["from matplotlib.figure import Figure", "from stickslip.diagram import simulate"]
    if effect.of_log:
        form = HISTORIAN
    if effect.name == "tank_overflow":
        form = TANKS
    named += {
        PLANT: ["from stickslip.plant import kicked, production_plant"],
        TANKS: ["from stickslip.blocks import Staircase", "from stickslip.cases.models import cascaded_tanks"],
    }.get(form, ["from stickslip.blocks import Staircase", "from stickslip.cases.models import ideal_flow"])
    quiet = "" if effect.name == "sensor_noise" else '.with_params({"noise.sd": 0.0})'
    said = ", ".join(f"{key}={value}" for key, value in values.items())
    code = [
        *named, "from stickslip.gap.effects import effect",
        form.format(name=effect.name, place=place, values=said, quiet=quiet),
        PLOT.format(signals=signals or ("PV", "OP")),
    ]  # fmt: skip
    neutral = {p.name: "the model's" if math.isnan(p.neutral) else f"{p.neutral:g}" for p in effect.parameters}
    facts = {"at a": str(effect.role)} | {
        p.name: f"[{p.unit}], neutral at {neutral[p.name]}, from {p.low:g} to {p.high:g}"
        + {"": "", "span": " of the span", "time": " of the loop's time", "size": " of the source's size"}[p.per]
        for p in effect.parameters
    }
    doc = inspect.getdoc(sys.modules[type(effect).__module__]) or ""
    return card(effect.name, "", doc, facts, code)


def method_card(method: Method, row: Sequence[str]) -> str:
    """Return the card of a method: its page, what it needs, and its verdict on a record."""
    export = "FIC101_pi_export.csv" if "self_regulating" in method.CARD.process else "LIC410_level.csv"
    code = [
        "from stickslip.cases.stories import EXPORTS",
        f"from stickslip.detect.methods import {method.CARD.name}",
        "from stickslip.logs import read_loop", "", f'record = read_loop(EXPORTS / "{export}")',
        f"verdict = {method.CARD.name}.detect(record)", 'print(verdict.verdict, "-", verdict.reason)', "verdict.plot()",
    ]  # fmt: skip
    if method.CARD.signals == ("OP", "MV"):  # the exports have no stem
        code[0] = "from stickslip.cases import find"
        code[2:5] = ["", 'record = find("ideal_high").run().log.loop_records()[0]']
    doc = inspect.getdoc(sys.modules[method.__name__]) or ""
    return card(method.CARD.name, method.CARD.title, doc, dict(zip(CARD_COLUMNS[1:], row[1:], strict=True)), code)


def remedies() -> str:
    """Return the script of all remedies: the loop is fitted once, and each is tried on it."""
    made = [
        'r"""\nRemedies\n========\n\nEach remedy on one simulated sticky loop, against doing nothing.\n"""\n',
        "# %%\nfrom matplotlib.figure import Figure\nfrom stickslip.remedy import fit, remedies",
        "from stickslip.remedy.example import sticky\n\nadvice = remedies(fit(sticky(hours=2.0, seed=3)))",
        "now, tried = advice.none.outcome.pv, {one.name: one for one in advice.tried}\n",
        '\ndef against_nothing(name):\n    if name not in tried:\n        return print("not possible on this loop")',
        '    figure = Figure(figsize=(8, 2.5), layout="constrained")',
        '    panel = figure.subplots()\n    panel.plot(now, label="as it is")',
        "    panel.plot(tried[name].outcome.pv, label=tried[name].settings)",
        '    panel.set(xlabel="scans", ylabel="PV")\n    panel.legend()\n    return figure\n',
    ]
    for remedy in REMEDIES:
        text = [remedy.TITLE, "-" * len(remedy.TITLE), "", *as_rst(said(inspect.getdoc(remedy) or ""))]
        text += [f"Not where there is: {remedy.NOT_FOR}."] if remedy.NOT_FOR else []
        made += ["# %%", *(f"# {line}".rstrip() for line in text), f'against_nothing("{remedy.TITLE}")\n']
    return "\n".join(made)


def card(title: str, what: str, doc: str, facts: dict[str, str], code: Sequence[str]) -> str:
    """Return the script of a card; ``what`` it is goes first, unless the docstring begins so."""
    first = [] if not what or " ".join(doc.split()).startswith(what) else [f"{what}.", ""]
    text = [title, "=" * len(title), "", *first, *as_rst(said(doc)), ""]
    text += [f"- **{key}**: {as_rst([fact])[0]}" for key, fact in facts.items() if fact]
    return "\n".join(['r"""', *text, '"""', "", "# %%", *code, ""])


def said(doc: str) -> list[str]:
    """Return the lines of a docstring, fit to stand in one of a script."""
    return doc.replace('"""', "'''").splitlines()
