"""Prepare a release: ``python .ci/release.py 0.2.0`` writes the version and the date, builds the wheel and tries it.

``python .ci/release.py --check`` changes nothing: it builds and tries the wheel of the version that is written.

1. The page of the version, ``docs/releases/VERSION.md``, must be there: what is new, in the words of a user.
2. The version goes into every file of ``PLACES``; the entries of ``CHANGELOG.md``
   that are unreleased come under the version and the date.
3. The wheel and the source archive are built into ``dist``.
4. On each Python from 3.11 on that is found, the wheel goes into an empty environment.  There a loop is
   judged, a diagram simulated, and one name alone is in site-packages.

What is left for a person is printed: look, commit, tag, push.
"""

import argparse
import datetime
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACES = {  # file -> what stands before the version
    "pyproject.toml": 'version = "',
    "stickslip/__init__.py": '__version__ = "',
    "CITATION.cff": "version: ",
    ".ci/conda/meta.yaml": '  version: "',
}
NEWEST = 14  # of Python 3
TRIAL = """
import stickslip as ss
from stickslip.cases import find
from stickslip.cases.stories import EXPORTS
assert ss.diagnose(ss.read_loop(EXPORTS / "FIC101_pi_export.csv")).verdict == "stiction"
assert ss.simulate(find("ideal_high").build(), 600.0, every=0.1).ok
print(ss.__version__, ss.__file__)
"""


def main() -> int:
    """Prepare the release, or check the one that is written; return an exit code."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("version", nargs="?", help="of the release, such as 0.2.0")
    options.add_argument("--check", action="store_true", help="build and try the version that is written")
    chosen = options.parse_args()
    if bool(chosen.version) == chosen.check:
        options.error("give a version, or --check")
    try:
        if chosen.version:
            write(chosen.version, datetime.date.today())
        version = written()
        wheel = built(version)
        failed = [python for python in pythons() if not works(python, wheel)]
    except ValueError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    if failed:
        return 1
    print(f"look at `git diff`; then: git commit -am 'Version {version}' && git tag v{version} && git push --tags")
    return 0


def write(version: str, day: datetime.date) -> None:
    """Write the version wherever it stands, and the day.

    Raises ValueError for a word that is no version, one without a page of its own, and one that is written already.
    """
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise ValueError(f"'{version}' is no version; give three numbers, such as 0.2.0")
    page = ROOT / "docs" / "releases" / f"{version}.md"
    if not page.is_file():
        raise ValueError(f"{page.relative_to(ROOT)} is missing; say there what is new, in the words of a user")
    log = ROOT / "CHANGELOG.md"
    text = log.read_text()
    if f"\n## {version}," in text:
        raise ValueError(f"CHANGELOG.md has {version} already; give the next version, or --check")
    log.write_text(text.replace("## Unreleased\n", f"## Unreleased\n\n## {version}, {day}\n", 1))
    for name, before in PLACES.items():
        file = ROOT / name
        file.write_text(re.sub(rf"^({re.escape(before)})[\d.]+", rf"\g<1>{version}", file.read_text(), flags=re.M))
    citation = ROOT / "CITATION.cff"
    dated = re.sub(r"^date-released: .*\n", "", citation.read_text(), flags=re.M)
    citation.write_text(re.sub(r"^(version: .*\n)", rf"\g<1>date-released: {day}\n", dated, flags=re.M))


def written() -> str:
    """Return the version that is written; raise ValueError where two files differ."""
    found = {}
    for name, before in PLACES.items():
        match = re.search(rf"^{re.escape(before)}([\d.]+)", (ROOT / name).read_text(), re.M)
        found[name] = match[1] if match else "none"
    if len(set(found.values())) > 1:
        raise ValueError(f"the versions differ: {found}")
    return found["pyproject.toml"]


def built(version: str) -> Path:
    """Build the wheel and the source archive into ``dist``; return the wheel."""
    target = ROOT / "dist"
    shutil.rmtree(target, ignore_errors=True)
    with tempfile.TemporaryDirectory() as folder:
        python = environment(Path(sys.executable), Path(folder), "hatchling>=1.27")
        subprocess.run([python, "-m", "hatchling", "build", "-d", str(target)], cwd=ROOT, check=True)
    return target / f"stickslip-{version}-py3-none-any.whl"


def pythons() -> Iterator[Path]:
    """Yield each Python from 3.11 on, one a minor version: on the path, and those of pyenv."""
    homes = sorted((Path.home() / ".pyenv" / "versions").glob("3.*"))
    for minor in range(11, NEWEST + 1):
        name = f"python3.{minor}"
        places = [str(home / "bin" / name) for home in homes]
        found = next((Path(place) for place in (shutil.which(name), *places) if place and runs(place)), None)
        print(f"Python 3.{minor}: {found or 'not found, NOT TRIED'}", flush=True)
        if found:
            yield found


def runs(place: str) -> bool:
    """Return whether there is a Python that starts; pyenv's own command starts none that was not chosen."""
    if not Path(place).exists():
        return False
    return subprocess.run([place, "-c", ""], capture_output=True, check=False).returncode == 0


def environment(python: Path, folder: Path, *packages: str) -> str:
    """Make an empty environment with these packages; return its Python."""
    subprocess.run([python, "-m", "venv", str(folder / "env")], check=True)
    inside = str(folder / "env" / "bin" / "python")
    subprocess.run([inside, "-m", "pip", "--disable-pip-version-check", "install", "-q", *packages], check=True)
    return inside


def works(python: Path, wheel: Path) -> bool:
    """Return whether the wheel does its work in an empty environment of this Python, and say so."""
    with tempfile.TemporaryDirectory() as folder:
        inside = environment(python, Path(folder), str(wheel))
        done = subprocess.run([inside, "-c", TRIAL], cwd=folder, capture_output=True, text=True, check=False)
        files = subprocess.run(
            [inside, "-m", "pip", "--disable-pip-version-check", "show", "-f", "stickslip"],
            capture_output=True, text=True, check=True,
        ).stdout  # fmt: skip
        names = set(re.findall(r"^  ([^./]+)/", files, re.M)) - {""}
        command = subprocess.run(
            [str(Path(inside).with_name("stickslip")), "--version"], capture_output=True, check=False
        )
        fine = done.returncode == 0 and names == {"stickslip"} and command.returncode == 0
        print("  works" if fine else f"  FAILS: {done.stderr[-2000:]} {names or ''}", flush=True)
    return fine


if __name__ == "__main__":
    raise SystemExit(main())
