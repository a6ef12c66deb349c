"""Measure how plainly the pages are written: ``python docs/words.py``, ``--since REVISION`` to compare with before.

For every page: its words, its longest sentence, the share of sentences in the passive voice, and how often it uses
words that only this house uses in that sense.  Code, tables, headings and pictures are no prose and are left out.
``--long`` prints every sentence of more than 25 words.  ``tests/test_words.py`` holds the user's pages to the limit.
"""

import argparse
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 25  # words of a sentence
OWN = ("told", "tells", "floor", "floors", "sureness", "looked", "beside", "foretells", "feign", "nats")
IRREGULAR = (
    "built done drawn driven fed found given held hidden kept known left lost made met put read run said seen sent set "
    "shown split stuck taken thrown told understood worn written"
)
PASSIVE = re.compile(
    rf"\b(?:is|are|was|were|be|been|being)\b(?: (?:not|never|only|also|then|often|\w+ly))?"
    rf" (?:[a-z]{{2,}}ed|{'|'.join(IRREGULAR.split())})\b"
)


def sentences(page: str) -> list[str]:
    """Return the sentences of the prose of a page in Markdown.

    >>> sentences("# Head\\n\\nOne [link](a.md). Two\\nlines, e.g. this.\\n\\n| a | b |\\n\\n- Item\\n- `x.y()` runs.")
    ['One link.', 'Two lines, e.g. this.', 'Item', 'CODE runs.']
    """
    text = re.sub(r"```.*?```|<!--.*?-->|!\[.*?\]\(.*?\)", "\n\n", page, flags=re.S)
    text = re.sub(r"^(#.*|\|.*|---+)$", "\n", text, flags=re.M)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"``.*?``|`[^`]*`", "CODE", text)
    text = re.sub(r"\*+", "", text)
    text = re.sub(r"^\s*(?:[-+]|\d+\.)\s+", "\n\n", text, flags=re.M)
    found = []
    for paragraph in re.split(r"\n\s*\n", text):
        plain = " ".join(paragraph.split())
        found += [part for part in re.split(r"(?<!e\.g\.)(?<!i\.e\.)(?<=[.?!]) (?=[A-Z0-9(\"'])", plain) if part]
    return [sentence for sentence in found if re.search(r"[A-Za-z]{2}", sentence)]


def length(sentence: str) -> int:
    """Return the number of words of a sentence; a number or a piece of code is one word.

    >>> length("It is 3.5 % of CODE, at most.")
    7
    """
    return len(re.findall(r"[A-Za-z0-9][\w.,'/^-]*", sentence))


@dataclass(frozen=True)
class Plainness:
    """Of a page: ``words`` in all its sentences, words of the ``longest``, ``passive`` share [%], ``own`` words."""

    words: int
    longest: int
    passive: float
    own: int


def plainness(page: str) -> Plainness:
    """Return the figures of a page.

    >>> plainness("The valve sticks. It was repaired.")
    Plainness(words=6, longest=3, passive=50.0, own=0)
    """
    lines = sentences(page)
    lengths = [length(line) for line in lines] or [0]
    passive = sum(bool(PASSIVE.search(line)) for line in lines)
    own = sum(len(re.findall(rf"\b{word}\b", line)) for line in lines for word in OWN)
    return Plainness(sum(lengths), max(lengths), 100.0 * passive / max(len(lines), 1), own)


def pages(revision: str = "") -> dict[str, str]:
    """Return the text of each page, by its path, now or at a revision; the changelog and its history are left out.

    Raises CalledProcessError for a revision that there is not.
    """
    if revision:
        names = _git("ls-tree", "-r", "--name-only", revision).splitlines()
        texts = {name: _git("show", f"{revision}:{name}") for name in names if _is_page(name)}
    else:
        names = [str(path.relative_to(ROOT)) for path in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.*")]]
        texts = {name: (ROOT / name).read_text() for name in names if _is_page(name)}
    texts = {name: comments(text) if name.endswith(".py") else text for name, text in texts.items()}
    return dict(sorted(texts.items(), key=lambda page: (_is_evidence(page[0]), page[0])))


def comments(script: str) -> str:
    """Return the text of an example that is a script as a page in Markdown.

    >>> comments('\"\"\"\\nHead\\n====\\n\\nSee.\\n\"\"\"\\n\\n# %%\\n# On\\n# ---\\n# Do.\\n\\ndo()  # it\\n').split()
    ['#', 'Head', 'See.', '#', 'On', 'Do.']
    """
    head, _, rest = script.removeprefix('"""').partition('"""')
    lines = [line.removeprefix("#").strip() for line in rest.splitlines() if line.startswith("#")]
    text = f"{head}\n" + "\n".join("" if line == "%%" else line for line in lines)
    return re.sub(r"^(.+)\n[=-]{3,}$", r"# \1", text, flags=re.M)


def _is_page(name: str) -> bool:
    if name.startswith(("docs/tutorials/", "docs/gallery/")):
        return name.endswith(".py")
    diaries = ("CHANGELOG.md", "docs/evidence/history.md")
    return name.endswith(".md") and name not in diaries and (name.startswith("docs/") or "/" not in name)


def _is_evidence(name: str) -> bool:
    return name.startswith("docs/evidence/")


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def main() -> None:
    """Print one line a page, and the sums of the user's pages and of the evidence."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--since", metavar="REVISION", help="show each figure at this revision, too")
    options.add_argument("--long", action="store_true", help=f"print the sentences of more than {LIMIT} words")
    chosen = options.parse_args()
    now, then = pages(), pages(chosen.since) if chosen.since else {}
    print(f"{'page':36} {'words':>13} {'longest':>11} {'passive %':>11} {'own words':>11}")
    for name, text in now.items():
        earlier = then.get(name, then.get(name.replace("evidence/", "")))  # a page may have moved
        states = [plainness(page) for page in (earlier, text) if page is not None]
        rows = zip(*((s.words, s.longest, s.passive, s.own) for s in states), strict=True)
        cells = [" > ".join(f"{value:.0f}" for value in row) for row in rows]
        print(f"{name:36} {cells[0]:>13} {cells[1]:>11} {cells[2]:>11} {cells[3]:>11}")
        if chosen.long:
            print(*(f"    {length(s)}: {s}" for s in sentences(text) if length(s) > LIMIT), sep="\n")
    for evidence, title in ((False, "user's pages"), (True, "evidence")):
        sums = [
            sum(plainness(text).words for name, text in texts.items() if _is_evidence(name) == evidence)
            for texts in (then, now)
            if texts
        ]
        print(f"{title:36} {' > '.join(map(str, sums)):>13}")


if __name__ == "__main__":
    main()
