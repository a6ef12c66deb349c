"""The site of the documentation: where each page lies on it, which links it has, how docstrings are read."""

import contextlib
import doctest
import importlib.util
import io
import sys
from pathlib import Path
from types import ModuleType

import pytest
from stickslip.detect import METHODS
from stickslip.gap.effects import CATALOGUE
from stickslip.remedy.measures import REMEDIES

from stickslip.commands.blocks import entries

DOCS = Path(__file__).resolve().parents[1] / "docs"


@pytest.fixture
def loaded(monkeypatch: pytest.MonkeyPatch):
    """A script of ``docs`` as a module."""
    monkeypatch.setattr(sys, "path", [*sys.path, str(DOCS)])

    def load(name: str) -> ModuleType:
        spec = importlib.util.spec_from_file_location(f"docs_{name}", DOCS / f"{name}.py")
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, f"docs_{name}", module)
        spec.loader.exec_module(module)
        return module

    return load


def script(gallery: str, name: str, text: str) -> str:
    """The kind of object that the last line of a card gives, once the card has run."""
    *lines, last = text.rstrip().split("\n")
    names: dict[str, object] = {}
    exec(compile("\n".join(lines), f"{gallery}/{name}", "exec"), names)
    return str(type(eval(last, names)).__name__)


def test_every_block_effect_method_and_remedy_has_a_card_that_draws_a_picture(loaded) -> None:
    cards = [card for card in loaded("cards").cards() if card[1].endswith(".py")]
    names = {f"{gallery}/{name}" for gallery, name, _ in cards}
    assert names == {
        *(f"blocks/{entry.name}.py" for entry in entries()),
        *(f"effects/{one.name}.py" for one in CATALOGUE),
        *(f"detectors/{method.CARD.name}.py" for method in METHODS),
        "remedies/remedies.py",
    }
    with contextlib.redirect_stdout(io.StringIO()):
        assert {
            name: kind
            for gallery, name, text in cards
            if (kind := script(gallery, name, text)) not in ("Figure", "Picture")
        } == {}
    assert all(f'against_nothing("{remedy.TITLE}")' in cards[-1][2] for remedy in REMEDIES)


@pytest.mark.parametrize("name", ["build", "docstrings"])
def test_the_examples_of_the_scripts_run(loaded, name: str) -> None:
    failed, tried = doctest.testmod(loaded(name))
    assert tried and not failed


def test_links_lead_to_where_pages_lie_on_the_site(loaded) -> None:
    build = loaded("build")
    page = DOCS / "evidence" / "tried.md"
    text = (
        "[a](../gap.md#ask) [b](../../CONTRIBUTING.md) [c](../../blocks/pi.py) [s](../../start.py) [d](https://x.org)"
    )
    assert build.linked(page, text) == (
        "[a](../gap.md#ask) [b](../project/contributing.md) [c](../blocks.md) s [d](https://x.org)"
    )


def test_what_a_page_loads_from_elsewhere_is_found_and_a_link_is_not(loaded, tmp_path: Path) -> None:
    (tmp_path / "fine.html").write_text('<a href="https://x.org">x</a> <script src="_static/a.js"></script>')
    assert loaded("build").from_elsewhere(tmp_path) == []
    (tmp_path / "page.html").write_text('<script src="https://x.org/a.js"></script>')
    (tmp_path / "site.css").write_text("@import url('https://x.org/a.css')")
    found = loaded("build").from_elsewhere(tmp_path)
    assert [line.split()[0] for line in found] == ["page.html", "site.css"]


def test_every_page_has_its_place_in_the_contents(loaded) -> None:
    build = loaded("build")
    listed = build.contents(DOCS / "README.md").split()
    places = {str(build.placed(page).with_suffix("")) for page in build.pages()} - {"index"}
    assert places <= set(listed)
    assert listed.count("project/changelog") == 1


def test_what_is_aligned_in_a_docstring_stays_so(loaded) -> None:
    as_rst = loaded("docstrings").as_rst
    columns = ["in   SP  set point", "T_i  time [s]"]
    assert as_rst(columns) == [".. code-block:: none", "", *(f"    {line}" for line in columns), ""]
    assert as_rst(["name : str", "    What *it* is."]) == ["name : str", "    What \\*it\\* is.", ""]
