"""Build the documentation site: ``python docs/build.py`` writes ``build/site``, which opens from a folder, offline.

``--quick`` draws no gallery and runs no tutorial.  ``--check`` does that too, and fails on any warning: a broken link,
a page without a place, a docstring that cannot be read.

Pages lie in ``docs`` and in the root of the repository.  ``docs/README.md`` is the first page, and its headings and
links are the table of contents.  The reference is made of the package itself.
"""

import argparse
import inspect
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
from cards import cards
from stickslip.gap.page import page as effects_page

from stickslip.commands.blocks import markdown
from stickslip.commands.cli import cli

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGES = ROOT / "build" / "pages"  # as Sphinx reads them
SITE = ROOT / "build" / "site"
LINK = re.compile(r"(?P<text>!?\[[^\]]*\])\((?!https?:|#)(?P<to>[^)#\s]+)(?P<anchor>#[^)]*)?\)")
MADE = (  # pages of the reference that are made of the package
    "blocks", "blocks/index", "effects", "effects/index", "detectors/index", "remedies/remedies", "reference/commands",
    "reference/python",
)  # fmt: skip
CARDS = {  # room -> the page about all of it
    "blocks": "blocks.md", "gap/effects": "effects.md", "detect/methods": "detectors/index.rst",
    "remedy/measures": "remedies/remedies.rst",
}  # fmt: skip
COPIED = ("", ".png", ".csv")  # files that pages show or link to; a folder has no suffix
ROOMS = (
    "",
    "logs",
    "blocks",
    "diagram",
    "diagram.linear",
    "plant",
    "study",
    "detect",
    "gap",
    "remedy",
    "scan",
    "cases",
)


def main() -> int:
    """Prepare the pages, run Sphinx on them, return its exit code."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--quick", action="store_true", help="run no example, draw no gallery")
    options.add_argument("--check", action="store_true", help="as --quick, and fail on any warning")
    chosen = options.parse_args()
    shutil.rmtree(PAGES, ignore_errors=True)
    prepare(PAGES)
    target = SITE.with_name("site-check") if chosen.check else SITE
    shutil.rmtree(target, ignore_errors=True)
    words = [sys.executable, "-m", "sphinx", "-q", "-j", "auto", "-c", str(DOCS), str(PAGES), str(target)]
    words += ["-D", "plot_gallery=0"] if chosen.quick or chosen.check else []
    words += ["-b", "dummy", "-W", "--keep-going"] if chosen.check else []  # read all, write nothing
    code = subprocess.run(words, env={**os.environ, "STICKSLIP_PAGES": str(PAGES)}, check=False).returncode
    if code or chosen.check:
        return code
    for found in from_elsewhere(target):
        print(f"{found}: the site must open without a network", file=sys.stderr)
        code = 1
    print(f"open {target / 'index.html'}")
    return code


def from_elsewhere(site: Path) -> list[str]:
    """Return the pages and styles that load something from another place, with what they load."""
    loads = re.compile(
        r"""<(?:script|img|iframe)[^>]*\ssrc="https?:[^"]*|<link[^>]*\shref="https?:[^"]*|url\(["']?https?:"""
    )
    files = [file for kind in ("*.html", "*.css") for file in sorted(site.rglob(kind))]
    return [f"{file.relative_to(site)} {found}" for file in files for found in loads.findall(file.read_text())]


def prepare(folder: Path) -> None:
    """Write all pages into a folder."""
    shutil.copytree(DOCS, folder, ignore=lambda _, names: [n for n in names if Path(n).suffix not in COPIED])
    for page in pages():
        put(folder / (placed(page) or page.name), linked(page, page.read_text()))
    index = folder / "index.md"
    index.write_text(index.read_text() + contents(DOCS / "README.md"))
    for name, text in reference():
        put(folder / name, text)
    for header in DOCS.glob("*/GALLERY_HEADER.rst"):
        shutil.copytree(header.parent, folder / "scripts" / header.parent.name)
    for gallery, name, text in cards():
        put(folder / "scripts" / gallery / name, text)


def put(place: Path, text: str) -> None:
    """Write a file, and its folder if need be."""
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(text)


def pages() -> list[Path]:
    """Return the pages written by hand."""
    return [*DOCS.rglob("*.md"), *(page for page in ROOT.glob("*.md") if page.name != "README.md")]


def placed(file: Path) -> Path | None:
    """Return where a file of the repository lies on the site, None for one that is not on it.

    >>> [str(placed(ROOT / name)) for name in ("docs/README.md", "SECURITY.md", "docs/tutorials/a.py", "start.py")]
    ['index.md', 'project/security.md', 'tutorials/a.rst', 'None']
    >>> [str(placed(ROOT / name)) for name in ("gap/effects", "gap/effects/slug.py")]
    ['effects.md', 'effects/slug.rst']
    """
    name, room = file.relative_to(ROOT).as_posix(), file.parent.relative_to(ROOT).as_posix()
    if name in ("README.md", "docs/README.md"):
        return Path("index.md")
    if name in CARDS or room == "blocks":
        return Path(CARDS.get(name) or CARDS[room])
    if room in CARDS and room != "blocks":
        return Path(CARDS[room].removesuffix(".md").removesuffix("/index.rst"), file.stem).with_suffix(".rst")
    if room in ("docs/tutorials", "docs/gallery"):
        return file.relative_to(DOCS).with_suffix(".rst")
    if room == "docs" and not file.suffix:
        return Path(file.name, "index.rst")
    if file.is_relative_to(DOCS):
        return file.relative_to(DOCS)
    return Path("project", file.name.lower()) if file.suffix == ".md" else None


def linked(page: Path, text: str) -> str:
    """Return a page with its links as they are on the site; a link to a file that is not there becomes its text."""
    here = placed(page)
    assert here is not None

    def put(link: re.Match[str]) -> str:
        there = placed((page.parent / link["to"]).resolve())
        if there is None:
            return link["text"].strip("[]")
        return f"{link['text']}({os.path.relpath(there, here.parent)}{link['anchor'] or ''})"

    return LINK.sub(put, text)


def contents(index: Path) -> str:
    """Return the table of contents: a tree for each heading of the index with the pages that it links to."""
    trees = []
    for section in re.split(r"^## ", index.read_text(), flags=re.M)[1:]:
        title, _, body = section.partition("\n")
        places = [placed((index.parent / link["to"]).resolve()) for link in LINK.finditer(body)]
        found = dict.fromkeys(str(place.with_suffix("")) for place in places if place is not None)
        found |= dict.fromkeys(MADE if title == "Reference" else [])
        if found:
            trees.append("\n".join(["```{toctree}", ":hidden:", f":caption: {title}", "", *found, "```\n"]))
    return "\n" + "\n".join(trees)


def reference() -> Iterator[tuple[str, str]]:
    """Yield the pages that are made of the package: the commands and what each room gives."""
    blocks = re.sub(r"\[(\w+)\]\(\.\./blocks/\w+\.py\)", r"[\1](blocks/\1.rst)", markdown())
    yield "blocks.md", blocks
    yield "effects.md", linked(DOCS / "effects.md", effects_page())
    yield "reference/commands.md", commands()
    yield "reference/python.md", "\n".join(
        ["# Python", "", *(f"- {{doc}}`python/{room or 'front'}`" for room in ROOMS), "", "```{toctree}", ":hidden:",
         "", *(f"python/{room or 'front'}" for room in ROOMS), "```"]
    )  # fmt: skip
    for room in ROOMS:
        name = f"stickslip.{room}".rstrip(".")
        options = "   :no-members:\n" if not room else ""
        yield (
            f"reference/python/{room or 'front'}.rst",
            f"{name}\n{'=' * len(name)}\n\n.. automodule:: {name}\n{options}",
        )


def commands() -> str:
    """Return the page of all commands: what ``--help`` prints."""

    made = ["# Commands", ""]
    context = click.Context(cli, info_name="stickslip", max_content_width=110, terminal_width=110)
    for name in cli.list_commands(context):
        command = cli.get_command(context, name)
        assert command is not None
        text = command.get_help(click.Context(command, parent=context, info_name=name, terminal_width=110))
        made += [f"## {name}", "", command.get_short_help_str(300), "", "```text", inspect.cleandoc(text), "```", ""]
    return "\n".join(made)


if __name__ == "__main__":
    raise SystemExit(main())
