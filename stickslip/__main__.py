"""Entry point: sees to it that no file of the user's is taken for one of Python's, then hands over to the commands."""

import gc
import io
import os
import sys

# Read when numpy is first imported.  Our matrices are small: a second thread takes as much time again to do nothing.
LINEAR_ALGEBRA = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def main() -> None:
    """Run the command line; never a traceback for a user's mistake."""
    try:
        _run()
    except Exception as error:
        why = "install stickslip again, or report it with the command you gave"
        print(f"Error: stickslip cannot start ({type(error).__name__}: {error}); {why}", file=sys.stderr)
        raise SystemExit(2) from None


def _run() -> None:
    for name in LINEAR_ALGEBRA:
        os.environ.setdefault(name, "1")
    os.environ["PYTHONSAFEPATH"] = "1"  # the processes that we start do not look into the present folder first
    gc.set_threshold(100_000, 50, 50)  # imports leave a million objects and no garbage: a tenth of the start-up
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without our signs, e.g. plus-minus, shows a '?'
    from stickslip.commands.cli import cli

    cli.main(prog_name="stickslip")


if __name__ == "__main__":
    if sys.path and sys.path[0] in ("", os.getcwd()):
        sys.path.append(sys.path.pop(0))  # ``python -m`` puts the present folder first, where a random.py may lie
    main()
