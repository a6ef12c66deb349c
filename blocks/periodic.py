"""Periodic signals: sine, square wave, triangle and slug flow.

    sine      y = mean + amplitude sin(2 pi (t - start) / period + phase)
    square    y = mean + amplitude during the first ``duty`` of each period, mean - amplitude during the rest
    triangle  straight lines between mean - amplitude and mean + amplitude, rising during ``rise`` of the period
    slug      a triangle that rises during 80 % of its period and falls during 20 %

All are ``mean`` before ``start`` [s]; triangle and slug begin there in the middle of their rise, so that they
do not jump.  ``amplitude`` is half the peak-to-peak value, ``mean`` the average over a period (of a square wave
only if duty = 0.5).  Jumps and kinks are announced to the engine; on a sine its step is at most period / 24.

Slug flow: liquid collects slowly in a riser and is blown out fast, hence slow rise and fast fall.  The share of 80 %
is an engineering choice; the thesis speaks of periods of about ten minutes and takes a sine of 500 s for its slugs.
Valid for any finite numbers.  Source: thesis sections 1.3 and 5.1.3; textbook signals.
See also: sources, recorded, noise.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.ports import require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite
from stickslip.blocks.sources import Source

TWO_PI = 2.0 * math.pi


def whole(t: float, start: float, length: float) -> float:
    """Return the largest whole k with ``start + k length <= t``, exactly as this sum is rounded."""
    k = math.floor((t - start) / length)
    if start + (k + 1.0) * length <= t:
        k += 1
    elif start + k * length > t:
        k -= 1
    return k


def _sine_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] + p[1] * math.sin(TWO_PI * (t - p[4]) / p[2] + p[3]) if t >= p[4] else p[0]


def _sine_next(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
    out[0] = p[4] if t < p[4] else math.inf
    out[1] = p[2] / 24.0 if t >= p[4] else math.inf


def _square_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0]
    if t >= p[3]:
        begin = p[3] + whole(t, p[3], p[2]) * p[2]
        y[0] = p[0] + p[1] if t < begin + p[4] * p[2] else p[0] - p[1]


def _square_next(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
    out[0] = p[3]
    if t >= p[3]:
        k = whole(t, p[3], p[2])
        fall = p[3] + k * p[2] + p[4] * p[2]
        out[0] = fall if t < fall else p[3] + (k + 1.0) * p[2]


def _triangle_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0]
    if t >= p[3]:
        origin = p[3] - 0.5 * p[4] * p[2]
        bottom = origin + whole(t, origin, p[2]) * p[2]
        top = bottom + p[4] * p[2]
        if t < top:
            y[0] = p[0] + p[1] * (2.0 * (t - bottom) / (p[4] * p[2]) - 1.0)
        else:
            y[0] = p[0] + p[1] * (1.0 - 2.0 * (t - top) / ((1.0 - p[4]) * p[2]))


def _triangle_next(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
    out[0] = p[3]
    if t >= p[3]:
        origin = p[3] - 0.5 * p[4] * p[2]
        k = whole(t, origin, p[2])
        top = origin + k * p[2] + p[4] * p[2]
        out[0] = top if t < top else origin + (k + 1.0) * p[2]


def _check(params: Mapping[str, float], name: str, share: str = "") -> None:
    finite(params, name, "mean", "amplitude", "period", "start")
    period = float(params["period"])
    require(period > 0.0, name, "period", period, "it must be positive", "give period= in seconds")
    if share:
        value = float(params[share])
        require(0.0 < value < 1.0, name, share, value, "it is a share of the period", "give a number between 0 and 1")


class Sine(Source):
    """A sine: ``mean`` + ``amplitude`` sin(2 pi (t - start)/period + phase), ``period`` [s], ``phase`` [rad].

    >>> float(Sine("SP", amplitude=2.0, period=4.0, mean=1.0).output(1.0, [], [])[0])
    3.0
    """

    kernels = Kernels(out=_sine_out, next_time=_sine_next, feeds=False, timed=True)

    def __init__(
        self, signal: str, amplitude: float = 1.0, period: float = 1.0, *, mean: float = 0.0, phase: float = 0.0,
        start: float = 0.0, unit: str = "", name: str = "",
    ) -> None:  # fmt: skip
        params = {"mean": mean, "amplitude": amplitude, "period": period, "phase": phase, "start": start}
        super().__init__(signal, params, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all are finite and period > 0."""
        _check(params, name)
        finite(params, name, "phase")


class Square(Source):
    """A square wave: high during the share ``duty`` of each ``period`` [s], low during the rest.

    >>> wave = Square("SP", amplitude=0.1, period=10.0, mean=0.5)
    >>> [float(wave.output(t, [], [])[0]) for t in (-1.0, 0.0, 5.0, 10.0)]
    [0.5, 0.6, 0.4, 0.6]
    """

    kernels = Kernels(out=_square_out, next_time=_square_next, feeds=False, timed=True, linear=True)

    def __init__(
        self, signal: str, amplitude: float = 1.0, period: float = 1.0, *, mean: float = 0.0, start: float = 0.0,
        duty: float = 0.5, unit: str = "", name: str = "",
    ) -> None:  # fmt: skip
        params = {"mean": mean, "amplitude": amplitude, "period": period, "start": start, "duty": duty}
        super().__init__(signal, params, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all are finite, period > 0 and 0 < duty < 1."""
        _check(params, name, "duty")


class Triangle(Source):
    """Straight lines up and down, rising during the share ``rise`` of each ``period`` [s].

    >>> wave = Triangle("OP", amplitude=0.2, period=8.0, mean=0.5)
    >>> [round(float(wave.output(t, [], [])[0]), 6) for t in (0.0, 1.0, 2.0, 4.0, 6.0)]
    [0.5, 0.6, 0.7, 0.5, 0.3]
    """

    kernels = Kernels(out=_triangle_out, next_time=_triangle_next, feeds=False, timed=True, linear=True)

    def __init__(
        self, signal: str, amplitude: float = 1.0, period: float = 1.0, *, mean: float = 0.0, start: float = 0.0,
        rise: float = 0.5, unit: str = "", name: str = "",
    ) -> None:  # fmt: skip
        params = {"mean": mean, "amplitude": amplitude, "period": period, "start": start, "rise": rise}
        super().__init__(signal, params, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all are finite, period > 0 and 0 < rise < 1."""
        _check(params, name, "rise")


class Slug(Triangle):
    """Slug flow: a slow rise over 80 % of the ``period`` [s] and a fast fall over 20 %.

    >>> feed = Slug("D", amplitude=1.0, period=10.0)
    >>> [round(float(feed.output(t, [], [])[0]), 6) for t in (0.0, 2.0, 4.0, 6.0, 8.0)]
    [0.0, 0.5, 1.0, -1.0, -0.5]
    """

    role = Role.DISTURBANCE

    def __init__(
        self, signal: str, amplitude: float = 1.0, period: float = 1.0, *, mean: float = 0.0, start: float = 0.0,
        rise: float = 0.8, unit: str = "", name: str = "",
    ) -> None:  # fmt: skip
        super().__init__(signal, amplitude, period, mean=mean, start=start, rise=rise, unit=unit, name=name)
