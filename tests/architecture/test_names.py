"""Names are no metaphors, files are short, no room is too large."""

import ast
import re

from tests.architecture.house import FILES, PACKAGES, offenders, parsed

OWN = {"told", "telling", "looked", "sureness", "floors"}  # words that only this house used so
PLAIN_ROOMS = (  # a room that is rewritten is added here, and stays so
    "benchmarks", "blocks", "calibration", "cases", "detect", "diagram", "engine", "gap", "logs", "plant", "remedy",
    "scan", "stickslip", "study",
)  # fmt: skip
METAPHORS = {"cast", "crew", "company", "casting", "books", "portfolio", "member", "members", "layer", "layers"}


def words_of(source: str) -> set[str]:
    """Return the words that a file's own names are made of: functions, classes, arguments, variables, fields."""
    names = set()
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names.add(node.attr)
    return {word for name in names for word in re.findall(r"[A-Z]?[a-z]+", name) for word in [word.lower()]}


def test_names_are_no_metaphors() -> None:
    assert (
        offenders(lambda path: (words_of(path.read_text()) | set(re.findall(r"[a-z]+", path.stem))) & METAPHORS) == {}
    )


def test_names_of_plain_rooms_are_words_of_the_field() -> None:
    found = offenders(lambda path: words_of(path.read_text()) & OWN)
    assert {name: words for name, words in found.items() if name.split("/")[0] in PLAIN_ROOMS} == {}


def test_the_rule_of_names_can_fail() -> None:
    assert words_of("class _Crew:\n    def cast(self, members): self.books = 1") >= {"crew", "cast", "members", "books"}


UNITS = {"s": "_S", "nats": "_NATS", "%": "_PERCENT", "share": "_SHARE"}  # first word of a comment, and what it asks
CONSTANT = re.compile(r"^_?([A-Z][A-Z0-9_]*)(?:: [^=]+)? = [-\d._]+  # (s|nats|%|share)(?![\w'-])", re.M)


def without_unit(source: str) -> list[str]:
    """Return the numbers of a file whose comment begins with a unit that their name does not end with.

    >>> without_unit("LONGEST = 3.0  # s\\nLEAST_NATS = 10.0  # nats to accuse\\nPART = 0.5  # share of the record\\n")
    ['LONGEST', 'PART']
    """
    return [name for name, unit in CONSTANT.findall(source) if not name.endswith(UNITS[unit])]


def test_numbers_are_named_with_their_unit() -> None:
    rooms = ("detect/", "logs/", "scan/")
    found = offenders(lambda path: without_unit(path.read_text()))
    assert {name: constants for name, constants in found.items() if name.startswith(rooms)} == {}


def test_files_are_short() -> None:
    lengths = sorted(len(path.read_text().splitlines()) for _, path in FILES)
    assert lengths[-1] <= 360 and lengths[len(lengths) * 9 // 10] < 300


def test_no_room_is_above_a_quarter_of_the_house():
    lines = dict.fromkeys(PACKAGES, 0)
    for room, path in FILES:
        assert room is not None
        lines[room.split("/")[0]] += len(path.read_text().splitlines())
    largest = max(lines, key=lambda room: lines[room])
    assert lines[largest] <= 0.25 * sum(lines.values()), (largest, lines)
