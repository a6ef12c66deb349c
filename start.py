"""Set up stickslip in its own virtual environment and run it; needs nothing but Python 3.11 or later.

python3 start.py              the demonstration: five short stories and one HTML page
python3 start.py demo --help  any stickslip command follows the same way
python3 start.py test         the tests, exactly as continuous integration runs them
python3 start.py docs         the documentation as a site: build/site/index.html
"""

import hashlib
import os
import shutil
import subprocess
import sys
import venv
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent
HOME = Path(os.environ.get("STICKSLIP_VENV") or ROOT / ".venv").absolute()
BIN = HOME / ("Scripts" if os.name == "nt" else "bin")

STEMS = ["tests/gap/test_bank.py", "tests/gap/test_drawn.py"]
LOOPS = ["tests/stickslip/test_check.py", "tests/remedy/test_process.py"]
CHECKS = [
    ["ruff", "check", "."],
    ["ruff", "format", "--check", "."],
    ["python", "-m", "pytest", "-q", *STEMS],
    ["mypy"],
    ["python", "-m", "pytest", "-q", *LOOPS],
    ["python", "docs/words.py"],
    ["python", "docs/build.py", "--check"],
    ["python", "-m", "benchmarks.simulate", "--quick"],
    ["python", "-m", "benchmarks.plant", "--quick"],
]  # none needs another, so two run at a time
# The tests among the checks have compiled by then what most others need, which each worker would compile for itself.
REST = [f"--ignore={file}" for file in (*STEMS, *LOOPS)]
# To rewrite asserts takes each worker longer than to collect the tests; what fails runs again and says why in full.
TESTS = ["python", "-m", "pytest", "-n", "auto", "--dist", "worksteal", "-q", "--assert=plain", *REST]
FAILED = ["python", "-m", "pytest", "-q", "--last-failed"]


def installed(extra: str) -> None:
    """Create the environment if needed and install the checkout, editable, unless that is already done.

    Raises ``ValueError`` when that fails for a reason that the lines printed before do not say.
    """
    digest = hashlib.sha256((ROOT / "pyproject.toml").read_bytes()).hexdigest()
    wanted = digest + extra
    enough = {wanted, digest + "[test]", *([] if extra else [digest + "[docs]"])}  # what has more serves for less
    stamp = HOME / "stickslip-installed"
    ours, runs = stamp.exists(), shutil.which("python", path=str(BIN)) is not None
    if ours and runs and stamp.read_text() in enough:
        return
    if HOME != ROOT / ".venv" and HOME.exists() and not ours and (HOME.is_file() or any(HOME.iterdir())):
        raise ValueError(
            f"STICKSLIP_VENV = {HOME} exists and was not made by this script, which would clear it; "
            "name a folder that is empty or not there yet"
        )
    print(f"setting up {HOME} (once, about a minute)", flush=True)
    try:
        venv.create(HOME, with_pip=True, clear=not (ours and runs))
    except subprocess.CalledProcessError:
        raise ValueError(
            f"{sys.executable} cannot make a virtual environment with pip; on Debian or Ubuntu: "
            "sudo apt install python3-venv"
        ) from None
    stamp.write_text("unfinished")
    pip = [str(BIN / "python"), "-m", "pip", "--disable-pip-version-check"]
    # most modules of what is installed are never imported; Python compiles those that are
    subprocess.run([*pip, "install", "-q", "--no-compile", "-e", f"{ROOT}{extra}"], check=True)
    stamp.write_text(wanted)


def linked() -> None:
    """Link the rooms to where mypy looks for them: it knows ``stickslip.blocks`` only by a folder of that name."""
    import tomllib

    targets = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]
    for room, place in targets["wheel"]["sources"].items():
        link = ROOT / "build" / "typed" / place
        link.parent.mkdir(parents=True, exist_ok=True)
        if not link.is_symlink():
            link.symlink_to(Path("..", "..", "..", room), target_is_directory=True)


def checked() -> int:
    """Run the checks, print what each says, and return the exit code of the first that failed."""

    def run(step: list[str]) -> subprocess.CompletedProcess[str]:
        words = [str(BIN / step[0]), *step[1:]]
        return subprocess.run(words, cwd=ROOT, check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    with ThreadPoolExecutor(2) as two:
        for step, done in zip(CHECKS, two.map(run, CHECKS), strict=True):
            print("+", *step)
            print(done.stdout or "", end="", flush=True)
            if done.returncode:
                two.shutdown(cancel_futures=True)
                return done.returncode
    return 0


def tested() -> int:
    """Run the tests, and those that fail once more, which say why in full; return the exit code of the first time."""
    code = subprocess.run([str(BIN / TESTS[0]), *TESTS[1:]], cwd=ROOT, check=False).returncode
    if code == 1:  # of pytest: some tests failed
        subprocess.run([str(BIN / FAILED[0]), *FAILED[1:]], cwd=ROOT, check=False)
    return code


def main() -> int:
    """Run one of the jobs; return its exit code."""
    if sys.version_info < (3, 11):
        print(f"Python {sys.version.split()[0]} is too old: stickslip needs 3.11 or later", file=sys.stderr)
        return 2
    arguments = sys.argv[1:] or ["demo"]
    job = arguments[0] if arguments == ["test"] or arguments[0] == "docs" else ""
    try:
        installed(f"[{job}]" if job else "")
        if job == "test":
            linked()
            os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # or each of its many processes compiles all sources anew
    except subprocess.CalledProcessError as failure:
        print(f"installing failed (exit code {failure.returncode}); the lines above say why", file=sys.stderr)
        return 2
    except (ValueError, OSError) as failure:
        print(f"Error: {failure}", file=sys.stderr)
        return 2
    if job == "docs":
        return subprocess.run([str(BIN / "python"), "docs/build.py", *arguments[1:]], cwd=ROOT, check=False).returncode
    if not job:
        return subprocess.run([str(BIN / "python"), "-m", "stickslip", *arguments], check=False).returncode
    print("the tests take about 15 minutes on two cores", flush=True)
    return checked() or tested()


if __name__ == "__main__":
    try:
        raise SystemExit(main())
    except KeyboardInterrupt:
        raise SystemExit(130) from None
