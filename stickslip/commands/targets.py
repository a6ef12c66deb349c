"""Where results go: refused before the work begins, written whole or not at all."""

import io
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def check_targets(
    targets: Mapping[str, Path | str | None],
    formats: Mapping[str, tuple[str, ...]] | None = None,
    source: Path | None = None,
) -> None:
    """Refuse targets (option -> file) that cannot be written, before any work is done.

    ``formats`` lists the endings an option understands; ``source`` is the file that is read.  Raises
    ``ValueError`` with the option, the value, the rule and the remedy.

    >>> check_targets({"--out": "log.xls"}, {"--out": (".csv", ".parquet")})
    Traceback (most recent call last):
    ...
    ValueError: --out log.xls: '.xls' is not a format it can write; use .csv, .parquet
    """
    taken = {} if source is None else {os.path.realpath(source): "the file that is read"}
    for option, given in targets.items():
        if given is None or (option == "--json" and str(given) == "-"):
            continue
        path, endings = Path(given), (formats or {}).get(option, ())
        if endings and path.suffix.lower() not in endings:
            raise ValueError(f"{option} {path}: '{path.suffix}' is not a format it can write; use {', '.join(endings)}")
        if not str(given):
            raise ValueError(f"{option} '' names no file; name one")
        if path.is_dir():
            raise ValueError(f"{option} '{given}' is a folder; name a file")
        if str(given) == "-":
            raise ValueError(f"{option} -: only --json writes to standard output; name a file")
        if path.exists() and not path.is_file():
            if endings:  # such a file must be renamed into place, which would destroy a pipe or a device
                raise ValueError(f"{option} {path} is a device or a pipe; name an ordinary file")
            continue
        if not path.parent.is_dir():
            raise ValueError(f"{option} {path}: there is no folder '{path.parent}'; make it, or name another")
        _try_to_write(path.parent, f"{option} {path}")
        real = os.path.realpath(path)
        if real in taken:
            raise ValueError(f"{option} {path} would overwrite {taken[real]}; name another file")
        taken[real] = f"what {option} writes"


def check_folder(out: Path) -> None:
    """Refuse a folder (``--out``) that cannot be made or written to, before any work is done.

    >>> check_folder(Path(__file__))
    Traceback (most recent call last):
    ...
    ValueError: --out ...targets.py: '...targets.py' is a file; name a folder
    """
    nearest = next(path for path in (out, *out.absolute().parents) if path.exists())
    if not nearest.is_dir():
        raise ValueError(f"--out {out}: '{nearest}' is a file; name a folder")
    _try_to_write(nearest, f"--out {out}")


def _try_to_write(folder: Path, what: str) -> None:
    """Refuse a folder in which nothing can be written; permissions alone do not tell, for root or a read-only disk."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as fault:
        why = f"nothing can be written in '{folder}' ({fault.strerror})"
        raise ValueError(f"{what}: {why}; name another folder") from None


def write_whole(path: Path, content: bytes) -> None:
    """Write a file completely or not at all: to a temporary neighbour first, then renamed.

    A link keeps pointing where it did; a device or a pipe, e.g. /dev/null, is written to as it stands.  Raises
    ``ValueError`` naming ``path`` when that fails.
    """
    from stickslip.logs.files.write import replacing

    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
            return
        with replacing(path) as part:
            part.write_bytes(content)
    except OSError as fault:
        raise ValueError(f"{path} cannot be written ({fault.strerror}); choose another place") from None


def write_figure(figure: "Figure", path: Path) -> None:
    """Write a picture in the format that the ending of ``path`` says; raises ``ValueError`` as ``write_whole`` does."""
    picture = io.BytesIO()
    figure.savefig(picture, format=path.suffix[1:].lower(), dpi=150, bbox_inches="tight")
    write_whole(path, picture.getvalue())
