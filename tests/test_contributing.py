"""The templates of CONTRIBUTING run as they stand."""

import doctest
import importlib
import re
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from stickslip.blocks import BlockError, Sensor, Sine
from stickslip.blocks.dry_run import dry_run
from stickslip.cases.stories import EXPORTS
from stickslip.detect import METHODS, compare, diagnose
from stickslip.diagram import drive, simulate, wire
from stickslip.gap.insertion.effect import EffectError
from stickslip.logs import LoopRecord, read_loop

from stickslip.commands.cli import cli

TEMPLATES = re.findall(r"```python\n(.*?)```", (Path(__file__).parents[1] / "CONTRIBUTING.md").read_text(), re.S)


def loaded(number: int, monkeypatch: pytest.MonkeyPatch) -> Any:
    module = types.ModuleType(f"template_{number}")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    exec(compile(TEMPLATES[number], module.__name__, "exec"), vars(module))
    return module


def test_the_block_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    tank = loaded(0, monkeypatch)
    dry_run(tank.Tank(A=2.0))
    level = drive(tank.Tank(A=2.0, k=0.5), 40.0, every=40.0, F=1.0).log["L"][-1]
    assert level == pytest.approx(2.0 * (1.0 - np.exp(-10.0)), rel=1e-5)  # analytic
    with pytest.raises(BlockError, match=r"A = 0\.0, but it must be positive"):
        tank.Tank(A=0.0)
    assert doctest.testmod(tank).attempted == 2 and doctest.testmod(tank).failed == 0


def test_the_detector_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    method = loaded(1, monkeypatch)
    t = np.arange(100.0)
    wave = np.sin(t / 5.0)
    assert method.detect(LoopRecord.from_arrays(t, pv=2.0 * wave, op=wave)).verdict == "stiction"
    assert method.detect(LoopRecord.from_arrays(t, pv=0.5 * wave, op=wave)).index == pytest.approx(0.5)
    assert method.detect(LoopRecord.from_arrays(t, pv=wave, op=0.0 * t)).code == "constant_signal"


@pytest.fixture
def ratio(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The detector's page as a stranger saves it."""
    (tmp_path / "ratio.py").write_text(TEMPLATES[1])
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path / "ratio.py"
    sys.modules.pop("ratio", None)


def test_the_detector_judges_loops_from_the_command_line(ratio: Path) -> None:
    export = str(EXPORTS / "FIC101_pi_export.csv")
    done = CliRunner().invoke(cli, ["table", export, "--method", f"{ratio}:detect", "--json", "-"])
    assert done.exit_code in (0, 1), done.output
    assert "The ratio is" in done.output


def test_the_detector_stands_beside_the_methods_in_python(ratio: Path) -> None:
    mine = importlib.import_module("ratio")
    record = read_loop(EXPORTS / "FIC101_pi_export.csv")
    by_itself = mine.detect(record)
    assert by_itself.index == pytest.approx(np.nanstd(record.pv) / np.nanstd(record.op))  # analytic
    assert [verdict.index for verdict in diagnose(record, [mine]).methods] == [by_itself.index]
    assert [verdict.index for verdict in compare(record, [*METHODS, mine]).loops[0].verdicts][-1] == by_itself.index


def test_the_effect_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    effect = loaded(2, monkeypatch).SensorHysteresis()
    loop = wire([Sine("y", 1.0, 100.0), Sensor(inputs="y", outputs="PV")])
    assert effect.places(loop) == ("sensor",) and effect.insert(loop, "sensor", width=0.0) is loop
    log = simulate(effect.insert(loop, "sensor", width=0.2), 200.0, every=1.0).log
    assert np.abs(log["PV"] - log["y"])[50:].max() == pytest.approx(0.1, abs=1e-6)  # analytic: half the width behind
    with pytest.raises(EffectError, match=r"width = -1, but it must be finite and at least 0; give 0 for none"):
        effect.insert(loop, "sensor", width=-1.0)
