"""Every block says what it is in a loop, and the rooms that need to know ask it instead of guessing."""

import ast
import pickle
from pathlib import Path

import pytest
import stickslip.detect.blocks
from stickslip.blocks import (
    PI,
    AntiSurge,
    BlockError,
    Equations,
    Flare,
    LuGreStem,
    SampledFunction,
    Sine,
    StateSpace,
    Step,
    StickSlip,
    StribeckStem,
)
from stickslip.blocks.block import Block
from stickslip.blocks.declared import PARTS
from stickslip.blocks.role import Role
from stickslip.diagram import wire
from stickslip.diagram.figures.drawing import colour
from stickslip.diagram.linear import linearise
from stickslip.plant import production_plant
from stickslip.plant.loops import self_regulating_loop
from stickslip.study.measures import limits
from stickslip.study.subject import as_subject

from stickslip import blocks
from stickslip.commands.blocks import BLOCKS

ROOT = Path(__file__).resolve().parents[2]
ASKING = [
    path for room in ("diagram", "study", "plant", "cases", "stickslip") for path in sorted((ROOT / room).rglob("*.py"))
]
NAMED = {getattr(blocks, name).__name__ for name in blocks.__all__ if isinstance(getattr(blocks, name), type)}
GENERAL = {"Block", "Port"}  # what every block is, and a part of it


@pytest.mark.parametrize("name", [name for group in BLOCKS.values() for name in group])
def test_every_block_of_the_catalogue_declares_a_role(name: str) -> None:
    own = [vars(base)["role"] for base in getattr(blocks, name).__mro__ if "role" in vars(base) and base is not Block]
    assert own and isinstance(own[0], Role), f"{name} declares no role"


def test_every_role_has_a_block() -> None:
    blocks_of_detectors = [getattr(stickslip.detect.blocks, name) for name in stickslip.detect.blocks.__all__]
    known = [*(getattr(blocks, name) for group in BLOCKS.values() for name in group), *blocks_of_detectors]
    assert {made.role for made in known} == set(Role)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("Constant", "source"), ("Sine", "source"), ("Slug", "disturbance"), ("Noise", "disturbance"),
        ("PI", "controller"), ("SampledPI", "controller"), ("AntiSurge", "controller"), ("StickSlip", "valve"),
        ("KanoValve", "valve"), ("Deadband", "valve"), ("ControlValveFlow", "process"), ("FirstOrder", "process"),
        ("SampledSensor", "sensor"), ("SampledPID", "controller"),
        ("Historian", "historian"), ("Sum", "arithmetic"), ("DetectorBlock", "detector"), ("PrefilterBlock", "filter"),
    ],
)  # fmt: skip
def test_roles_are_what_an_engineer_expects(name: str, role: str) -> None:
    assert getattr(blocks, name, None) or getattr(stickslip.detect.blocks, name)
    assert (getattr(blocks, name, None) or getattr(stickslip.detect.blocks, name)).role == role


def guesses(source: str) -> list[str]:
    """Return where a file asks for a class of block, or looks for a part of a loop among ports and parameters."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "isinstance":
            asked = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
            found += [ast.unparse(node)] if (asked & NAMED) - GENERAL else []
        if isinstance(node, ast.Compare):
            text = ast.unparse(node)
            about = any(word in text for word in ("port", "param_names", ".modes"))
            words = {n.value for n in ast.walk(node) if isinstance(n, ast.Constant)}
            found += [text] if about and words & {*PARTS, "K_p", "low", "high", "stuck", "ideal"} else []
    return found


@pytest.mark.parametrize("path", ASKING, ids=[str(path.relative_to(ROOT)) for path in ASKING])
def test_nobody_guesses(path: Path) -> None:
    assert guesses(path.read_text()) == []


@pytest.mark.parametrize(
    "line",
    [
        "isinstance(block, AntiSurge)",
        "isinstance(block, (Constant, Step))",
        '{"SP", "PV"} <= {port.name for port in block.ports_in}',
        'port.name == "PV"',
        '"stuck" in block.modes',
        '{"K_p", "low"} <= set(block.param_names)',
    ],
)
def test_the_rule_finds_what_was_guessed_before(line: str) -> None:
    assert guesses(line) == [line.replace('"', "'")]


def test_a_port_plays_the_part_it_is_named_after_or_the_one_the_block_says() -> None:
    controller = PI(1.0, 10.0, inputs=["LC_SP", "level"], outputs="LC_OP")
    assert [controller.loop_signal(part) for part in PARTS] == ["LC_SP", "level", "LC_OP", None]
    assert AntiSurge().loop_signal("PV") == "q" and AntiSurge().loop_signal("SP") is None


def test_limits_are_those_of_the_output() -> None:
    assert PI(1.0, 10.0, low=0.1, high=0.9).limits == (0.1, 0.9)
    assert StribeckStem(low=-0.1).limits == LuGreStem(low=-0.1).limits == (-0.1, 1.0)
    assert Step("SP").limits == (-float("inf"), float("inf"))
    assert StickSlip().can_stick and not PI(1.0, 10.0).can_stick and not Flare().can_stick


def test_a_general_block_is_given_its_role() -> None:
    law = Equations("PC", out=lambda r, y: 2.0 * (r - y), inputs=["r", "y"], outputs="u")
    assert law.role is Role.PROCESS and colour(law) == "plain"
    named = law.with_role("controller", SP="r", PV="y", OP="u")
    assert law.role is Role.PROCESS  # the first one stays as it was
    assert named.relabelled("loop/PC", ["a", "b"], ["c"]).loop_signal("PV") == "b"
    assert colour(named) == "controller"
    kept = pickle.loads(pickle.dumps(StateSpace([[-1.0]], [[1.0]], [[1.0]]).with_role("sensor")))
    assert kept.role is Role.SENSOR
    for wrong, message in (
        (lambda: law.with_role("controler"), "did you mean 'controller'"),
        (lambda: law.with_role("controller", SV="r"), "'SV' is no part in a loop"),
        (lambda: law.with_role("controller", SP="x"), "has no port 'x'"),
    ):
        with pytest.raises(BlockError, match=message):
            wrong()


def test_a_function_without_inputs_is_a_source() -> None:
    assert Equations("SP", out=lambda t: 0.5 * t, outputs="SP").role is Role.SOURCE
    assert SampledFunction("SP", step=lambda t: t, inputs=(), outputs="SP", dt=1.0).role is Role.SOURCE


def test_linearisation_finds_a_controller_by_its_role_alone() -> None:
    """The same law as PI of ``self_regulating_loop``, as plain functions with ports of other names (analytic: L)."""
    loop = self_regulating_loop()
    pi = loop["controller"]
    law = Equations(
        "law", der=lambda r, y, K_p, T_i: K_p * (r - y) / T_i, out=lambda z, r, y, K_p: K_p * (r - y) + z,
        states={"z": float(pi.x0[0])}, inputs=["r", "y"], outputs="u",
        params={"K_p": pi.params["K_p"], "T_i": pi.params["T_i"]},
    )  # fmt: skip
    plain = linearise(loop.replace("controller", law))
    assert plain.controllers == ()
    found = linearise(loop.replace("controller", law.with_role("controller", SP="r", PV="y", OP="u")))
    assert found.controllers == ("controller",)
    assert found.loop("controller").crossover == pytest.approx(linearise(loop).loop("controller").crossover, rel=1e-9)


def test_a_study_measures_what_no_source_gives() -> None:
    loop = wire([Sine("SP", 0.1, 60.0), PI(1.0, 10.0, outputs="MV", start_op=0.5), Equations("P", out=lambda x: x,
                der=lambda x, MV: MV - x, states={"x": 0.5}, inputs="MV", outputs="PV")])  # fmt: skip
    assert as_subject(loop).signals == ("MV", "PV") and as_subject(loop).kicked == ("P.x",)


def test_limits_of_the_production_plant_are_found_by_role() -> None:
    plant = production_plant()
    outputs = {block.output_labels[0] for block in plant.blocks if "K_p" in block.param_names}
    finite = {
        s for s in outputs if any(abs(end) < float("inf") for end in plant.blocks[plant.driven[s][0]].limits)
    }  # fmt: skip
    assert set(limits(plant, plant.signals)) == finite  # the same controllers as by their parameters
