"""Where pytest finds the examples in docstrings: in the modules that users import, ``stickslip.blocks.pi``.

Commands, pages and examples fit few loops, and each many times.  A record is fitted once in each process of tests.
Each process has one thread of linear algebra: those of small matrix products cost more than they save.  A worker of
xdist, and what it starts, keeps to one core: the workers take all of them already, and threads of two workers that
share two cores cost a tenth more of the processor.
"""

import os
import sys
import tomllib
from collections.abc import Generator
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when numpy is first imported
if "PYTEST_XDIST_WORKER" in os.environ and hasattr(os, "sched_setaffinity"):
    cores = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {cores[int(os.environ["PYTEST_XDIST_WORKER"][2:]) % len(cores)]})

import pytest

ROOT = Path(__file__).resolve().parent
TARGETS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]
ROOMS = set(TARGETS["wheel"]["sources"])


def is_in_room(path: Path) -> bool:
    """Whether a file or folder belongs to a room of the house, which is a package inside ``stickslip``."""
    return path.is_relative_to(ROOT) and bool(ROOMS & set(path.relative_to(ROOT).parts[:1]))


def pytest_collect_directory(path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Take the folder of a room for a plain folder, because pytest would load it a second time, by a wrong name."""
    return pytest.Dir.from_parent(parent, path=path) if is_in_room(path) else None


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, Any, Any]:
    """Lend the module of a file the name by which pytest asks for it, while its examples are collected."""
    if not is_in_room(collector.path) or collector.path.suffix != ".py":
        return (yield)
    name = ".".join(collector.path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    with suppress(ImportError):  # pytest says it better
        sys.modules[name] = import_module(f"stickslip.{name}")
    try:
        return (yield)
    finally:
        sys.modules.pop(name, None)


@pytest.fixture(autouse=True, scope="session")
def fitted_once() -> Generator[None, None, None]:
    """Keep the fit of each record for whoever imports ``fit`` while tests run; tests of the fit have it as it is."""
    from stickslip import remedy

    made, fit = {}, remedy.fit

    def content(one: Any) -> Any:
        signals = [None if x is None else x.tobytes() for x in (one.t, one.sp, one.pv, one.op)]
        known = one.process, one.measurement, str(one.op_span), str(one.log.units), str(one.log.start)
        return one.name, *known, *signals

    def once(records: Any, progress: Any = str, seed: int = 0) -> Any:
        loops = [records] if hasattr(records, "pv") else list(records)
        key = (seed, *map(content, loops))
        if key not in made:
            made[key] = fit(records, progress, seed)
        return made[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(remedy, "fit", once)
        yield
