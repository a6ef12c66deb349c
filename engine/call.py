"""Kernels: plain Python functions ``(t, x, d, u, p, out)`` compiled to one C signature and called by address.

Every kernel of every block has the same signature ``void(double, double*, double*, double*, double*,
double*)``, so the engine sees only addresses: it is compiled once, and a new block compiles nothing but itself.
The same Python function runs interpreted, with numpy arrays in place of the pointers.
"""

import re
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.ccallback import CFunc
from numba.extending import intrinsic
from stickslip.engine.callback import Callback
from stickslip.engine.frozen import frozen
from stickslip.engine.reach import Reached, raises
from stickslip.engine.stamp import locked
from stickslip.engine.watched import Watched
from stickslip.logs.compiled import ReadyCache, njit

Kernel = Callable[[float, Any, Any, Any, Any, Any], None]

_POINTER = types.CPointer(types.float64)
SIGNATURE = types.void(types.float64, _POINTER, _POINTER, _POINTER, _POINTER, _POINTER)
BACK_TO_PYTHON = "numba_gil_ensure"  # what compiled code calls first on its way back into Python
OPTIONS = {"error_model": "numpy", "forceinline": True}
_known: dict[Kernel, "_Known"] = {}
_made: dict[str, "_Compiled | str"] = {}  # by fingerprint: what was compiled, or why it cannot be


class KernelError(ValueError):
    """A kernel cannot be compiled, or could not be trusted if it were."""


def address(kernel: Kernel | None) -> int:
    """Return the address of the compiled kernel (0 for none), compiling it or loading it from the cache.

    Raises ``KernelError`` if it cannot be compiled, or if it could go back into Python when it runs (to raise an
    error, to print): the engine hears nothing of an error, and would go on with what was never written.

    A kernel with the attribute ``may_run_in_python`` is called in Python if it cannot be compiled; one with a reason
    there always is.
    """
    if kernel is None:
        return 0
    known = _known.get(kernel)
    if known is None or known.changed():
        known = _known[kernel] = _prepared(kernel)
    return int(known.made.address)


def reached_by(kernels: Iterable[Kernel]) -> Watched:
    """Return what these kernels, ready to be called, reach; where it has changed, their addresses may have, too."""
    for kernel in (kernels := [*kernels]):
        address(kernel)
    return Watched(known.reached for known in map(_known.__getitem__, kernels) if known.reached is not None)


@dataclass(frozen=True)
class _Known:
    """A kernel ready to be called, and what it reached when it was compiled."""

    made: Any  # compiled, or a callback
    reached: Reached | None = None  # None: Python evaluates it afresh, whatever it reaches

    def changed(self) -> bool:
        return self.reached is not None and self.reached.changed()


def _prepared(kernel: Kernel) -> _Known:
    optional = getattr(kernel, "may_run_in_python", False)
    if isinstance(optional, str):
        return _Known(Callback(kernel, optional))
    reached = Reached(kernel)  # type: ignore[arg-type]
    key = f"{reached.fingerprint} {optional}"
    if key not in _made:
        made = _Compiled(kernel, reached)
        _made[key] = made.or_why_not() if optional else made.loaded()
    found = _made[key]
    return _Known(Callback(kernel, found)) if isinstance(found, str) else _Known(found, reached)


class _Cache(ReadyCache):
    """Keeps compiled code under a fingerprint of all it was made from."""

    def __init__(self, kernel: Any, made_from: str) -> None:
        super().__init__(kernel)
        self.made_from = made_from

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return sig, codegen.magic_tuple(), self.made_from


class _Compiled(CFunc):
    """A compiled kernel."""

    _pyfunc: Any
    _compiler: Any
    trusted = False  # True: allocating arrays, which could fail for want of memory, is allowed

    def __init__(self, kernel: Kernel, reached: Reached) -> None:
        super().__init__(kernel, (SIGNATURE.args, SIGNATURE.return_type), {}, dict(OPTIONS))
        self.reached = reached

    def enable_caching(self) -> None:
        self._cache = _Cache(self._pyfunc, f"{self.reached.fingerprint} {self.trusted}")

    def loaded(self) -> Self:
        """Return it loaded from the cache, or compiled and kept there where that can be."""
        try:
            self.enable_caching()
        except (RuntimeError, OSError):  # defined at a prompt, or nowhere to keep the cache
            self.compile()
        else:
            self.compile_under_lock()
        return self

    def or_why_not(self) -> Self | str:
        """Return it compiled, or the reason why it cannot be."""
        if raises(self._pyfunc):
            return "it can raise an error or print, which compiled code cannot"
        self.trusted = True
        try:
            with warnings.catch_warnings(action="ignore"):
                self.loaded()
        except Exception as error:  # whatever the compiler has against it, Python can run it
            cause = error.__cause__
            return f"it cannot be compiled: {_in_short(cause if isinstance(cause, Exception) else error)}"
        return self

    def compile_under_lock(self) -> None:
        """Compile or load; processes that start together wait for the first one."""
        try:
            with locked(Path(self._cache.cache_path)):
                self.compile()
        except OSError:  # a cache that cannot be written is no reason not to run
            self._cache.disable()
            self.compile()

    def _compile_uncached(self) -> Any:
        code = self._pyfunc.__code__
        found = f"kernel '{code.co_name}' ({Path(code.co_filename).name}, line {code.co_firstlineno})"
        self._compiler.py_func = frozen(self._pyfunc, njit(inner=True, error_model=OPTIONS["error_model"]))
        try:
            made = super()._compile_uncached()  # type: ignore[misc]
        except Exception as error:  # numba's own errors, and plain ones for what it did not expect
            raise KernelError(
                f"{found} cannot be compiled: {_first_words(error)}; a kernel is made of numbers, arithmetic, math "
                "functions, conditions, loops, and helpers made of the same"
            ) from error
        made.library.finalize()
        if not self.trusted and BACK_TO_PYTHON in made.library.get_llvm_str():
            raise KernelError(
                f"{found} could raise an error or print while it runs, which compiled code cannot: take out raise, "
                "assert, print, and lists or tuples with an index that is not constant; refuse bad parameters in "
                "check(), and write NaN where there is no answer, which ends a run with status NOT_FINITE"
            )
        return made


def _first_words(error: Exception) -> str:
    """Return the line of a compiler's message that names the fault."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    found = [
        line for line in lines if not line.startswith(("Failed in", "During:", "File ", "- ", "Overload", "There "))
    ]
    return (found or lines or ["no reason given"])[0].rstrip(".:")


def any_in_python() -> bool:
    """Return whether this process has any kernel that the engine calls in Python."""
    return Callback.made > 0


def in_python(kernel: Kernel | None) -> Callback | None:
    """Return what is known of a kernel that the engine calls in Python, None for a compiled one."""
    known = _known.get(kernel) if kernel is not None else None
    return known.made if known is not None and isinstance(known.made, Callback) else None


def _in_short(error: Exception) -> str:
    """Return what a compiler has against the function that the kernel calls, without headings and addresses."""
    text = re.sub(r"\x1b\[[0-9;]*m| at 0x[0-9a-f]+|(?<=')/[^']*/(?=[^/']+')", "", str(error))
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    found = [i for i in range(1, len(lines)) if "Failed in" in lines[i - 1] and "Failed in" not in lines[i]]
    if not found:
        return lines[0][:200] if lines else type(error).__name__
    place = found[min(1, len(found) - 1)]  # the first says only that the kernel's own call failed
    return " ".join(lines[place : place + 1 + lines[place].endswith(":")])[:200]


@intrinsic
def pointer_to(typingctx, array):  # type: ignore[no-untyped-def]
    """Return the data pointer of a contiguous array; indexing it costs one load, and passing it one register."""
    sig = types.CPointer(array.dtype)(array)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return cgutils.create_struct_proxy(signature.args[0])(context, builder, value=args[0]).data

    return sig, codegen


@intrinsic
def call(typingctx, where, t, base, ox, od, ou, op, oo):  # type: ignore[no-untyped-def]
    """Call the kernel at address ``where`` with pointers ``base + offset`` (offsets in floats)."""
    sig = types.void(types.int64, types.float64, base, types.int64, types.int64, types.int64, types.int64, types.int64)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        double = ir.DoubleType()
        pointer = double.as_pointer()
        function = ir.FunctionType(ir.VoidType(), [double] + [pointer] * 5)
        target = builder.inttoptr(args[0], function.as_pointer())
        pointers = [builder.gep(args[2], [offset]) for offset in args[3:]]
        builder.call(target, [args[1], *pointers])
        return context.get_dummy_value()

    return sig, codegen
