"""Entry point: checks that our packages are the ones Python finds, then hands over to the commands."""

import gc
import io
import sys

from stickslip.shadow import shadowed


def main() -> None:
    """Run the command line; never a traceback for a user's mistake."""
    gc.set_threshold(100_000, 50, 50)  # imports leave a million objects and no garbage: a tenth of the start-up
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without our signs, e.g. plus-minus, shows a '?'
    trouble = shadowed()
    if trouble:
        print(trouble, file=sys.stderr)
        raise SystemExit(2)
    from stickslip.cli import cli

    cli.main(prog_name="stickslip")


if __name__ == "__main__":
    main()
