"""A bank of runs, for hypotheses that hide a mode: whether a stem sticks or slides, no row of a log shows.

Each particle has a mode of its own and, given that, a mean of its own; the gains of a filter that knows the mode are
those of all.  Between rows a particle has a second run, with noise drawn, which says what its mode does; the mean takes
the mode over, but not the noise, whose spread is in the gains already.  At a row

    e_j = (y - y_j) / sqrt(S)       log p = log sum_j w_j exp(-loss(e_j)) - log(S)/2        w_j <- w_j exp(-loss(e_j))

and the stretch before is run again with what the row says of the state and of the noise, so that the mode follows what
was logged.  Rounding is undone by a number drawn for each particle.  Particles of little weight leave for copies of
others.  At the start, and where they have missed a signal for long, none is known to have the right mode: every other
one is put anywhere within reach.  One that has slipped stands a little elsewhere than its law says.
Source: Rao-Blackwellised particle filter, Doucet, de Freitas, Murphy and Russell (UAI 2000); systematic resampling:
Kitagawa, J. Computational and Graphical Statistics 5 (1996), appendix.
"""

import math

import numpy as np
from stickslip.engine.filtering import BEHIND, huber
from stickslip.engine.restarts import arrive, begin, keep, pass_instant, put, read, restore, write
from stickslip.engine.slopes import arrived
from stickslip.logs.compiled import njit

ALONE = 0.5  # share of the particles that have to count, or they are drawn anew
MOVED = 0.1  # of the reach: a particle has slipped
REPEATS = math.sqrt(3.0) * 0.02  # of the reach, to both sides: no friction repeats to the last digit
LATELY, LOST = 0.1, 3.4  # share of a row in a running mean of squared innovations; that of one miss by 5 in it


@njit(cache=True, nogil=True, error_model="numpy")
def banked(  # type: ignore[no-untyped-def]
    I, W, buffer, kept, saved, places, shown, noisy, hidden, times, row_of, phi, sd, values, steps, gains, S, far, bar,
    sure, reach, z0, drawn, dither, shares, losses, e, stood, came,
):  # fmt: skip
    """Follow a bank of particles; write the ``losses`` of rows (rows,) [nats] and innovations ``e`` (rows, m).

    ``hidden`` (h,) where the hidden block keeps what it remembers; ``gains`` and ``S`` those of a filter that knows it
    (see ``extended``), whose variance of each row and signal is ``S``; ``steps`` (rows, m) of the log's rounding;
    ``far`` standard deviations beyond which a loss grows in proportion; ``bar`` and ``sure`` as ``extended`` has them;
    ``reach`` to both sides within which a particle that has lost its way is put;
    ``drawn`` (k, particles, q) standard normal numbers, ``dither`` (rows, particles, m) and ``shares`` (rows,) uniform
    ones.

    Written too are where the hidden block ``stood`` at each stop (k, particles), by the first state that is its own,
    and of which particle each ``came`` behind a row (rows, particles).  Returned is a status.
    """
    n, m, q, particles, h = places.shape[1], len(shown), len(noisy), drawn.shape[1], len(hidden)
    # a run of its own for each, so that nothing is copied between rows
    mean_I, mean_W = np.empty((particles, len(I)), dtype=np.int64), np.empty((particles, len(W)))
    noisy_I, noisy_W = np.empty((particles, len(I)), dtype=np.int64), np.empty((particles, len(W)))
    for j in range(particles):
        keep(I, W, mean_I[j], mean_W[j])
        keep(I, W, noisy_I[j], noisy_W[j])
    next_I, next_W = np.empty((particles, kept), dtype=np.int64), np.empty((particles, saved))
    z, ahead = np.empty((particles, n)), np.empty((particles, n))
    for j in range(particles):
        write(z0, z[j])
    y, back, aside = np.empty(m), np.empty(n + q), np.empty(n + q)
    kept_mode, theirs, theirs_at = np.empty(h), np.empty(n), np.empty(particles)
    weight, before, loss, off = np.zeros(particles), np.empty(particles), np.empty(particles), np.empty((particles, m))
    own = np.zeros(n, dtype=np.bool_)
    for i in range(n):
        for p in range(h):
            own[i] = own[i] or places[0, i] == hidden[p]
    first, sum_of_losses, missed, begins = np.argmax(own), 0.0, np.ones(m), True
    stands = np.full(particles, z0[first])
    for k in range(len(times)):
        row = row_of[k]
        for j in range(particles):
            if row < 0:
                there_I, there_W = noisy_I[j], noisy_W[j]
                status = arrive(there_I, there_W, buffer, times[k])
                if status != 0:
                    return status
                for i in range(q):
                    there_W[noisy[i]] = there_W[noisy[i]] * phi[k, i] + sd[k, i] * drawn[k, j, i]
                status = pass_instant(there_I, there_W, buffer)
                if status != 0:
                    return status
                read(there_W, places[1], theirs)
                for p in range(h):
                    kept_mode[p] = there_W[hidden[p]]
                here_I, here_W = mean_I[j], mean_W[j]
            else:  # it is run again from where it stands
                restore(I, W, mean_I[j, :kept], mean_W[j, :saved])
                here_I, here_W = I, W
            put(here_I, here_W, places[0], z[j])
            status = arrive(here_I, here_W, buffer, times[k])
            if status != 0:
                return status
            for i in range(q):
                here_W[noisy[i]] *= phi[k, i]
            status = pass_instant(here_I, here_W, buffer)
            if status != 0:
                return status
            read(here_W, places[1], ahead[j])
            if row < 0:
                stood[k, j] = theirs[first]
                for p in range(h):
                    here_W[hidden[p]] = kept_mode[p]
                for i in range(n):
                    if own[i]:
                        ahead[j, i] = theirs[i]
                write(ahead[j], z[j])
                put(here_I, here_W, places[0], z[j])
                continue
            read(W, shown, y)
            begin(z[j], back)
            for p in range(n + q):
                aside[p] = 0.0
            loss[j] = 0.0
            for i in range(m):
                if S[row, i] != S[row, i]:
                    off[j, i] = math.nan
                    continue
                off[j, i] = values[row, i] - y[i]
                loss[j] += huber(off[j, i] / math.sqrt(S[row, i]), far)
                by = (dither[row, j, i] - 0.5) * steps[row, i]
                for p in range(m):
                    y[p] += gains[row, n + p, i] * off[j, i]
                for p in range(n + q):
                    back[p] += gains[row, n + m + p, i] * off[j, i]
                    aside[p] += gains[row, n + m + p, i] * by
            for p in range(n + q):
                aside[p] += back[p]
            status = arrived(
                I, W, buffer, mean_I[j, :kept], mean_W[j, :saved], places, noisy, times[k], phi[k], aside[:n], aside[n:]
            )
            if status != 0:
                return status
            read(W, places[1], theirs)
            for p in range(h):
                kept_mode[p] = W[hidden[p]]
            status = arrived(
                I, W, buffer, mean_I[j, :kept], mean_W[j, :saved], places, noisy, times[k], phi[k], back[:n], back[n:]
            )
            if status != 0:
                return status
            read(W, places[1], z[j])
            theirs_at[j] = theirs[first]
            for p in range(h):
                W[hidden[p]] = kept_mode[p]
            if abs(theirs[first] - stands[j]) > MOVED * reach:
                theirs[first] += REPEATS * reach * (2.0 * dither[row, j, 0] - 1.0)
            stands[j] = theirs[first]
            for i in range(n):
                if own[i]:
                    z[j, i] = theirs[i]
            put(I, W, places[0], z[j])
            keep(I, W, next_I[j], next_W[j])
        if row < 0:
            continue
        top = -np.inf
        for j in range(particles):
            before[j] = math.exp(weight[j]) / particles
            weight[j] -= loss[j]
            top = max(top, weight[j])
        total = 0.0
        for j in range(particles):
            weight[j] = math.exp(weight[j] - top)
            total += weight[j]
        losses[row] = -(top + math.log(total / particles))
        squares = 0.0
        for j in range(particles):
            weight[j] /= total
            squares += weight[j] ** 2
        lost = False
        for i in range(m):
            if S[row, i] == S[row, i]:
                s = 0.0
                for j in range(particles):
                    s += before[j] * off[j, i]
                e[row, i] = s / math.sqrt(S[row, i])
                losses[row] += 0.5 * math.log(S[row, i])
                missed[i] += LATELY * (e[row, i] ** 2 - missed[i])
                lost = lost or missed[i] > LOST
        lost = (lost or begins) and reach > 0.0
        if lost:
            missed[:] = 1.0
        begins = False
        if len(bar) > 0 and bar[row] == bar[row]:
            sum_of_losses += losses[row]
            for i in range(m):
                if S[row, i] != S[row, i]:
                    sum_of_losses += sure[i]
            if sum_of_losses > bar[row]:
                return BEHIND
        anew = lost or 1.0 / squares < ALONE * particles
        j, reached = 0, weight[0]
        for p in range(particles):
            if anew:
                while reached < (p + shares[row]) / particles and j < particles - 1:
                    j += 1
                    reached += weight[j]
            else:
                j = p
            came[row, p], stood[k, p] = j, theirs_at[j]
            write(z[j], ahead[p])
            restore(mean_I[p], mean_W[p], next_I[j], next_W[j])
            restore(noisy_I[p], noisy_W[p], next_I[j], next_W[j])
        for p in range(particles):
            write(ahead[p], z[p])
            if lost and p % 2 == 1:
                z[p, first] += reach * (2.0 * (p + shares[row]) / particles - 1.0)
            stands[p] = z[p, first]
            weight[p] = 0.0 if anew else math.log(max(weight[p] * particles, 1e-300))
    return 0
