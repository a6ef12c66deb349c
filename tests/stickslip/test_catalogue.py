"""``stickslip blocks``: complete, up to date, and true to the pages of the blocks."""

import json
import re
from pathlib import Path

import pytest
from stickslip.blocks.block import Block
from stickslip.blocks.ports import BlockError

from stickslip import blocks
from stickslip.commands.blocks import BLOCKS, entries, find, markdown

ROOT = Path(__file__).resolve().parents[2]
PLANT = [e for e in entries() if e.group in ("Plant", "Valve bodies and pipes: MV to flow")] + [
    find(name) for name in ("AntiSurge", "Flare", "Slug", "Sine", "Constant")
]
WIRED = {"inflows", "outflows", "loads", "molar", "check"}  # belong to the wiring, not to the physics
LIMITS = {"low", "high", "T_t", "action"}  # of the PI behind AntiSurge and Flare


def test_every_block_is_listed_once():
    classes = [getattr(blocks, name) for name in blocks.__all__ if isinstance(getattr(blocks, name), type)]
    found = {made.__name__ for made in classes if issubclass(made, Block)} - {"Block"}
    listed = [name for names in BLOCKS.values() for name in names]
    assert sorted(listed) == sorted(found)


def test_the_page_of_all_blocks_names_each_with_the_file_that_holds_it():
    rows = dict(re.findall(r"^\| \[(\w+)\]\(\.\./(.*?)\)", markdown(), re.M))
    assert set(rows) == {entry.name for entry in entries()}
    for name, file in rows.items():
        assert f"\nclass {name}(" in (ROOT / file).read_text() or f"\n{name} = " in (ROOT / file).read_text()


def test_units_come_from_the_ports():
    entry = find("Compressor")
    assert entry.inputs == ("p_in [Pa]", "p_out [Pa]", "w [rad/s]")
    assert entry.outputs == ("m [kg/s]", "tau [N m]", "q", "q_s")
    assert entry.states == ("m",) and find("GasValveFlow").modes == ("flowing", "choked", "shut")
    assert find("Shaft").parameters["J"] == 20.0  # the default
    assert find("CheckValve").parameters["K"] is None  # must be given


@pytest.mark.parametrize("entry", entries(), ids=lambda e: e.name)
def test_short_sources_stand_on_the_page(entry):
    """Numbers and names of the short source occur in the page it shortens."""
    if entry.source != "textbook":
        for word in re.findall(r"[A-Z][a-z']+\w*|\d+(?:\.\d+)*", entry.source):
            assert word in entry.page, f"{entry.source!r} says {word}, {entry.file} does not"


@pytest.mark.parametrize("entry", PLANT, ids=lambda e: e.name)
def test_pages_of_plant_blocks_are_complete(entry):
    for word in ("Source:", "Valid", "See also"):
        assert word in entry.page
    assert "    " in entry.page, "no equation"
    for port in (*entry.inputs, *entry.outputs):
        name, _, unit = port.partition(" ")
        wired = entry.name in ("Shaft", "Plenum") or name == "out"
        assert wired or re.search(rf"\b{name}\b", entry.page), f"port {name}"
        assert unit.strip("[]") in entry.page or entry.group.startswith("Signals")
    shape = (ROOT / "blocks" / "compressor_map.py").read_text()
    for name in entry.parameters:
        if name not in WIRED | LIMITS:
            where = entry.page + entry.about + (shape if entry.name == "Compressor" else "")
            assert re.search(rf"\b{name}\b", where), f"parameter {name}"
    assert entry.example.startswith(">>>")
    assert (ROOT / "tests" / "blocks" / f"test_{Path(entry.file).stem}.py").is_file()


def test_list(call):
    result = call("blocks")
    assert result.exit_code == 0
    for name in ("GasTurbine", "Separator", "KanoValve", "boundary conditions"):
        assert name in result.stdout


def test_one_page(call):
    result = call("blocks", "gas_turbine")
    assert result.exit_code == 0
    for word in (
        "T dtau/dt",
        "tau_SP [N m]",
        "P_max = 2.2e+07",
        "free, at its rating, idle",
        "GasTurbine(T=0.2",
        ">>> ",
    ):
        assert word in result.stdout


def test_markdown_is_the_page(call):
    assert call("blocks", "--markdown").stdout == markdown()


def test_json(call):
    shown = json.loads(call("blocks", "--json", "-").stdout)["blocks"]
    assert [entry["name"] for entry in shown] == [entry.name for entry in entries()]
    [one] = json.loads(call("blocks", "PI", "--json", "-").stdout)["blocks"]
    assert one["parameters"]["T_i"] == "inf" and one["parameters"]["K_p"] is None


def test_unknown_block(call):
    result = call("blocks", "Compresor")
    assert result.exit_code == 2 and "did you mean 'Compressor'?" in result.stderr
    with pytest.raises(BlockError, match="there is no block"):
        find("valve")
