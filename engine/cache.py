"""Compile the engine once per machine."""

from pathlib import Path

from stickslip.engine.advance import advance
from stickslip.engine.entry import ADVANCE, ADVANCE_TO, advance_to
from stickslip.engine.notice import noticed
from stickslip.engine.stamp import fresh

_address = 0


def engine() -> int:
    """Return the engine's address, loaded or compiled once per process; processes wait for the first one."""
    global _address
    if _address:
        return _address
    try:
        with fresh(Path(advance.stats.cache_path), Path(__file__).parent), noticed():
            _compile()
    except OSError:  # a cache that cannot be written is no reason not to run
        with noticed():
            _compile()
    made = advance.overloads[ADVANCE.args]
    _address = int(made.library.get_pointer_to_function(made.fndesc.llvm_func_name))
    return _address


def _compile() -> None:
    advance.compile(ADVANCE.args)
    advance_to.compile(ADVANCE_TO.args)
