"""The result of an ensemble: one entry a variant.  Each can be inspected, or run again alone."""

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.branches import Branches, Taken
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.variants import Floats, Variants
from stickslip.diagram.kinds import known_loops
from stickslip.diagram.run_events import Event, named_events
from stickslip.diagram.simulation import Run, simulate
from stickslip.engine.run import Settings
from stickslip.engine.status import HINTS, Statistics, Status
from stickslip.logs import Log
from stickslip.logs.files.write import replacing
from stickslip.logs.loop_signals import LoopsLater, within
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def freeze(arrays: Iterable[NDArray[Any]]) -> None:
    """Make arrays read-only."""
    for array in arrays:
        array.flags.writeable = False


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble(Shown):
    """The outcome of ``ensemble``.

    Attributes: ``t`` (log times [s], (rows,), or (variants, rows) where variants have times of their own; see
    ``times``.); ``values`` (signal -> (variants, rows), read-only; NaN where a variant did not get to.); ``status``
    ((variants,) codes of ``Status``; ``ended`` (variants,) the time reached [s].); ``summary`` (name -> (variants,),
    NaN where a variant failed.); ``event_counts`` ((variants,); ``statistics`` the cost of all variants together.);
    ``troubles`` ((variants,) what the blocks say where a variant's model ended, else "".); ``variants``, ``settings``,
    ``duration`` (what was asked for, see ``params``, ``start``, ``seeds``.); ``raw_events`` (per variant (events, 4):
    t, block, value before, value after; see ``events``.); ``branches``, ``taken`` (as in ``simulate`` and ``Run``, per
    variant); ``notes`` (on the steps that functions of the time allow, the shortest of all variants).
    """

    t: Floats
    values: Mapping[str, Floats]
    status: NDArray[np.int8]
    ended: Floats
    summary: Mapping[str, Floats]
    event_counts: NDArray[np.int64]
    troubles: tuple[str, ...]
    statistics: Statistics
    variants: Variants
    settings: Settings
    duration: float
    raw_events: tuple[Floats, ...]
    branches: Branches | None = None
    taken: tuple[tuple[Taken, ...], ...] = ()
    notes: tuple[str, ...] = ()

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Make the arrays read-only again, which a pickle forgets."""
        self.__dict__.update(state)
        freeze([self.t, self.status, self.ended, *self.values.values(), *self.summary.values()])

    def __len__(self) -> int:
        return len(self.status)

    @property
    def headline(self) -> str:
        """The result in one line."""
        codes, counts = np.unique(self.status, return_counts=True)
        text = ", ".join(f"{count} {Status(int(code)).name}" for code, count in zip(codes, counts, strict=True))
        return f"{len(self)} variants of '{self.variants.diagram.name}' over {self.duration:g} s: {text}"

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Which variants reached their end, (variants,)."""
        return np.asarray(self.status == Status.OK)

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C came before all variants were done."""
        return bool((self.status == Status.INTERRUPTED).any())

    @property
    def params(self) -> Mapping[str, Floats]:
        """The parameters given, name -> (variants,)."""
        return self.variants.params

    @property
    def start(self) -> Mapping[str, Floats]:
        """The start values given, name -> (variants,)."""
        return self.variants.start

    @property
    def seeds(self) -> NDArray[np.int64] | None:
        """The seed of every variant, (variants,)."""
        return self.variants.seeds

    def times(self, i: int) -> Floats:
        """Return the log times of variant ``i`` [s], (rows,)."""
        self._check(i)
        return self.t if self.t.ndim == 1 else self.t[i]

    def described(self, i: int) -> str:
        """Return what makes variant ``i`` different, in one line."""
        self._check(i)
        parts = [f"{key} = {column[i]:g}" for key, column in [*self.params.items(), *self.start.items()]]
        return ", ".join(parts + ([] if self.seeds is None else [f"seed {self.seeds[i]}"]))

    def hint(self, i: int) -> str:
        """Return why variant ``i`` failed and what to try; empty if it did not fail."""
        self._check(i)
        text = self.troubles[i] or HINTS[Status(int(self.status[i]))]
        return f"{text} (at t = {self.ended[i]:.6g} s)" if text else ""

    def log(self, i: int) -> Log:
        """Return the signals kept of variant ``i``.

        Raises ``ValueError`` if the ensemble kept no logs.
        """
        self._check(i)
        if not self.values:
            raise ValueError(f"no logs were kept; give keep_logs=True, or call run({i}) to simulate the variant again")
        diagram = self.variants.diagram
        return Log(
            t=self.times(i),
            signals={signal: rows[i] for signal, rows in self.values.items()},
            units={s: diagram.signal_units[s] for s in self.values if diagram.signal_units.get(s)},
            spans={s: span for s, span in diagram.signal_spans.items() if s in self.values},
            origin=f"simulated: {diagram.name}, variant {i}: {self.described(i)}",
            loops=LoopsLater(lambda: within(known_loops(diagram), self.values)),
        )

    def events(self, i: int) -> tuple[Event, ...]:
        """Return the changes of mode of variant ``i`` in order of time (none if no logs were kept)."""
        self._check(i)
        return named_events(self.variants.diagram, self.raw_events[i].tolist())

    def variant(self, i: int) -> Diagram:
        """Return variant ``i`` as a diagram with its parameters, start values and random numbers."""
        self._check(i)
        return self.variants.diagram_of(i)

    def run(self, i: int) -> Run:
        """Simulate variant ``i`` again, alone and with all signals; the values agree to the last bit."""
        return simulate(
            self.variant(i), self.duration, times=self.times(i), t0=float(self.variants.t0[i]),
            settings=self.settings, branches=self.branches,
        )  # fmt: skip

    def plot(self, signal: str = "") -> "Figure":
        """Plot a signal over all variants that reached their end: 5 to 95 %, some variants, a typical one.

        Without a ``signal`` it is PV, or the last one kept where none is called so.
        """
        from stickslip.diagram.figures.spread import plot_ensemble

        return plot_ensemble(self, signal or ("PV" if "PV" in self.values else list(self.values)[-1]))

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write one row a variant: status, parameters, start values ``name(0)``, seed, summary, signals as arrays.

        Time [s], units and settings are JSON in the footer under the key "stickslip".  The file appears whole or
        not at all.  Read with ``polars.read_parquet(path)["PV"].to_numpy()``, shape (variants, rows).
        """
        import polars as pl

        columns: dict[str, object] = {
            "variant": np.arange(len(self)),
            "status": [Status(int(code)).name for code in self.status],
            **self.params,
            **{f"{key}(0)": column for key, column in self.start.items()},
            **({} if self.seeds is None else {"seed": self.seeds}),
            **({} if self.t.ndim == 1 else {"t0 [s]": self.variants.t0, "time [s]": self.t}),
            "events": self.event_counts,
            **{f"summary.{key}": column for key, column in self.summary.items()},
            **self.values,
        }
        heading = {
            "origin": f"simulated: {self.variants.diagram.name}", "duration [s]": self.duration,
            "units": self.variants.diagram.signal_units, "rtol": self.settings.rtol, "atol": self.settings.atol,
            "method": self.settings.method, "max_step [s]": self.settings.max_step, "notes": self.notes,
            "time [s]": self.t.tolist(),
        }  # fmt: skip
        with replacing(path) as part:
            pl.DataFrame(columns).write_parquet(part, metadata={"stickslip": json.dumps(heading)})

    def _check(self, i: int) -> None:
        if not -len(self) <= i < len(self):
            raise IndexError(f"there is no variant {i}; the ensemble has {len(self)}")
