"""Set up stickslip in its own virtual environment and run it; needs nothing but Python 3.11 or later.

python3 start.py              the demonstration: five short stories and one HTML page
python3 start.py demo --help  any stickslip command follows the same way
python3 start.py test         the tests, exactly as continuous integration runs them
"""

import hashlib
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
HOME = Path(os.environ.get("STICKSLIP_VENV") or ROOT / ".venv").absolute()
BIN = HOME / ("Scripts" if os.name == "nt" else "bin")

TEST_STEPS = [
    ["ruff", "check", "."],
    ["ruff", "format", "--check", "."],
    ["mypy"],
    ["python", "docs/words.py"],
    ["python", "-m", "benchmarks.simulate", "--quick"],
    ["python", "-m", "benchmarks.plant", "--quick"],
    ["python", "-m", "pytest", "-n", "auto", "--dist", "worksteal", "-q"],
]


def installed(extra: str) -> None:
    """Create the environment if needed and install the checkout, editable, unless that is already done.

    Raises ``ValueError`` when that fails for a reason that the lines printed before do not say.
    """
    wanted = hashlib.sha256((ROOT / "pyproject.toml").read_bytes()).hexdigest() + extra
    stamp = HOME / "stickslip-installed"
    ours, runs = stamp.exists(), shutil.which("python", path=str(BIN)) is not None
    if ours and runs and stamp.read_text() in (wanted, wanted.removesuffix(extra) + "[test]"):
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
    pip = [str(BIN / "python"), "-m", "pip", "--disable-pip-version-check", "install", "-q", "-e", f"{ROOT}{extra}"]
    subprocess.run(pip, check=True)
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


def main() -> int:
    """Run one of the two jobs; return its exit code."""
    if sys.version_info < (3, 11):
        print(f"Python {sys.version.split()[0]} is too old: stickslip needs 3.11 or later", file=sys.stderr)
        return 2
    arguments = sys.argv[1:] or ["demo"]
    try:
        installed("[test]" if arguments == ["test"] else "")
        if arguments == ["test"]:
            linked()
    except subprocess.CalledProcessError as failure:
        print(f"installing failed (exit code {failure.returncode}); the lines above say why", file=sys.stderr)
        return 2
    except (ValueError, OSError) as failure:
        print(f"Error: {failure}", file=sys.stderr)
        return 2
    if arguments != ["test"]:
        return subprocess.run([str(BIN / "python"), "-m", "stickslip", *arguments], check=False).returncode
    print("the tests take about eight minutes on two cores", flush=True)
    for step in TEST_STEPS:
        print("+", *step, flush=True)
        code = subprocess.run([str(BIN / step[0]), *step[1:]], cwd=ROOT, check=False).returncode
        if code:
            return code
    return 0


if __name__ == "__main__":
    try:
        raise SystemExit(main())
    except KeyboardInterrupt:
        raise SystemExit(130) from None
