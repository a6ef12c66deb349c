"""Cases, models and detectors of the user's own, named on the command line as FILE.py:FUNCTION.

The file is executed, with all rights of the user: the commands that take one say so in their help.
"""

import ast
import contextlib
import importlib.util
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.cases import Case
    from stickslip.detect import Method
    from stickslip.detect.card import Card
    from stickslip.detect.prepare.prepared import Prepared
    from stickslip.detect.verdict import Verdict
    from stickslip.diagram.diagram import Diagram
    from stickslip.logs import LoopRecord

DURATION, EVERY = 600.0, 1.0  # s, of a case that is a diagram alone
EXECUTED = "FILE.py:FUNCTION: that file IS EXECUTED"


def is_own(given: str) -> bool:
    """Whether a name on the command line means a function in a file.

    >>> is_own("my_loop.py:loop"), is_own("ideal_high"), is_own("my_loop.py")
    (True, False, True)
    """
    path, colon, _ = given.rpartition(":")
    return (path if colon else given).endswith(".py")


def function_of(given: str, option: str) -> Callable[..., Any]:
    """Execute the file of ``FILE.py:FUNCTION`` and return its function.

    Raises ``ValueError`` that says what is wrong: no such file, a file that fails, no such function.
    """
    path, colon, function = given.rpartition(":")
    if not colon:
        raise ValueError(f"{option} {given}: which function of the file? {_functions(given)}")
    file = Path(path)
    if not file.is_file():
        raise ValueError(f"{option} {given}: there is no file '{path}'; give FILE.py:FUNCTION")
    spec = importlib.util.spec_from_file_location(f"own_{file.stem}", file)
    if spec is None or spec.loader is None:
        raise ValueError(f"{option} {given}: '{path}' cannot be loaded as Python; give FILE.py:FUNCTION")
    module = importlib.util.module_from_spec(spec)
    sys.modules[module.__name__] = module  # blocks defined there are looked up by their module
    with contextlib.suppress(ImportError):  # on a cluster, whose machines do not have the file, it is sent along
        import cloudpickle

        cloudpickle.register_pickle_by_value(module)
    folder = str(file.resolve().parent)
    if folder not in sys.path:  # its neighbours are found, and as the last they hide nothing of Python's or ours
        sys.path.append(folder)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as fault:
        why = f"{type(fault).__name__}: {fault}"
        raise ValueError(f"{option} {given}: '{path}' cannot be executed ({why}); mend the file") from fault
    made = getattr(module, function, None)
    if not callable(made):
        from stickslip.logs.hint import nearest

        known = [name for name, value in vars(module).items() if callable(value) and not name.startswith("_")]
        raise ValueError(f"{option} {given}: '{path}' has no function '{function}'; {nearest(function, known)}")
    return made  # type: ignore[no-any-return]  # callable(made) has been asked


def _functions(path: str) -> str:
    """Say which functions a file has; it is read and not executed."""
    try:
        statements = ast.parse(Path(path).read_bytes()).body
    except OSError:
        return f"there is no file '{path}'; give FILE.py:FUNCTION"
    except (SyntaxError, ValueError) as fault:
        return f"'{path}' is no Python ({fault}); mend the file"
    names = [one.name for one in statements if isinstance(one, ast.FunctionDef) and not one.name.startswith("_")]
    if not names:
        return f"'{path}' defines none; write one that returns stickslip.diagram.wire([...])"
    return f"give {' or '.join(f'{path}:{name}' for name in names)}"


def _called(given: str, option: str) -> Any:
    from stickslip.diagram import Diagram

    made = function_of(given, option)
    if isinstance(made, Diagram):  # python-control calls a system with its inputs; this one is there already
        return made
    try:
        return made()
    except Exception as fault:
        why = f"{type(fault).__name__}: {fault}"
        raise ValueError(f"{option} {given}: the function failed ({why}); it is called without arguments") from fault


def diagram_named(given: str, option: str) -> "Diagram":
    """Return the diagram of a case, or what ``FILE.py:FUNCTION`` returns; a diagram in the file has a name as well.

    Raises ``ValueError`` if there is no such case, or the function does not give a wired diagram or a case.
    """
    return case_named(given, option).build()


def case_named(given: str, option: str = "CASE") -> "Case":
    """Return a case by name, or the one that ``FILE.py:FUNCTION`` makes: a ``Case``, or a diagram with usual times.

    A diagram that the file has under that name is taken as it is.

    Raises ``ValueError`` if there is no such case, or the function gives neither.
    """
    from stickslip.cases import Case, find

    if not is_own(given):
        return find(given)
    from stickslip.diagram import Diagram

    made = _called(given, option)
    if isinstance(made, Case):
        return made
    if not isinstance(made, Diagram):
        raise ValueError(
            f"{option} {given}: the function returned {type(made).__name__}; "
            "return stickslip.diagram.wire([...]) or a stickslip.cases.Case"
        )
    about = (
        f"Made by {given}, which was executed: {DURATION:g} s with a row every {EVERY:g} s unless you say otherwise."
    )
    name = given.rpartition(":")[2]
    return Case(name, f"{made.name or name}, a case of your own", about, lambda: made, DURATION, EVERY, lambda: ())


@dataclass
class OwnMethod:
    """A detector of the user's own that is a function alone; it is shown."""

    CARD: "Card"
    function: "Callable[[LoopRecord | Prepared], Verdict]"

    def detect(self, record: "LoopRecord | Prepared") -> "Verdict":
        """Return what the function says of a record; raise ``ValueError`` where it fails."""
        from stickslip.detect.verdict import Verdict

        try:
            found = self.function(record)
        except Exception as fault:
            why = f"{type(fault).__name__}: {fault}"
            raise ValueError(f"--method {self.CARD.name} failed on a record ({why}); mend the function") from fault
        if not isinstance(found, Verdict):
            raise ValueError(
                f"--method {self.CARD.name} gave {type(found).__name__}; return a stickslip.detect.Verdict"
            )
        return found


def method_named(given: str) -> "Method":
    """Return a detector by name, or the function of ``FILE.py:FUNCTION`` as one.

    The ``CARD`` of the file is its card, if it has one. Raises ``ValueError`` if there is no such method.
    """
    from stickslip.detect import METHODS
    from stickslip.detect.card import Card
    from stickslip.logs.hint import nearest

    if not is_own(given):
        known = {method.CARD.name: method for method in METHODS}
        if given not in known:
            raise ValueError(
                f"--method {given}: there is no method '{given}'; {nearest(given, known)}; or give FILE.py:FUNCTION"
            )
        return known[given]
    function = function_of(given, "--method")
    card = getattr(sys.modules[function.__module__], "CARD", None)
    if not isinstance(card, Card):
        card = plain_card(given.rpartition(":")[2], given)
    return OwnMethod(card, function)


def plain_card(name: str, source: str) -> "Card":
    """Return the card of a method that has none: it is on trial."""
    from stickslip.detect.card import Card

    return Card(
        name=name, title=name, source=source, signals=("PV", "OP"), assumes=(), finds="what its author says",
        index=(-math.inf, math.inf), process=("self_regulating", "integrating"), streams="no", experimental=True,
    )  # fmt: skip
