"""The axes of a study: those with listed values form a grid, the others are random."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.ports import nearest

Value = float | str
Kind = Literal["vary", "plant", "start"]
LAWS = ("uniform", "loguniform", "normal")
GRAMMAR = "write a,b,c or low:high:count (add ':log' for even ratios) or uniform(low,high), loguniform, normal(mean,sd)"
MOST_VALUES = 1_000_000  # on one axis


class StudyError(ValueError):
    """A study that makes no sense: the message gives the value, the rule and the remedy."""


@dataclass(frozen=True)
class Law:
    """A random law with its two numbers: low and high, or mean and standard deviation."""

    law: str
    a: float
    b: float

    def __post_init__(self) -> None:
        shown = f"{self.law}({self.a:g}, {self.b:g})"
        if self.law not in LAWS:
            raise StudyError(f"there is no law '{self.law}'; {nearest(self.law, LAWS)}")
        if not (math.isfinite(self.a) and math.isfinite(self.b)):
            raise StudyError(f"{shown}: both numbers must be finite")
        if self.law == "normal" and self.b <= 0.0:
            raise StudyError(f"{shown}: the standard deviation must be positive")
        if self.law != "normal" and self.a >= self.b:
            raise StudyError(f"{shown}: the first number must be below the second; exchange them")
        if self.law == "loguniform" and self.a <= 0.0:
            raise StudyError(f"{shown}: even ratios need positive limits; take uniform")

    def __str__(self) -> str:
        return f"{self.law}({self.a!r},{self.b!r})"

    def at(self, share: ArrayLike) -> list[float]:
        """Return the values below which the law has these shares (0..1), (n,).

        >>> loguniform(1.0, 100.0).at([0.0, 0.5, 1.0])
        [1.0, 10.0, 100.0]
        """
        u = np.asarray(share, dtype=float)
        if self.law == "uniform":
            found = self.a + (self.b - self.a) * u
        elif self.law == "loguniform":
            found = self.a * (self.b / self.a) ** u
        else:
            from scipy.special import ndtri

            found = self.a + self.b * ndtri(u)
        return [float(v) for v in found]


def uniform(low: float, high: float) -> Law:
    """Return the law of values equally likely between ``low`` and ``high``."""
    return Law("uniform", float(low), float(high))


def loguniform(low: float, high: float) -> Law:
    """Return the law of values whose logarithm is uniform: even ratios, for gains and times."""
    return Law("loguniform", float(low), float(high))


def normal(mean: float, sd: float) -> Law:
    """Return the normal law."""
    return Law("normal", float(mean), float(sd))


@dataclass(frozen=True)
class Axis:
    """One thing that varies: its name, what kind it is, and its listed values or its law."""

    kind: Kind
    name: str
    values: tuple[Value, ...] = ()
    law: Law | None = None
    as_vary: bool = False  # a quantity of the plant asked for among the parameters

    @property
    def column(self) -> str:
        """The name of the axis in the table."""
        return self.name if self.kind == "vary" or self.as_vary else f"{self.kind}.{self.name}"

    @property
    def even_ratios(self) -> bool:
        """Whether the values are spread by ratio rather than by difference."""
        if self.law:
            return self.law.law == "loguniform"
        numbers = [v for v in self.values if isinstance(v, float) and v > 0.0]
        if len(numbers) < len(self.values) or len(numbers) < 3 or numbers != sorted(numbers):
            return False
        return (
            numbers[-1] / numbers[-2] > 1.05 and abs(numbers[1] / numbers[0] * numbers[-2] / numbers[-1] - 1.0) < 1e-6
        )

    def spelt(self) -> object:
        """Return the axis as plain values for JSON."""
        if self.law:
            return str(self.law)
        return [v if isinstance(v, str) or math.isfinite(v) else str(v) for v in self.values]  # JSON has no infinity


def axes_of(kind: Kind, given: Mapping[str, object] | None) -> list[Axis]:
    """Return the axes of ``{name: values or law}``; a single value is an axis of one.

    Raises ``StudyError`` for no values, a value twice, or what is neither numbers, words of the plant nor a law.

    >>> axes_of("vary", {"valve.F_s": [1750, 2250]})[0].values
    (1750.0, 2250.0)
    """
    found = []
    for name, values in (given or {}).items():
        if isinstance(values, Law):
            found.append(Axis(kind, name, law=values))
            continue
        try:
            listed = [values] if isinstance(values, str | float | int) else list(values)  # type: ignore[call-overload]
            chosen = tuple(v if isinstance(v, str) else float(v) for v in listed)
        except (TypeError, ValueError):
            raise StudyError(
                f"'{name}' = {values!r} is no list of numbers; give some, or a law such as uniform(low, high)"
            ) from None
        if not chosen:
            raise StudyError(f"'{name}' has no values; give at least one")
        if len(set(chosen)) < len(chosen):
            raise StudyError(f"'{name}' has a value twice; give each once (kicks=, --kicks, repeats a point)")
        for value in chosen:
            if isinstance(value, str) and kind != "plant":
                raise StudyError(
                    f"'{name}' = '{value}' is no number; only quantities of the plant (plant=, --plant) are words"
                )
            if isinstance(value, float) and math.isnan(value):
                raise StudyError(f"'{name}' = nan is no number")
        found.append(Axis(kind, name, chosen))
    return found


def parse(text: str) -> tuple[str, Law | list[Value]]:
    """Return name and values of ``NAME=VALUES`` as it is written on the command line.

    Raises ``StudyError`` for what does not read so.

    >>> parse("VPCS1.F_s=1250:2250:3")
    ('VPCS1.F_s', [1250.0, 1750.0, 2250.0])
    >>> parse("PCS11.K_p=5e-7,8.8e-7")[1], parse("F_s=none,high")[1]
    ([5e-07, 8.8e-07], ['none', 'high'])
    >>> str(parse("F_in=uniform(7000,8000)")[1])
    'uniform(7000.0,8000.0)'
    """
    name, sign, spelt = (part.strip() for part in text.partition("="))
    if not (name and sign and spelt):
        raise StudyError(f"'{text}' is not NAME=VALUES; {GRAMMAR}")
    drawn = re.fullmatch(r"(\w+)\((.*)\)", spelt)
    if drawn:
        numbers = _numbers(drawn[2].split(","), text)
        if len(numbers) != 2:
            raise StudyError(f"'{text}': a law has two numbers, not {len(numbers)}; {GRAMMAR}")
        return name, Law(drawn[1], *numbers)
    if ":" in spelt:
        return name, _range(spelt, text)
    words = [word.strip() for word in spelt.split(",")]
    if "" in words:
        raise StudyError(f"'{text}' has an empty value; {GRAMMAR}")
    return name, [_value(word) for word in words]


def _range(spelt: str, text: str) -> list[Value]:
    pieces = spelt.split(":")
    even_ratios = len(pieces) == 4 and pieces[3].strip() == "log"
    if len(pieces) != 3 and not even_ratios:
        raise StudyError(f"'{text}': a range is low:high:count, e.g. 1250:2250:11; {GRAMMAR}")
    low, high = _numbers(pieces[:2], text)
    if not re.fullmatch(r"\s*\d+\s*", pieces[2]) or not 2 <= int(pieces[2]) <= MOST_VALUES:
        raise StudyError(f"'{text}': the count {pieces[2]!r} must be a whole number of at least 2")
    if not (math.isfinite(low) and math.isfinite(high)) or low == high:
        raise StudyError(f"'{text}': a range has two different, finite ends; name a single value alone")
    if even_ratios and not (low > 0.0 and high > 0.0):
        raise StudyError(f"'{text}': even ratios need positive ends; leave ':log' out")
    spaced = np.geomspace if even_ratios else np.linspace
    return [float(v) for v in spaced(low, high, int(pieces[2]))]


def _numbers(words: Sequence[str], text: str) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        raise StudyError(f"'{text}' holds something that is no number; {GRAMMAR}") from None


def _value(word: str) -> Value:
    try:
        return float(word)
    except ValueError:
        return word
