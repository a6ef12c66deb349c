"""Try the kernels of a block in plain Python before compiled code runs them, and refuse what it could not survive.

Compiled code does not look where it writes: one place too far is somebody else's number.  Here every array is exactly
as long as it will be, what is not written yet may not be read, and what is not theirs kernels may not change.
Inputs, modes, events and a sequence of samples are tried, some of them absurd; what none of them shows stays.
"""

import contextlib
import dis
import io
import math
import sys
from collections.abc import Iterator
from functools import cache
from types import CodeType, FrameType, FunctionType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.affine import not_affine
from stickslip.blocks.ports import BlockError

if TYPE_CHECKING:
    from stickslip.blocks.block import Block, Kernel

Floats = NDArray[np.float64]
INPUTS = (0.0, 1.0, -1.0, 0.3, 1e6, -1e6, math.nan)  # of all ports; and then all different
SAMPLES = 40  # one after the other
MOST_STEPS = 500_000  # of the interpreter in one call
ARGUMENTS = ("x", "d", "u", "p", "out")
CHANGES = {"jump": ("x", "d"), "step": ("d", "out")}  # what a kernel may change; the others only out
_passed: set[object] = set()


class Mistake(Exception):
    """A kernel did something that it may not do."""


class Guarded:
    """An array of exactly its length that knows what was written and read."""

    def __init__(self, name: str, values: Floats, writable: bool, blank: bool) -> None:
        self.name, self.values, self.writable = name, values, writable
        self.written = np.full(len(values), not blank)
        self.read: set[int] = set()

    def _place(self, i: Any) -> int:
        if not isinstance(i, int | np.integer) or not 0 <= i < len(self.values):
            raise Mistake(f"uses {self.name}[{i}], but {self.name} has {len(self.values)} values")
        return int(i)

    def __getitem__(self, i: Any) -> np.float64:
        i = self._place(i)
        if not self.written[i]:
            raise Mistake(f"reads {self.name}[{i}] before it has written it")
        self.read.add(i)
        return self.values[i]  # type: ignore[no-any-return]

    def __setitem__(self, i: Any, value: float) -> None:
        i = self._place(i)
        if not self.writable:
            raise Mistake(f"writes {self.name}[{i}], which it may only read")
        self.values[i] = value
        self.written[i] = True


class Clock:
    """A time that knows whether somebody looked at it: by arithmetic, a comparison, or as the float it stands for."""

    __array_ufunc__ = None  # lets numpy's numbers ask it, too

    def __init__(self, t: float) -> None:
        self.t, self.read = t, False

    def __float__(self) -> float:
        self.read = True
        return self.t


def _noticed(name: str) -> Any:
    def looks(self: Clock, *others: Any) -> Any:
        self.read = True
        return getattr(self.t, name)(*(float(other) for other in others))

    return looks


for _name in ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow"):
    for _side in ("", "r"):
        setattr(Clock, f"__{_side}{_name}__", _noticed(f"__{_side}{_name}__"))
for _name in [
    "lt",
    "le",
    "gt",
    "ge",
    "eq",
    "ne",
    "neg",
    "pos",
    "abs",
    "bool",
    "int",
    "floor",
    "ceil",
    "trunc",
    "round",
]:
    setattr(Clock, f"__{_name}__", _noticed(f"__{_name}__"))


def dry_run(block: "Block") -> None:
    """Try the kernels of a block, once for blocks of the same kernels and sizes.

    Raises ``BlockError`` with the kernel and what it did: an index beyond an array, a value that is not its own
    changed, an output never written, an input read in spite of ``feeds=False``, the time read in spite of
    ``timed=False``, values that are not affine in spite of ``linear=True``, an error, a loop without end.
    """
    k = block.kernels
    sizes = (len(block.ports_in), len(block.ports_out), len(block.x0), len(block.d0), len(block.p))
    key = (k, sizes, tuple(block.modes.values()), block.takes_samples)
    if block.host is not None or key in _passed:
        return
    try:
        _complete(block)
        with contextlib.redirect_stdout(io.StringIO()) as said, np.errstate(all="ignore"):
            names = ("out", "der", "zc", "jump", "next_time", "step")
            for name in names[-1:] if block.sampled else names:
                kernel = getattr(k, name)
                always_python = isinstance(getattr(kernel, "may_run_in_python", None), str)  # cannot harm memory
                if kernel is not None and not always_python and (name != "der" or len(block.x0)):
                    _Trial(block, name, kernel).run()
            if k.linear and not block.sampled:
                _linear(block)
    except Mistake as mistake:
        raise BlockError(f"block '{block.name}': {mistake}; correct it") from mistake
    if said.getvalue():
        raise BlockError(f"block '{block.name}': a kernel prints, which compiled code cannot; take out print")
    _passed.add(key)


def _complete(block: "Block") -> None:
    """Refuse kernels that are missing or would never be called."""
    k = block.kernels
    rules = (
        (block.sampled and k.step is None, "has a sampling period but no kernel step"),
        (
            not block.takes_samples and k.step is not None,
            "has a kernel step but no period_param or timetable, so it would never be called",
        ),
        (not block.sampled and len(block.ports_out) > 0 and k.out is None, "has outputs but no kernel out"),
        (
            not block.sampled and k.out is None,
            "has no kernel out, so nothing could be seen of it; give it an output and a kernel out",
        ),
        (not block.sampled and len(block.x0) > 0 and k.der is None, "has states but no kernel der"),
        (not block.sampled and k.n_events > 0 and not (k.zc and k.jump), "has n_events, but lacks kernel zc or jump"),
        (not block.sampled and k.zc is not None and k.n_events < 1, "has a kernel zc, but n_events = 0"),
        (len(block.modes) > 0 and not len(block.d0), "has modes, but no memory d[0] to keep them in"),
    )
    for broken, words in rules:
        if broken:
            raise Mistake(words)


def _linear(block: "Block") -> None:
    """Refuse a block that is not linear in each mode, but says so."""
    if kernel := not_affine(block):
        raise Mistake(f"kernel {kernel} is not affine, but linear=True says that it is: leave linear out")


class _Trial:
    """One kernel of a block, called again and again."""

    def __init__(self, block: "Block", name: str, kernel: "Kernel") -> None:
        self.block, self.name, self.kernel = block, name, kernel
        if kernel.__code__.co_argcount != 6:
            self._refuse(f"takes {kernel.__code__.co_argcount} arguments, but a kernel takes (t, x, d, u, p, out)")
        self.loops = _loops(kernel.__code__, kernel)
        self.n_in = len(block.ports_in)
        if block.kernels.rates and name in ("zc", "jump"):
            self.n_in *= 2  # the rates behind the inputs
        self.n_out = {"out": len(block.ports_out), "step": len(block.ports_out), "der": len(block.x0),
                      "zc": block.kernels.n_events, "jump": 1, "next_time": 2}[name]  # fmt: skip

    def run(self) -> None:
        """Try all there is to try."""
        kernels = self.block.kernels
        blind = {i for i, follows in enumerate(kernels.follows(self.n_in)) if not follows}
        for d in self._memories():
            for start in range(self.block.kernels.n_events if self.name == "jump" else 1):
                for t, x, u in self._situations():
                    given = np.array([float(start)]) if self.name == "jump" else np.array([math.inf, math.inf])
                    blank = self.name not in ("jump", "next_time")
                    out = np.full(self.n_out, math.nan) if blank else given
                    arrays = self._call(t, x.copy(), d.copy(), u, out, blank)
                    if self.name == "out" and (seen := arrays["u"].read & blind):
                        self._refuse(f"reads u[{min(seen)}], but feeds={kernels.feeds} says that it does not: "
                                     "an algebraic loop would be hidden")  # fmt: skip
                    if self.name == "zc" and self._looks_unasked(d, arrays["u"]):
                        self._refuse(f"looks at rates in mode {d[0]:g}, which is not among its rate_modes: add it")
        if self.name == "step":
            self._sequence(bool(blind))
        if self.name in ("out", "der") and not self.block.kernels.timed:
            self._without_time()

    def _looks_unasked(self, d: Floats, u: Guarded) -> bool:
        """Return whether event functions look at rates in a mode in which they say that they do not."""
        k = self.block.kernels
        asked = not (k.rates and k.rate_modes) or d[0] in k.rate_modes
        return not asked and max(u.read, default=-1) >= len(self.block.ports_in)

    def _without_time(self) -> None:
        """Refuse a kernel that looks at a time which it says it does not read."""
        for d in self._memories():
            for t, x, u in self._situations():
                clock, out = Clock(t), np.zeros(self.n_out)
                # what fails here has been judged before, with a plain time
                with contextlib.suppress(Exception), _bounded() if self.loops else contextlib.nullcontext():
                    self.kernel(clock, x.copy(), d.copy(), u, self.block.p, out)  # type: ignore[arg-type]
                if clock.read:
                    self._refuse("reads the time t, but timed=False says that it does not: write Kernels(timed=True)")

    def _sequence(self, blind: bool) -> None:
        """Take samples one after the other; without feedthrough the inputs must not show in the outputs at once."""
        d = self.block.d0.copy()
        for number in range(SAMPLES):
            outs = []
            for shift in (0.5, 0.0) if blind else (0.0,):
                u = np.array([math.sin(number + i + shift) for i in range(self.n_in)])
                memory, out = d.copy(), np.full(self.n_out, math.nan)
                self._call(float(number), self.block.x0.copy(), memory, u, out, True)
                outs.append(out.tobytes())
            if len(set(outs)) > 1:
                self._refuse("lets outputs follow the inputs of the same sample, but feeds=False says that it does not")
            d = memory

    def _memories(self) -> Iterator[Floats]:
        yield self.block.d0
        for value in self.block.modes.values():
            d = self.block.d0.copy()
            d[0] = value
            yield d

    def _situations(self) -> Iterator[tuple[float, Floats, Floats]]:
        """Yield times, states and inputs."""
        spread = np.linspace(0.2, 0.9, self.n_in)
        yield 0.0, self.block.x0, spread
        for value in INPUTS:
            yield 1e3, self.block.x0 + (value if self.name != "jump" else 0.0), np.full(self.n_in, value)

    def _call(self, t: float, x: Floats, d: Floats, u: Floats, out: Floats, blank: bool) -> dict[str, Guarded]:
        changes = CHANGES.get(self.name, ("out",))
        arrays = {
            name: Guarded(name, values, name in changes, blank and name == "out")
            for name, values in zip(ARGUMENTS, (x, d, u, self.block.p, out), strict=True)
        }
        try:
            with _bounded() if self.loops else contextlib.nullcontext():
                self.kernel(t, *arrays.values())
        except Mistake as mistake:
            self._refuse(str(mistake))
        except (ArithmeticError, ValueError) as error:  # 1/0 and log(-1) are errors here, inf and NaN when compiled
            if "to integer" in str(error):
                self._refuse(f"makes an integer of {'NaN' if 'NaN' in str(error) else 'infinity'}; ask before")
            return arrays
        except Exception as error:
            whole = "; all values of a block are floats, so write int(n) where a whole number is needed"
            hint = whole if isinstance(error, TypeError) and "numpy.float64" in str(error) else ""
            self._refuse(f"fails: {type(error).__name__}: {error}{hint}")
        at_start = t == 0.0 and np.array_equal(d, self.block.d0) and np.array_equal(x, self.block.x0)
        if self.name == "zc" and at_start and np.isnan(out).any() and arrays["out"].written.all():
            self._refuse(f"writes NaN to out[{int(np.argmax(np.isnan(out)))}] at the start: an event that never comes")
        if blank and not arrays["out"].written.all():
            self._refuse(f"does not always write out[{int(np.argmin(arrays['out'].written))}]")
        return arrays

    def _refuse(self, words: str) -> None:
        raise Mistake(f"kernel {self.name} ({self.kernel.__code__.co_name}) {words}")


@cache
def _loops(code: CodeType, function: FunctionType) -> bool:
    """Return whether a function, or one that it calls by name, could run for ever."""
    if any(
        step.opname.startswith("JUMP_BACKWARD") or "_BACKWARD_" in step.opname for step in dis.get_instructions(code)
    ):
        return True
    called = (function.__globals__.get(name) for name in code.co_names)
    return any(isinstance(f, FunctionType) and (f is function or _loops(f.__code__, f)) for f in called)


@contextlib.contextmanager
def _bounded() -> Iterator[None]:
    """Let only so many steps of the interpreter run."""
    before, left = sys.gettrace(), MOST_STEPS

    def watch(frame: FrameType, event: str, argument: Any) -> Any:
        nonlocal left
        frame.f_trace_opcodes = True  # a loop on one line has no other events
        left -= 1
        if left < 0:
            raise Mistake("does not come to an end")
        return watch

    sys.settrace(watch)
    try:
        yield
    finally:
        sys.settrace(before)
