"""The work of reading a file grows with the number of its loops, not faster: counted in steps of the interpreter."""

import sys

import numpy as np
import pytest
from stickslip.logs import Log, LoopSignals, read_log, read_loops

ROWS = 4
LAYOUTS = ("wide", "stems", "quality", "strays", "long", "own")


def file_of(folder, layout, count):
    """A file of so many loops in one of the ways that files have them."""
    kinds = {"stems": ("SP", "PV", "OP", "ZT"), "quality": ("PV", "OP", "Quality"), "own": ("PV", "OP", "good")}
    names, loops = [], {}
    for i in range(count):
        for part in kinds.get(layout, ("SP", "PV", "OP")):
            names.append(f"ZT{i:03d}" if part == "ZT" else f"FIC{i:03d}.{part}")
        names += [f"TI{i:03d}.PV"] * (layout == "strays")
        loops[f"FIC{i:03d}"] = LoopSignals(f"FIC{i:03d}.PV", f"FIC{i:03d}.OP")
    cell = {name: "Good" if name.endswith("Quality") else f"{50 + i % 7}.5" for i, name in enumerate(names)}
    path = folder / f"{layout}{count}.csv"
    if layout == "own":
        signals = {name: np.full(ROWS, 50.0) for name in names if not name.endswith("good")}
        good = {name: np.arange(ROWS) > 0 for name in signals}
        Log(t=np.arange(ROWS), signals=signals, quality=good, units=dict.fromkeys(signals, "%"), loops=loops).to_csv(
            path
        )
    elif layout == "long":
        rows = [f"{name},{k},{cell[name]},Good" for name in names for k in range(ROWS)]
        path.write_text("\n".join(["tag,time,value,quality", *rows]))
    else:
        rows = [",".join([str(k), *cell.values()]) for k in range(ROWS)]
        path.write_text("\n".join([",".join(["time", *names]), *rows]))
    return path


def steps(function):
    """Return how many instructions of Python a call takes within the house, comprehensions and all."""
    count = 0

    def trace(frame, event, arg):
        nonlocal count
        if not frame.f_globals.get("__name__", "").startswith("stickslip.logs"):
            return None
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        count += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        function()
    finally:
        sys.settrace(before)
    return count


def growth(function):
    """The exponent of what a call costs with 8, 16 and 32 of something, whatever it costs with none."""
    few, more, many = function(8), function(16), function(32)
    return np.log2((many - more) / (more - few))


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("read", [read_log, read_loops])
def test_work_grows_with_the_number_of_loops(tmp_path, read, layout):
    read(file_of(tmp_path, layout, 2))  # what is loaded once
    files = {count: file_of(tmp_path, layout, count) for count in (8, 16, 32)}
    assert len(read_loops(files[32])) == 32 == len(read_log(files[32]).loops)
    assert growth(lambda count: steps(lambda: read(files[count]))) < 1.1


def test_the_count_knows_linear_from_quadratic():
    from stickslip.logs import loop_signals

    loops = {f"FC{i}": LoopSignals(f"p{i}", f"u{i}") for i in range(32)}
    signals = [name for loop in loops.values() for name in (loop.pv, loop.op)]

    def within(count):
        loop_signals.within(dict(list(loops.items())[:count]), signals)

    assert growth(lambda count: steps(lambda: within(count))) == pytest.approx(1.0)  # analytic
    assert growth(lambda count: steps(lambda: [within(count) for _ in range(count)])) == pytest.approx(
        2.0, abs=0.01
    )  # analytic; setting up is linear


def test_a_heading_of_any_length_is_read_whole(tmp_path):
    loops = {"FIC1": LoopSignals("FIC1.PV", "FIC1.OP")}
    signals = {"FIC1.PV": [1.0, 2.0], "FIC1.OP": [50.0, 51.0]}
    log = Log([0.0, 1.0], signals, notes=tuple(f"{i}: {'a long note ' * 40}" for i in range(600)), loops=loops)
    log.to_csv(tmp_path / "own.csv")
    assert read_log(tmp_path / "own.csv").loops == loops


def test_quality_columns_of_the_other_loops_are_not_called_unused(tmp_path):
    path = tmp_path / "unit.csv"
    path.write_text(
        "time,FIC1.PV,FIC1.OP,FIC1.PV.ST,LIC2.PV,LIC2.OP,LIC2.Quality,TI3.PV,TI3.PV.ST\n"
        "0,1,50,192,2,60,Good,3,192\n1,2,51,192,3,61,Good,3,192\n"
    )
    for record in read_loops(path):
        assert [note for note in record.notes if note.startswith("Columns not used")] == [
            "Columns not used: 'TI3.PV' (PV of TI3), 'TI3.PV.ST' (quality of 'TI3.PV')."
        ]
