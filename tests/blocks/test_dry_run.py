"""Kernels with planted mistakes: each is refused with its block's name, or ends with a status; none crashes or hangs.

Each is tried in a process of its own (a fork, so that the engine need not be loaded again).
"""

import importlib.util
import inspect
import multiprocessing
import os
import sys
import textwrap
from dataclasses import replace

import pytest
from stickslip.blocks import BlockError, Equations, Step
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.dry_run import dry_run
from stickslip.blocks.ports import Port
from stickslip.diagram import simulate, wire
from stickslip.engine.status import Status

from stickslip import blocks
from stickslip.commands.blocks import NEEDED, _missing, entries

RIGHT = {
    "out": "out[0] = x[0]",
    "der": "out[0] = p[0] * (u[0] - x[0])",
    "zc": "out[0] = x[0] - p[1] - d[1]",
    "jump": "d[1] = d[1] + 1.0",
    "next_time": "out[0] = 5.0 if t < 5.0 else math.inf",
    "step": "d[0] = d[0] + u[0]; out[0] = d[0]",
}
ANYWHERE = [
    "out[1] = 1.0", "out[2] = 1.0", "out[-1] = 1.0", "out[100000] = 1.0", "out[10**9] = 1.0", "p[0] = 2.0",
    "u[0] = 1.0",
    "out[0] = p[2]", "out[0] = p[-1]", "out[0] = u[1]", "out[0] = x[1]", "out[0] = d[2]", "out[int(u[0])] = 1.0",
    "out[0] = p[int(u[0])]", "raise ValueError('no')", "assert u[0] > 100.0", "print(u[0])", "out[0] = 'high'",
    "out[0] = nowhere", "while True: pass", "while u[0] > 0.0: t += 1.0", "out[0] = again(u[0])",
    "out[0] = [1.0, 2.0][int(100 * u[0])]", "out[0] = math.nan" , "out[0] = TABLE[int(1000 * u[0])]",
]  # fmt: skip
ONLY = {
    "out": ["x[0] = 1.0", "d[1] = 1.0", "pass", "out[0] = out[0] + 1.0", "out[0] = u[0]", "out[0] = helper(u)",
            "if u[0] > 0.5: out[0] = 1.0"],
    "der": ["x[0] = 1.0", "pass", "out[0] = out[0] + 1.0", "out[0] = math.inf", "out[0] = 1e308",
            "out[0] = 1.0 / (x[0] - x[0])"],
    "zc": ["pass", "out[0] = 1.0", "out[0] = out[0]", "d[0] = 1.0"],
    "jump": ["out[0] = 1.0", "d[int(p[1] * 1e9)] = 1.0", "x[0] = math.nan"],
    "next_time": ["out[2] = 1.0", "d[0] = 1.0", "x[0] = 0.0"],
    "step": ["pass", "x[0] = 1.0", "out[0] = out[0] + u[0]", "out[0] = p[int(d[1])]; d[1] = d[1] + 1.0"],
}  # fmt: skip
HARMLESS = {  # of the lines for anywhere: what changes nothing there, or is right there
    ("jump", "out[0] = math.nan"), ("next_time", "out[0] = math.nan"), ("next_time", "out[1] = 1.0"),
}  # fmt: skip
PLANTED = [(kernel, line) for kernel in RIGHT for line in (*ANYWHERE, *ONLY[kernel]) if (kernel, line) not in HARMLESS]
MISSING = [
    {"out": None},
    {"der": None},
    {"zc": None},
    {"jump": None},
    {"n_events": 0},
    {"n_events": 2},
    {"feeds": False},
]
EVERY = int(os.environ.get("STICKSLIP_PLANTED_EVERY", "4"))  # all of them were tried once, with 1

MODULE = """
import math
TABLE = (1.0, 2.0, 3.0)
def again(x):
    return again(x)
def helper(u):
    return u[0]
def kernel(t, x, d, u, p, out):
    {line}
"""


def made(folder, kernel, line, **facts):
    """Return a block with one kernel replaced by a line, as it would stand in somebody's file."""
    functions = {}
    for name, right in RIGHT.items():
        path = folder / f"{name}.py"
        body = textwrap.indent((line if name == kernel else right).replace("; ", "\n"), "    ").strip()
        path.write_text(MODULE.format(line=body))
        spec = importlib.util.spec_from_file_location(f"planted_{name}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        functions[name] = module.kernel
    sampled = kernel == "step"
    step = functions.pop("step")
    use = {"step": step, "feeds": True} if sampled else {**functions, "n_events": 1, "feeds": False}
    data = {"ports_in": (Port("u"),), "ports_out": (Port("y"),), "kernels": Kernels(**use | facts),
            "period_param": "rate" if sampled else None}  # fmt: skip
    states = {} if sampled else {"x": 0.0}
    return type("Planted", (Block,), data)(name="planted", params={"rate": 0.7, "level": 0.3}, states=states,
                                           memory={"a": 0.0, "b": 0.0})  # fmt: skip


def outcome(folder, kernel, line, facts, answer):
    try:
        loop = wire([Step("u", 1.0, at=1.0), made(folder, kernel, line, **facts)], outputs=["y"])
        run = simulate(loop, 10.0, every=1.0, max_steps=10_000)
        answer.send((run.status.name, run.hint))
    except ValueError as error:
        answer.send(("refused", str(error)))


def tried(folder, kernel, line, **facts):
    """Return how it ended in a process of its own: "refused" or a status, and the words for it; or how it died."""
    context = multiprocessing.get_context("fork")
    receive, send = context.Pipe(duplex=False)
    other = context.Process(target=outcome, args=(folder, kernel, line, facts, send))
    other.start()
    send.close()
    try:
        if not receive.poll(60.0):
            return "hangs", ""
        return receive.recv()
    except EOFError:
        other.join()
        return f"died with {other.exitcode}", ""
    finally:
        other.kill()
        other.join()


@pytest.fixture(scope="module", autouse=True)
def engine_is_loaded():
    simulate(wire([Step("u", 1.0)], outputs=["u"]), 1.0)  # before the forks


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
@pytest.mark.parametrize(("kernel", "line"), PLANTED[::EVERY])
def test_a_planted_mistake_is_refused_or_ends_with_a_status(tmp_path, kernel, line):
    how, words = tried(tmp_path, kernel, line)
    assert how == "refused" or how in Status.__members__, how
    assert how != "OK"
    assert "planted" in words  # the words name the block


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
@pytest.mark.parametrize("facts", MISSING, ids=str)
def test_kernels_that_do_not_fit_together_are_refused(tmp_path, facts):
    how, words = tried(tmp_path, "out", "out[0] = x[0] + u[0]", **{"feeds": True} | facts)
    assert how == "refused" and "planted" in words


def test_more_than_a_hundred_are_planted():
    assert len(PLANTED) + len(MISSING) > 100


@pytest.mark.parametrize("kernel", ["out", "step"])
def test_without_a_mistake_it_passes(tmp_path, kernel):
    block = made(tmp_path, kernel, RIGHT[kernel])
    dry_run(block)
    assert simulate(wire([Step("u", 1.0), block], outputs=["y"]), 10.0).ok


def test_a_wrong_feeds_does_not_hide_an_algebraic_loop(tmp_path):
    with pytest.raises(BlockError, match=r"'planted': kernel out \(kernel\) reads u\[0\], but feeds=False"):
        wire([made(tmp_path, "out", "out[0] = x[0] + u[0]").relabelled("planted", ["y"], ["y"])])


def test_a_thousand_loops_cost_one_trial(monkeypatch, tmp_path):
    import stickslip.blocks.dry_run as trial

    calls = []
    plain = trial._Trial.run
    monkeypatch.setattr(trial._Trial, "run", lambda self: (calls.append(self.name), plain(self)))
    monkeypatch.setattr(trial, "_passed", set())
    block = made(tmp_path, "out", RIGHT["out"])
    many = [block.relabelled(f"p{i}", ["u"], [f"y{i}"]) for i in range(1000)]
    wire([Step("u", 1.0), *many])
    assert sorted(calls) == ["der", "jump", "next_time", "next_time", "out", "out", "zc"]  # two of them of the source


READS = ["out[0] = math.sin(t)", "out[0] = x[0] if t < 1e9 else 0.0", "out[0] = max(t, 0.0)", "out[0] = x[0] + t",
         "out[0] = x[0] - x[0] * t", "out[0] = p[0] ** t", "out[0] = t", "out[0] = late(t, x)"]  # fmt: skip


def _timed(tmp_path, line, timed, kernel="out"):
    block = made(tmp_path, kernel, line)
    block.kernels = replace(block.kernels, timed=timed)
    return block


@pytest.mark.parametrize("kernel", ["out", "der"])
@pytest.mark.parametrize("line", READS)
def test_a_kernel_that_reads_the_time_says_so(tmp_path, kernel, line):
    line = line.replace("late(t, x)", "(lambda s, v: v[0] + s)(t, x)")
    with pytest.raises(BlockError, match=rf"'planted': kernel {kernel} \(kernel\) reads the time t, but timed=False"):
        dry_run(_timed(tmp_path, line, timed=False, kernel=kernel))
    dry_run(_timed(tmp_path, line, timed=True, kernel=kernel))


def test_handing_the_time_on_unread_is_not_reading_it(tmp_path):
    dry_run(_timed(tmp_path, "out[0] = (lambda s, v: v[0])(t, x)", timed=False))


def test_every_block_of_the_catalogue_claims_rightly():
    for entry in entries():
        made = getattr(blocks, entry.name)
        dry_run(made(**dict.fromkeys(_missing(inspect.signature(made)), 1.0) | dict(NEEDED.get(entry.name, {}))))
    assert Equations("ramp", out=lambda t: 2.0 * t, outputs="y").kernels.timed
    assert not Equations("gain", out=lambda u: 2.0 * u, inputs="u", outputs="y").kernels.timed


def _settling_der(t, x, d, u, p, dx):
    dx[0] = u[0] - x[0]


class Unseen(Block):
    """A block with a state and no output: the engine would take its missing kernel for a dead time."""

    ports_in = (Port("in"),)
    kernels = Kernels(der=_settling_der, feeds=False)

    def __init__(self):
        super().__init__(name="unseen", params={}, states={"x": 0.0}, inputs="MV")


def test_a_block_without_a_kernel_out_is_refused():
    with pytest.raises(BlockError, match="'unseen': has no kernel out, so nothing could be seen of it; give it an out"):
        wire([Step("MV", 1.0), Unseen()])
