"""Entry point: checks that our packages are the ones Python finds, then hands over to the commands."""

import gc
import io
import sys

from stickslip.standard import hidden


def main() -> None:
    """Run the command line; never a traceback for a user's mistake."""
    try:
        _run()
    except Exception as error:
        why = hidden() or "install stickslip again, or report it with the command you gave"
        print(f"Error: stickslip cannot start ({type(error).__name__}: {error}); {why}", file=sys.stderr)
        raise SystemExit(2) from None


def _run() -> None:
    gc.set_threshold(100_000, 50, 50)  # imports leave a million objects and no garbage: a tenth of the start-up
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without our signs, e.g. plus-minus, shows a '?'
    from stickslip.shadow import shadowed

    trouble = shadowed()
    if trouble:
        print(trouble, file=sys.stderr)
        raise SystemExit(2)
    from stickslip.cli import cli

    cli.main(prog_name="stickslip")


if __name__ == "__main__":
    main()
