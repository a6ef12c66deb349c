"""Drawings: how they look is judged by eye; here, that nothing overlaps and everything is told."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks import PI, FirstOrder, Gain, Integrator, Step, StickSlip
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import wire
from stickslip.diagram.figures.drawing import _Ink, draw, main_parameters
from stickslip.diagram.figures.placement import grid, wrapped
from stickslip.diagram.figures.routes import sheet
from stickslip.diagram.figures.strokes import branches, strokes
from stickslip.plant.loops import self_regulating_loop

LOOP = self_regulating_loop()


def _nothing(t, x, d, u, p, y):
    for i in range(int(p[1])):
        y[i] = 0.0


class Any(Block):
    """A block with any number of ports whose outputs follow no input at once."""

    kernels = Kernels(out=_nothing, feeds=False)

    def __init__(self, name, inputs, outputs):
        self.ports_in = tuple(Port(f"u{i}") for i in range(len(inputs)))
        self.ports_out = tuple(Port(f"y{i}") for i in range(len(outputs)))
        super().__init__(name=name, params={"K_p": 1.0}, table=[len(outputs)], inputs=inputs, outputs=outputs)


def cascade():
    return wire(
        [
            Step("SP", 0.5),
            PI(K_p=0.8, T_i=100.0, name="outer", inputs={"PV": "L"}, outputs="F_SP"),
            PI(K_p=0.4, T_i=10.0, name="inner", inputs={"SP": "F_SP", "PV": "F"}),
            StickSlip(),
            FirstOrder(K=3.0, tau=10.0, name="pipe", outputs="F"),
            Integrator(K=0.1, T=10.0, name="tank", inputs="F", outputs="L"),
        ],
        name="cascade",
    )


def four_loops():
    def loop(name):
        parts = [PI(K_p=0.4, T_i=10.0), StickSlip(), FirstOrder(K=3.0, tau=10.0)]
        return wire(parts, inputs=["SP"], name=name)

    return wire([Step("SP", 0.5), *(loop(f"loop{i}") for i in range(1, 5))], name="four loops")


@st.composite
def diagrams(draw_from):
    """Any wiring of up to 14 blocks with up to 3 inputs and 2 outputs, some of them nested in up to 2 levels."""
    n = draw_from(st.integers(1, 14))
    groups = draw_from(st.lists(st.sampled_from(["", "a/", "a/b/", "c/"]), min_size=n, max_size=n))
    outs = [[f"{groups[k]}s{k}_{j}" for j in range(draw_from(st.integers(1, 2)))] for k in range(n)]
    known = [signal for signals in outs for signal in signals] + ["open"]
    blocks = [
        Any(f"{groups[k]}b{k}", draw_from(st.lists(st.sampled_from(known), max_size=3, unique=True)), outs[k])
        for k in range(n)
    ]
    read = {signal for block in blocks for signal in block.input_labels}
    kept = [block for block in blocks if block.ports_in or set(block.output_labels) & read]
    driven = {signal for block in kept for signal in block.output_labels}
    read = {signal for block in kept for signal in block.input_labels}
    if not kept:
        return wire([Step("lone", 1.0)], outputs=["lone"])
    return wire(kept, inputs=sorted(read - driven))


def laid_out(diagram, units=None, bands=1):
    plan = grid(diagram, units)
    plan = wrapped(plan, bands) if bands > 1 else plan
    ink = _Ink(diagram, plan, {})
    return plan, sheet(plan, ink.size, ink.label_width, ink.entry_width)


def apart(a, b):
    """Tell whether two rectangles (left, top, right, bottom) have nothing in common."""
    return a[2] < b[0] or b[2] < a[0] or a[3] < b[1] or b[3] < a[1]


def rectangle(box):
    return box.x - box.width / 2, box.y - box.height / 2, box.x + box.width / 2, box.y + box.height / 2


def check_drawing(diagram, units=None, bands=1):
    """Check all that a drawing promises."""
    plan, laid = laid_out(diagram, units, bands)
    boxes = [rectangle(box) for box in laid.boxes]
    for a, b in itertools.combinations(boxes, 2):
        assert apart(a, b), "boxes overlap"
    for left, top, right, bottom in [*boxes, *laid.frames.values()]:
        assert min(left, top) > -1e-6, "off the sheet"
        assert right < laid.width + 1e-6 and bottom < laid.height + 1e-6, "off the sheet"
    for group, frame in laid.frames.items():
        for node, box in zip(plan.nodes, boxes, strict=True):
            inside = node.group[: len(group)] == group
            held = frame[0] < box[0] and frame[1] < box[1] and box[2] < frame[2] and box[3] < frame[3]
            assert held if inside else apart(frame, box), f"{node.name} and the frame of {group}"
    for (g1, f1), (g2, f2) in itertools.combinations(laid.frames.items(), 2):
        if g1[: len(g2)] != g2 and g2[: len(g1)] != g1:
            assert apart(f1, f2), "frames overlap"
    for arrow, line in zip(plan.arrows, laid.lines, strict=True):
        source, target = boxes[arrow.source], boxes[arrow.target]
        assert line[0][0] == pytest.approx(source[2]) and source[1] <= line[0][1] <= source[3], (
            "does not leave its box on the right"
        )
        assert line[-1][0] == pytest.approx(target[0]) and target[1] <= line[-1][1] <= target[3], (
            "does not enter on the left"
        )
        for (x1, y1), (x2, y2) in itertools.pairwise(line):
            assert x1 == x2 or y1 == y2, "not orthogonal"
            stretch = min(x1, x2), min(y1, y2), max(x1, x2), max(y1, y2)
            for box in boxes:
                grown = box[0] + 0.1, box[1] + 0.1, box[2] - 0.1, box[3] - 0.1
                assert apart(stretch, grown), f"{arrow.signal} runs through a box"
    ends = [(a.target, line[-1]) for a, line in zip(plan.arrows, laid.lines, strict=True)]
    assert len(set(ends)) == len(ends), "two arrows enter at one point"
    check_no_shared_lines(plan, laid)


def check_no_shared_lines(plan, laid):
    segments = {}
    for arrow, line in zip(plan.arrows, laid.lines, strict=True):
        for (x1, y1), (x2, y2) in itertools.pairwise(line):
            key = ("h", y1, min(x1, x2), max(x1, x2)) if y1 == y2 else ("v", x1, min(y1, y2), max(y1, y2))
            segments.setdefault(arrow.signal, set()).add(key)
    for (s1, one), (s2, two) in itertools.combinations(segments.items(), 2):
        for (d1, level1, a1, b1), (d2, level2, a2, b2) in itertools.product(one, two):
            if d1 == d2 and abs(level1 - level2) < 0.5:
                assert min(b1, b2) - max(a1, a2) < 0.5, f"{s1} and {s2} share a line"


@pytest.mark.parametrize("diagram", [LOOP, cascade(), four_loops()], ids=lambda d: d.name)
def test_loops_are_drawn_clearly(diagram):
    check_drawing(diagram)


@settings(max_examples=80)
@given(diagrams())
def test_any_diagram_is_drawn_clearly(diagram):
    check_drawing(diagram)


@settings(max_examples=60)
@given(diagrams(), st.integers(2, 4))
def test_a_drawing_that_goes_on_below_is_as_clear(diagram, bands):
    check_drawing(diagram, bands=bands)


def test_the_plant_fits_a_page():
    from stickslip.diagram.figures.drawing import WIDEST
    from stickslip.plant import production_plant

    plant = production_plant()
    check_drawing(plant, bands=5)
    figure = plant.plot()
    width, height = 72.0 * figure.get_size_inches()
    assert width <= WIDEST + 40.0 and height < 2.0 * width, "1600 pixels wide at the size of its text"
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert {block.name for block in plant.blocks} <= set(texts), "every block is there"


def test_a_loop_stands_in_one_line_with_its_feedback_below():
    plan, laid = laid_out(LOOP)
    order = sorted(range(len(plan.nodes)), key=lambda v: laid.boxes[v].x)
    assert [plan.nodes[v].name for v in order] == ["SP", "controller", "valve", "process"]
    assert len({box.y for box in laid.boxes}) == 1
    back = next(line for arrow, line in zip(plan.arrows, laid.lines, strict=True) if arrow.signal == "PV")
    assert max(y for _, y in back) > max(box.y + box.height / 2 for box in laid.boxes)
    straight = [line for arrow, line in zip(plan.arrows, laid.lines, strict=True) if arrow.signal in ("SP", "OP", "MV")]
    assert all(len(line) == 2 for line in straight)


def test_a_cascade_nests_its_feedbacks():
    plan, laid = laid_out(cascade())
    order = sorted(range(len(plan.nodes)), key=lambda v: laid.boxes[v].x)
    assert [plan.nodes[v].name for v in order] == ["SP", "outer", "inner", "valve", "pipe", "tank"]
    depth = {
        arrow.signal: max(y for _, y in line)
        for arrow, line in zip(plan.arrows, laid.lines, strict=True)
        if arrow.target in (1, 2) and len(line) > 2
    }
    assert depth["L"] > depth["F"], "the outer loop goes round the inner"
    assert len(branches(plan, laid)) == 1, "F parts once: to the tank and back"


def test_loops_stay_inside_their_frames():
    plan, laid = laid_out(four_loops())
    assert list(laid.frames) == [("loop1",), ("loop2",), ("loop3",), ("loop4",)]
    tops = [frame[1] for frame in laid.frames.values()]
    assert tops == sorted(tops), "in the order given"
    for arrow, line in zip(plan.arrows, laid.lines, strict=True):
        if arrow.signal != "SP":
            left, top, right, bottom = laid.frames[plan.nodes[arrow.source].group]
            assert all(left < x < right and top < y < bottom for x, y in line), f"{arrow.signal} leaves its loop"


def test_what_arrows_share_is_drawn_once():
    plan, laid = laid_out(four_loops())
    drawn = strokes(plan, laid)
    for (x1, y1), (x2, y2) in itertools.combinations(drawn, 2):
        if x1[0] == x1[1] == x2[0] == x2[1]:
            assert min(y1[1], y2[1]) < max(y1[0], y2[0])
        if y1[0] == y1[1] == y2[0] == y2[1]:
            assert min(x1[1], x2[1]) < max(x1[0], x2[0])


def test_every_name_signal_unit_and_value_is_told():
    texts = [text.get_text() for text in draw(LOOP).axes[0].texts]
    for expected in ("self_regulating_loop", "SP", "controller", "valve", "process", "OP", "MV", "PV", "stick slip"):
        assert expected in texts
    assert "$K_{p}$ = 0.4" in texts and "$F_{s}$ = 2250" in texts and "$\\tau$ = 10" in texts
    tank = wire([Step("F", 1.0, unit="m3/s"), Gain("V", "F", 2.0, unit="m3")], outputs=["V"], name="tank")
    texts = [text.get_text() for text in draw(tank).axes[0].texts]
    assert "F [m3/s]" in texts and "V [m3]" in texts


def test_open_ends_are_ovals():
    plan, _ = laid_out(wire([StickSlip(), FirstOrder(K=3.0, tau=10.0)], inputs=["OP"], outputs=["PV"]))
    assert [(node.kind, node.name) for node in plan.nodes if node.kind != "block"] == [
        ("input", "OP"),
        ("output", "PV"),
    ]
    plan, _ = laid_out(LOOP)
    assert all(node.kind == "block" for node in plan.nodes), "a closed loop has no open ends"


def test_dollars_and_underscores_in_names_are_text():
    odd = wire([Step("S$P_1$", 0.5, name="a$b_c$")], outputs=["S$P_1$"], name="100 $ plant $")
    assert draw(odd).axes[0].texts[0].get_text() == "100 $ plant $"
    draw(odd).canvas.draw()


def test_parameters_that_are_zero_or_infinite_are_left_out():
    assert main_parameters(FirstOrder(K=3.0, tau=10.0)) == ["$K$ = 3", "$\\tau$ = 10"]
    assert len(main_parameters(FirstOrder(K=3.0, tau=10.0, theta=2.0))) == 3
    assert main_parameters(Step("SP", 0.0)) == ["before = 0", "after = 0"]


def test_diagrams_plot_themselves():
    assert LOOP.plot().axes[0].texts[0].get_text() == "self_regulating_loop"


def test_the_plant_is_folded_by_unit_to_fit_a_page():
    from stickslip.diagram.wiring import WiringError
    from stickslip.plant import production_plant
    from stickslip.plant.units import units

    plant = production_plant()
    folded = units(plant)
    inside = [name for names in folded.values() for name in names]
    assert sorted(inside) == sorted(block.name for block in plant.blocks), "every block in one unit"
    check_drawing(plant, folded)
    figure = plant.plot(folded)
    assert figure.get_figheight() < 0.3 * plant.plot().get_figheight()
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert {"separator 1", "13 blocks"} <= set(texts)
    assert any("VPCS1" in text for text in texts), "what is inside is said"
    home = {name: unit for unit, names in folded.items() for name in names}
    crossing = {
        signal
        for block in plant.blocks for signal in block.input_labels
        if home[plant.blocks[plant.driven[signal][0]].name] != home[block.name]
    }  # fmt: skip
    assert {arrow.signal for arrow in grid(plant, folded).arrows} == crossing
    with pytest.raises(WiringError, match="S9"):
        plant.plot({"nowhere": ["S9"]})


def test_a_sum_shows_the_sign_of_each_input():
    from stickslip.blocks import Sum

    parts = [Step("SP", 0.5), Step("PV", 0.2), Step("F", 1.0), Sum("e", {"SP": 1.0, "PV": -1.0, "F": -0.5})]
    texts = [text.get_text() for text in draw(wire(parts, outputs=["e"])).axes[0].texts]
    signs = {text.split()[0] + (" 0.5" if "0.5 ×" in text else "") for text in texts if text[0] in "+−"}
    assert signs == {"+", "−", "− 0.5"}
