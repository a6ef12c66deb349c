"""Docstrings of the house as reStructuredText: what is aligned stays aligned, and no symbol is taken for markup."""

import re
from collections.abc import Sequence

ALIGNED = re.compile(r"\S {3,}\S|^ ", re.M)  # columns, equations, drawings
ITEMS = re.compile(r"(?:- |\d+\. ).*(?:\n(?:- |\d+\. | {2,3}\S).*)*\Z")
TERMS = re.compile(r"(?:\S.* : .*(?:\n    .*)+\n?)+\Z")  # name : type, and an indented description
CODE = re.compile(r"(``.+?``|`[^`]+`)", re.S)
MARKUP = re.compile(r"[*|\\]|(?<=\w)_(?!\w)")


def as_rst(lines: Sequence[str]) -> list[str]:
    """Return the lines of a docstring for Sphinx: examples and lists as they are, all else that is aligned verbatim.

    >>> as_rst(["A `gain` K_ * u::", "", "    y = K_ *u", "", ">>> 1 + 1", "2"])
    ['A ``gain`` K\\\\_ \\\\* u:', '', '.. code-block:: none', '', '        y = K_ *u', '', '>>> 1 + 1', '2', '']
    """
    made: list[str] = []
    for text in re.split(r"\n\s*\n", "\n".join(lines).strip("\n").expandtabs(8)):
        if text.lstrip().startswith(">>>"):
            made += text.split("\n")
        elif ALIGNED.search(text) and not ITEMS.match(text) and not TERMS.match(text):
            made += [".. code-block:: none", "", *(f"    {row}" for row in text.split("\n"))]
        else:
            made += _escaped(text).split("\n")
        made.append("")
    return made


def _escaped(text: str) -> str:
    parts = CODE.split(re.sub(r"::$", ":", text))
    words = [MARKUP.sub(r"\\\g<0>", part) for part in parts[::2]]
    codes = [f"``{part.strip('`')}``" for part in parts[1::2]]
    return "".join(word + code for word, code in zip(words, [*codes, ""], strict=True))
