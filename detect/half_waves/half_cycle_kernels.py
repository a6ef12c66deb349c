"""Half cycles measured, compiled: ``half_cycle``, and the sums of ``hagglund2011``.

Loaded when first called.  A record has hundreds of half cycles of a few dozen samples, for which arrays are too dear,
and so is a call for each: ``half_cycles`` and ``half_waves`` go through all of a record.
"""

import math
from typing import Any

from stickslip.detect.signals.order_kernels import count_before, count_until
from stickslip.logs.compiled import njit

FAULTS = ("", "short", "two_peaks", "flat", "length", "low")
MARGIN_SAMPLES = 4  # samples beyond a half cycle that help to place its peak


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _corner(t: Any, x: Any, sign: float, a: int) -> tuple[float, float, float]:
    """How sharp a corner between samples a and a + 1 would be, its time and its height; sharpness 0 is none."""
    if a < 2 or a + 3 >= len(t):
        return 0.0, 0.0, 0.0
    far_left = sign * (x[a - 1] - x[a - 2]) / (t[a - 1] - t[a - 2])
    left = sign * (x[a] - x[a - 1]) / (t[a] - t[a - 1])
    right = sign * (x[a + 2] - x[a + 1]) / (t[a + 2] - t[a + 1])
    far_right = sign * (x[a + 3] - x[a + 2]) / (t[a + 3] - t[a + 2])
    if left <= right:
        return 0.0, 0.0, 0.0
    # The sides are curved: their slopes at the corner are extrapolated from the two secants on either side.
    bend_left = (left - far_left) / (t[a] - t[a - 2])
    bend_right = (far_right - right) / (t[a + 3] - t[a + 1])
    when, rise, fall = 0.5 * (t[a] + t[a + 1]), left, right
    for _ in range(4):
        rise = left + bend_left * (when - t[a - 1])
        fall = right + bend_right * (when - t[a + 2])
        if rise <= fall:
            return 0.0, 0.0, 0.0
        when = t[a] + (sign * (x[a + 1] - x[a]) - fall * (t[a + 1] - t[a])) / (rise - fall)
    slack = 0.2 * (t[a + 1] - t[a])  # a corner on a sample may come out just beside it
    if not (t[a] - slack <= when <= t[a + 1] + slack):
        return 0.0, 0.0, 0.0
    smooth = 2.0 * max(abs(far_left - left), abs(right - far_right))
    return (left - right) / max(smooth, 1e-12 * (left - right)), when, sign * x[a] + rise * (when - t[a])


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _vertex(t: Any, x: Any, sign: float, k: int, kink: float) -> tuple[float, float]:
    """Time and height of the peak near its highest sample k; see ``half_cycle``."""
    here = sign * x[k]
    if k < 1 or k > len(t) - 2:
        return t[k], here
    sharp, when, height = _corner(t, x, sign, k - 1)
    sharp_2, when_2, height_2 = _corner(t, x, sign, k)
    if sharp_2 > sharp:
        sharp, when, height = sharp_2, when_2, height_2
    if sharp > kink:
        return when, max(height, here)
    # Newton form of the parabola through k-1, k, k+1; its vertex is where the slope vanishes.
    before = sign * x[k - 1]
    d0, d1 = t[k] - t[k - 1], t[k + 1] - t[k]
    s0, s1 = (here - before) / d0, (sign * x[k + 1] - here) / d1
    bend = (s1 - s0) / (d0 + d1)
    if bend >= 0.0:
        return t[k], here
    when = min(max(0.5 * (t[k - 1] + t[k]) - 0.5 * s0 / bend, t[k - 1]), t[k + 1])
    return when, before + (when - t[k - 1]) * (s0 + bend * (when - t[k]))


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def half_cycle(
    t: Any, x: Any, start: float, end: float, noise: float, least: int, flat_share: float, two_peaks: float, kink: float
) -> tuple[Any, ...]:
    """Fault (index of FAULTS), peak time, peak, areas before and after, samples, misfits of sine and triangle.

    x is centred on its baseline and reaches beyond the half cycle if it can.  Samples within one ``noise`` of the
    highest are the top, and the peak is the centre of the top weighted by height; without noise it is interpolated.

    The lines through the two samples on either side meet in a corner (exact for a triangle, near exact for an
    exponential); the parabola through three samples is exact for a round top. The corner is believed when the
    slope breaks there by more than ``kink`` times what the curvature on either side would explain.
    """
    lo, hi = count_until(t, start), count_before(t, end)
    n = hi - lo
    if n < least:
        return 1, 0.5 * (start + end), 0.0, 0.0, 0.0, n, 0.0, 0.0
    total = 0.0
    for k in range(lo, hi):
        total += x[k]
    sign = 1.0 if total >= 0.0 else -1.0
    best: Any = lo
    for k in range(lo + 1, hi):
        if sign * x[k] > sign * x[best]:
            best = k
    height = sign * x[best]
    margin = max(noise, 1e-9 * height)
    fault, tops, previous, weights, moment = 0, 0, -1, 0.0, 0.0
    for k in range(lo, hi):
        y = sign * x[k]
        if not y >= height - margin:
            continue
        if previous >= 0 and k - previous > 1 and t[k] - t[previous] > two_peaks * (end - start):
            fault = 2
        previous = k
        tops += 1
        weight = (y - height + margin) * 0.5 * (t[min(k + 1, len(t) - 1)] - t[k - 1])
        weights += weight
        moment += weight * t[k]
    if tops > 2:
        when, peak = moment / weights, height
    else:
        when, peak = _vertex(t, x, sign, best, kink)
    when = min(max(when, start), end)

    before, after, high = 0.0, 0.0, 0.0
    seen, value = start, 0.0
    squares, sine_dot, sine_norm, triangle_dot, triangle_norm = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(lo, hi + 1):
        now, y = (t[k], sign * x[k]) if k < hi else (end, 0.0)
        if now < when:
            before += 0.5 * (value + y) * (now - seen)
        elif seen > when:
            after += 0.5 * (value + y) * (now - seen)
        else:  # the peak lies between these two
            before += 0.5 * (value + peak) * (when - seen)
            after += 0.5 * (peak + y) * (now - when)
        share = (0.5 if y > 0.9 * height else 0.0) + (0.5 if value > 0.9 * height else 0.0)
        high += share * (now - seen)
        seen, value = now, y
    for k in range(lo, hi):  # the ends are zero, and so is what they add
        earlier = t[k - 1] if k > lo else start
        later = t[k + 1] if k < hi - 1 else end
        y, weight = sign * x[k], 0.5 * (later - earlier)
        phase = (t[k] - start) / (end - start)
        squares += weight * y * y
        shape, corner = math.sin(math.pi * phase), 1.0 - abs(2.0 * phase - 1.0)
        sine_dot += weight * y * shape
        sine_norm += weight * shape * shape
        triangle_dot += weight * y * corner
        triangle_norm += weight * corner * corner
    if high > flat_share * (end - start):
        fault = 3
    if fault == 0 and (before <= 0.0 or after <= 0.0):
        fault = 1
    sine = max(squares - sine_dot * sine_dot / sine_norm, 0.0)
    triangle = max(squares - triangle_dot * triangle_dot / triangle_norm, 0.0)
    return fault, when, sign * peak, before, after, n, sine, triangle


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def half_cycles(
    t: Any, x: Any, cuts: Any, noise: float, period: float, low: float, least: int, flat_share: float,
    two_peaks: float, kink: float, out: Any,
) -> None:  # fmt: skip
    """What ``half_cycle`` says of x between neighbouring ``cuts`` (m + 1,), into out (m, 8).

    One that is not a quarter to a whole ``period`` [s] long, or whose peak is below ``low``, has a fault of its own.
    """
    for i in range(len(cuts) - 1):
        start, end = cuts[i], cuts[i + 1]
        a = max(count_before(t, start) - MARGIN_SAMPLES, 0)
        b = min(count_before(t, end) + MARGIN_SAMPLES, len(t))
        fault, when, peak, before, after, n, sine, triangle = half_cycle(
            t[a:b], x[a:b], start, end, noise, least, flat_share, two_peaks, kink
        )
        if fault == 0 and not 0.25 * period <= end - start <= period:
            fault = 4
        elif fault == 0 and abs(peak) < low:
            fault = 5
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = fault, when, peak, before
        out[i, 4], out[i, 5], out[i, 6], out[i, 7] = after, n, sine, triangle


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _half_wave(t: Any, e: Any, sp: Any, start: float, end: float, phase: Any, shape: Any) -> tuple[Any, ...]:
    """IAE, misfits of sine and square, peak, longest step [s], span of sp; |e| at ``phase`` into ``shape`` (m,)."""
    n, T = len(t), end - start
    iae, longest, peak, seen, value = 0.0, 0.0, 0.0, start, 0.0
    j = 0
    for k in range(n + 1):
        now, x = (t[k], abs(e[k])) if k < n else (end, 0.0)
        step = now - seen
        iae += 0.5 * (value + x) * step
        longest, peak = max(longest, step), max(peak, x)
        while j < len(phase) and (start + T * phase[j] <= now or k == n):
            share = min((start + T * phase[j] - seen) / step, 1.0) if step > 0.0 else 0.0
            shape[j] = value + share * (x - value)
            j += 1
        seen, value = now, x
    a_sine, a_square = 0.5 * math.pi * iae / T, iae / T
    v_sine, v_square, low, high = 0.0, 0.0, sp[0], sp[0]
    for k in range(n):
        x = abs(e[k])
        v_sine += (x - a_sine * math.sin(math.pi * (t[k] - start) / T)) ** 2
        v_square += (x - a_square) ** 2
        low, high = min(low, sp[k]), max(high, sp[k])
    return iae, v_sine / n, v_square / n, peak, longest, high - low


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def level(t: Any, x: Any) -> Any:
    """Mean over the time of the polygon (t, x), (n,), n >= 2."""
    area = 0.0
    for k in range(1, len(t)):
        area += 0.5 * (x[k] + x[k - 1]) * (t[k] - t[k - 1])
    return area / (t[len(t) - 1] - t[0])


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def mean_abs(e: Any, memory: int, out: Any) -> None:
    """Mean of |e| up to each sample, of which it forgets those more than ``memory`` ago, into out (n,)."""
    mean = 0.0
    for k in range(len(e)):
        mean += (abs(e[k]) - mean) * (1.0 / min(k + 1, memory))  # the division need not wait for the mean
        out[k] = mean


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def half_waves(t: Any, e: Any, sp: Any, cuts: Any, phase: Any, out: Any, shapes: Any) -> None:
    """What ``_half_wave`` says between neighbouring ``cuts`` (m + 1,), and the samples inside, into out (m, 7)."""
    for i in range(len(cuts) - 1):
        a, b = count_before(t, cuts[i]), count_before(t, cuts[i + 1])
        out[i, 6] = b - a
        if b > a:
            iae, v_sine, v_square, peak, longest, span = _half_wave(
                t[a:b], e[a:b], sp[a:b], cuts[i], cuts[i + 1], phase, shapes[i]
            )
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = iae, v_sine, v_square, peak
            out[i, 4], out[i, 5] = longest, span
