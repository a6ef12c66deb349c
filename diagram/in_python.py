"""Which functions of a run could not be compiled and ran in Python, and what they cost."""

from collections.abc import Mapping
from dataclasses import dataclass

from stickslip.diagram.wired import Wired
from stickslip.engine.call import any_in_python, in_python
from stickslip.engine.callback import Callback

Counts = Mapping[Callback, tuple[int, float]]


@dataclass(frozen=True)
class InPython:
    """A function called in Python: the blocks that use it, how often and for how long [s] in this run, and why."""

    blocks: tuple[str, ...]
    calls: int
    seconds: float
    reason: str

    def __str__(self) -> str:
        return (
            f"{', '.join(self.blocks)}: {self.calls} calls in Python took {self.seconds:.3g} s, because {self.reason}"
        )


def users(diagram: Wired) -> dict[Callback, tuple[str, ...]]:
    """Return the functions that run in Python, with the blocks that use them."""
    found: dict[Callback, tuple[str, ...]] = {}
    if not any_in_python():
        return found
    for block in diagram.blocks:
        for kernel in vars(block.kernels).values():
            callback = in_python(kernel) if callable(kernel) else None
            if callback is not None:
                found[callback] = (*found.get(callback, ()), block.name)
    return found


def counts(diagram: Wired) -> Counts:
    """Return the calls and seconds so far of the functions that run in Python."""
    return {callback: (callback.calls, callback.seconds) for callback in users(diagram)}


def spent(diagram: Wired, before: Counts) -> tuple[InPython, ...]:
    """Return what was spent in Python since ``before``, one entry a function."""
    entries = []
    for callback, blocks in users(diagram).items():
        calls, seconds = before.get(callback, (0, 0.0))
        if callback.calls > calls:
            entries.append(InPython(blocks, callback.calls - calls, callback.seconds - seconds, callback.reason))
    return tuple(entries)
