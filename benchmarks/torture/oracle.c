/* A second simulator of stickslip's block diagrams, which shares nothing with the engine or its kernels.

   The equations are those of the blocks' docstrings.  Fixed-step Runge-Kutta 4; a step that ends beyond an event is
   shortened by bisection; samples, source breakpoints and what leaves the dead times end steps exactly.

   stdin:  t_end share n_rows rows...  n_blocks n_signals, then a line per block (see read_diagram)
   stdout: one row of all signals per time; "failed" if it gets nowhere.  ``share``: step as a share of the fastest
   time constant at work. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CONSTANT, STEP, RAMP, SINE, SQUARE, SUM, GAIN, LIMIT, FIRST, SECOND, INTEGRATOR, DEADTIME, PI_, PID_, SENSOR,
       STEM, MASSLESS, SAMPLED_PI, NOISE, SAMPLED_SENSOR, KANO, LOWEST, HIGHEST, ZONE, LOOKUP, QUANTISER, SWITCH, RELAY,
       RATES, RESET, HOLD, FILTER, VARIABLE, BIQUAD, FUNCTION };
#define MAXP 24
#define SAME 1e-9 /* instants closer than this are one [s] */
#define MOST_STEPS 60000000L

typedef struct {
    int kind, np, nu, in[8], out, nx, x, feeds, sampled, region;
    double p[MAXP], start[2], theta, before, dt, offset, fast;
    long taken;
    double mode, place, old_u;      /* stems: 0 stuck, +-1 sliding; massless: where it stands; switch, relay, reset:
                                       1 on; limited rate: 0 follows, +-1; quantiser: whence it came, and multiple */
    double u_s, last;               /* Kano: where OP stood when it stuck, and at the last sample */
    double memory, w;               /* sampled PI: z; sensor: lag; noise: coloured value */
    double past[4];                 /* biquad: its last two inputs and outputs; sensor: its last input */
    long long r[6];                 /* MRG32k3a */
    double *hist; long n_hist, room; /* records start, end, three values */
} Block;

static Block B[400];
static int NB, NS, NX, order[400];
static double s[400], X[400], t_left, t_begin; /* a step lies between t_begin and t_left */
static double *pending; static int *generation; static long n_pending, room_pending;

static double clip(double v, double low, double high) { return v < low ? low : v > high ? high : v; }

static const double *record_at(const Block *b, double t) { /* the last one with start + theta <= t, 0 if none */
    long low = 0, high = b->n_hist;
    while (low < high) {
        long mid = (low + high) / 2;
        if (b->hist[5 * mid] + b->theta <= t) low = mid + 1; else high = mid;
    }
    return low ? b->hist + 5 * (low - 1) : 0;
}

static double delayed(const Block *b, double t) {
    const double *h = record_at(b, t);
    if (!h) return b->before;
    double r = h[1] > h[0] ? (t - b->theta - h[0]) / (h[1] - h[0]) : 0.0;
    return h[2] * (1 - r) * (1 - 2 * r) + h[3] * 4 * r * (1 - r) + h[4] * r * (2 * r - 1);
}

static double input(const Block *b, int i, double t) { return b->theta > 0 ? delayed(b, t) : s[b->in[i]]; }

static double free_output(const Block *b, const double *x, double t) { /* before the limits */
    const double *p = b->p;
    double sp = s[b->in[0]], pv = s[b->in[1]];
    if (b->kind == PI_) return p[0] * p[5] * (sp - pv) + x[b->x];
    double Tf = p[6] / p[7]; /* K_p T_i low high T_t action T_d N b c */
    return p[0] * p[5] * (p[8] * sp - pv + p[6] / Tf * (p[9] * sp - pv - x[b->x + 1])) + x[b->x];
}

static int segment(const Block *b, double u) { /* points of a table at or below u; p: n extend x.. y.. */
    int k = 0;
    while (k < (int)b->p[0] && b->p[2 + k] <= u) k++;
    return k;
}

static int extreme(const Block *b) { /* which input is the lowest, or the highest */
    int best = 0;
    for (int i = 1; i < b->nu; i++)
        if (b->kind == LOWEST ? s[b->in[i]] < s[b->in[best]] : s[b->in[i]] > s[b->in[best]]) best = i;
    return best;
}

static double looked_up(const Block *b, double u) {
    int n = (int)b->p[0], k = segment(b, u) - 1;
    const double *x = b->p + 2, *y = x + n;
    if (b->p[1] == 0) { /* held beyond the ends */
        if (k < 0) return y[0];
        if (k >= n - 1) return y[n - 1];
    }
    k = k < 0 ? 0 : k > n - 2 ? n - 2 : k;
    return y[k] + (y[k + 1] - y[k]) * (u - x[k]) / (x[k + 1] - x[k]);
}

static double sensed(const Block *b, const double *x, double t) {
    const double *p = b->p; /* tau factor bias drift low high */
    return p[0] > 0 ? x[b->x] : p[1] * s[b->in[0]] + p[2] + p[3] * t;
}

static void signals(double t, const double *x) {
    if (t > t_left) t = t_left;
    for (int k = 0; k < NB; k++) {
        Block *b = &B[order[k]];
        const double *p = b->p;
        double y = 0, u = b->nu && !b->sampled ? input(b, 0, t) : 0;
        if (b->sampled) continue;
        switch (b->kind) {
        case CONSTANT: y = p[0]; break;
        case FUNCTION: /* mean amplitude omega bump centre width */
            y = p[0] + p[1] * sin(p[2] * t) + p[3] * exp(-(t - p[4]) * (t - p[4]) / (p[5] * p[5]));
            break;
        case STEP: y = t < p[2] ? p[0] : p[1]; break;
        case RAMP: y = p[0] + p[1] * (clip(t, p[2], p[3]) - p[2]); break;
        case SINE: y = t >= p[4] ? p[0] + p[1] * sin(2 * M_PI * (t - p[4]) / p[2] + p[3]) : p[0]; break;
        case SQUARE: /* mean amplitude period start duty */
            y = p[0];
            if (t >= p[3]) {
                double k0 = floor((t - p[3]) / p[2]);
                if (p[3] + (k0 + 1) * p[2] <= t) k0++;
                if (p[3] + k0 * p[2] > t) k0--;
                y += t < p[3] + k0 * p[2] + p[4] * p[2] ? p[1] : -p[1];
            }
            break;
        case SUM: y = p[0]; for (int i = 0; i < b->nu; i++) y += p[1 + i] * s[b->in[i]]; break;
        case GAIN: y = p[1] + p[0] * u; break;
        case LIMIT: y = clip(u, p[0], p[1]); break;
        case FIRST: case SECOND: case INTEGRATOR: case STEM: case RESET: y = x[b->x]; break;
        case DEADTIME: y = u; break;
        case PI_: case PID_: y = clip(free_output(b, x, t), p[2], p[3]); break;
        case SENSOR: y = clip(sensed(b, x, t), p[4], p[5]); break;
        case MASSLESS: /* S J low high */
            y = b->mode == 0 ? b->place : clip(u - b->mode * 0.5 * (p[0] - p[1]), p[2], p[3]); break;
        case LOWEST: case HIGHEST: y = s[b->in[extreme(b)]]; break;
        case ZONE: y = u - clip(u, p[0], p[1]); break;
        case LOOKUP: y = looked_up(b, u); break;
        case QUANTISER: y = p[0] * b->place; break;
        case SWITCH: y = b->mode ? s[b->in[1]] : s[b->in[2]]; break;
        case RELAY: y = b->mode ? p[2] : p[3]; break;
        case RATES: y = b->mode ? x[b->x] : u; break;
        }
        s[b->out] = y;
    }
}

static void rates(double t, const double *x, double *f) {
    signals(t, x);
    if (t > t_left) t = t_left;
    for (int k = 0; k < NB; k++) {
        Block *b = &B[k];
        const double *p = b->p, *v = x + b->x;
        double *g = f + b->x, u = b->nu && b->nx ? input(b, 0, t) : 0, track;
        switch (b->kind) {
        case FIRST: g[0] = (p[0] * u - v[0]) / p[1]; break;
        case SECOND: g[0] = v[1]; g[1] = p[1] * p[1] * (p[0] * u - v[0]) - 2 * p[2] * p[1] * v[1]; break;
        case INTEGRATOR: g[0] = p[0] / p[1] * (u - p[2]); break;
        case SENSOR: if (b->nx) g[0] = p[0] > 0 ? (p[1] * u + p[2] + p[3] * t - v[0]) / p[0] : 0; break;
        case PI_: case PID_:
            track = p[4] > 0 ? p[4] : b->kind == PI_ ? p[1] : sqrt(p[1] * p[6]);
            g[0] = p[0] * p[5] * (s[b->in[0]] - s[b->in[1]]) / p[1] + (s[b->out] - free_output(b, x, t)) / track;
            if (b->kind == PID_) g[1] = (p[9] * s[b->in[0]] - s[b->in[1]] - v[1]) / (p[6] / p[7]);
            break;
        case RATES: g[0] = b->mode > 0 ? p[0] : b->mode < 0 ? -p[1] : 0; break;
        case RESET: g[0] = p[0] * u; break;
        case STEM: /* k M F_v F_c F_s low high v_stop */
            g[0] = g[1] = 0;
            if (b->mode != 0) { g[0] = v[1]; g[1] = (p[0] * (u - v[0]) - p[3] * b->mode - p[2] * v[1]) / p[1]; }
            break;
        }
    }
}

static void rk4(double t, double h, const double *x, double *y) {
    static double k1[400], k2[400], k3[400], k4[400], z[400];
    rates(t, x, k1);
    for (int i = 0; i < NX; i++) z[i] = x[i] + 0.5 * h * k1[i];
    rates(t + 0.5 * h, z, k2);
    for (int i = 0; i < NX; i++) z[i] = x[i] + 0.5 * h * k2[i];
    rates(t + 0.5 * h, z, k3);
    for (int i = 0; i < NX; i++) z[i] = x[i] + h * k3[i];
    rates(t + h, z, k4);
    for (int i = 0; i < NX; i++) y[i] = x[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
}

static double u_rate(const Block *b, double t, const double *x) { /* d(input)/dt, from the left */
    static double f[400], z[400];
    double d = fmin(1e-6, 0.5 * (t - t_begin)), now, then;
    if (d < 3e-7) return 0; /* shorter, rounding would decide */
    rates(t, x, f);
    for (int i = 0; i < NX; i++) z[i] = x[i] - d * f[i];
    now = s[b->in[0]];
    signals(t - d, z);
    then = s[b->in[0]];
    signals(t, x);
    return (now - then) / d;
}

static int region_of(const Block *b, double t, const double *x) {
    double v, low, high;
    if (b->kind == LOWEST || b->kind == HIGHEST) return extreme(b);
    if (b->kind == LOOKUP) return segment(b, s[b->in[0]]);
    if (b->kind == LIMIT || b->kind == ZONE) { v = s[b->in[0]]; low = b->p[0]; high = b->p[1]; }
    else if (b->kind == PI_ || b->kind == PID_) { v = free_output(b, x, t); low = b->p[2]; high = b->p[3]; }
    else if (b->kind == SENSOR) { v = sensed(b, x, t); low = b->p[4]; high = b->p[5]; }
    else return 0;
    return v > high ? 1 : v < low ? -1 : 0;
}

/* what a block would do at (t, x), whose signals are computed: 0 nothing; stems: 1 break away, 2 stick, 3 stop; limited
   rate: 1 let go, 2 meet; quantiser: 1 up, 2 down; others: 1 change over */
static int wish(const Block *b, double t, const double *x, int reversals) {
    const double *p = b->p;
    double u = s[b->in[0]];
    if (b->kind == STEM) {
        double at = x[b->x], v = x[b->x + 1], spring = p[0] * (u - at);
        double even = p[3] + fmax(1e-6 * p[3], 1e-9 * p[0]); /* with F_s = F_c a stem rests exactly at breakaway */
        if (b->mode == 0) return fabs(spring) > fmax(p[4], even) && (spring > 0 ? at < p[6] : at > p[5]) ? 1 : 0;
        if (b->mode > 0 ? at > p[6] : at < p[5]) return 3;
        double forward = b->mode * v;
        double slack = p[2] > 0 ? fmin(0.5 * p[0] * p[1] / p[2], 0.5 * p[2]) : 0; /* comes to rest, follows no OP */
        int braking = b->mode * spring < p[3] + (p[2] - slack) * forward;
        return forward < (braking ? p[7] : 0) ? 2 : 0;
    }
    if (b->kind == MASSLESS) {
        double pull = u - b->place;
        if (b->mode == 0)
            return fabs(pull) > 0.5 * (p[0] + p[1]) + 1e-12 && (pull > 0 ? b->place < p[3] : b->place > p[2]) ? 1 : 0;
        double stem = u - b->mode * 0.5 * (p[0] - p[1]);
        double high = stem - p[3], low = p[2] - stem; /* beyond the stop behind it a stem can only have been started */
        if (b->mode > 0 ? high > 0 || low > 1e-9 : low > 0 || high > 1e-9) return 3;
        if (reversals && b->mode * u_rate(b, t, x) < -1e-9) return 2;
    }
    if (b->kind == SWITCH || b->kind == RELAY) return b->mode ? u < p[1] : u > p[0];
    if (b->kind == RESET) return b->mode ? s[b->in[1]] < p[1] : s[b->in[1]] > p[1];
    if (b->kind == QUANTISER) {
        double above = u - p[0] * b->place, tie = 1e-12 * (p[0] + fabs(u));
        if (above > 0.5 * p[0] + (b->mode < 0 ? 0.01 * p[0] : tie)) return 1;
        if (-above > 0.5 * p[0] + (b->mode > 0 ? 0.01 * p[0] : tie)) return 2;
    }
    if (b->kind == RATES) { /* up down */
        if (b->mode) return b->mode * (x[b->x] - u) > 0 ? 2 : 0;
        if (reversals) {
            double rate = u_rate(b, t, x);
            return rate > p[0] * (1 + 1e-6) || rate < -p[1] * (1 + 1e-6);
        }
    }
    return 0;
}

static int anything(double t, const double *x) { /* has a step to here passed an event or a kink? */
    signals(t, x);
    for (int k = 0; k < NB; k++)
        if (region_of(&B[k], t, x) != B[k].region || wish(&B[k], t, x, 1)) return 1;
    return 0;
}

static void act(Block *b, int what, double t, double *x) { /* let a block do what it would */
    const double *p = b->p;
    double u = s[b->in[0]];
    switch (b->kind) {
    case STEM:
        if (what == 3) x[b->x] = b->mode > 0 ? p[6] : p[5];
        else if (what == 2 && b->mode * p[0] * (u - x[b->x]) > p[3]) /* it would creep on, to where forces balance */
            x[b->x] = clip(u - b->mode * p[3] / p[0], p[5], p[6]);
        b->mode = what == 1 ? (u > x[b->x] ? 1 : -1) : 0;
        x[b->x + 1] = 0;
        break;
    case MASSLESS:
        if (what == 1) b->mode = u > b->place ? 1 : -1;
        else { b->place = clip(u - b->mode * 0.5 * (p[0] - p[1]), p[2], p[3]); b->mode = 0; }
        break;
    case QUANTISER: b->place = floor(u / p[0] + 0.5); b->mode = what == 1 ? 1 : -1; break;
    case RATES:
        if (what == 1) { b->mode = u_rate(b, t, x) > 0 ? 1 : -1; x[b->x] = u; }
        else {
            double gap = u - x[b->x];
            b->mode = gap > 1e-9 ? 1 : gap < -1e-9 ? -1 : 0;
        }
        break;
    case RESET: if (!b->mode) x[b->x] = p[2]; /* fall through */
    default: b->mode = !b->mode;
    }
}

static int transitions(double t, double *x, int reversals) { /* all that blocks do now; how many did anything */
    int done = 0;
    for (int k = 0; k < NB; k++) {
        int what = wish(&B[k], t, x, reversals);
        if (what) { act(&B[k], what, t, x); done++; }
    }
    return done;
}

/* L'Ecuyer's MRG32k3a in whole numbers */
static double uniform(Block *b) {
    const long long m1 = 4294967087LL, m2 = 4294944443LL;
    long long *r = b->r;
    long long p1 = (1403580LL * r[1] - 810728LL * r[0]) % m1, p2 = (527612LL * r[5] - 1370589LL * r[3]) % m2;
    if (p1 < 0) p1 += m1;
    if (p2 < 0) p2 += m2;
    r[0] = r[1]; r[1] = r[2]; r[2] = p1; r[3] = r[4]; r[4] = r[5]; r[5] = p2;
    return (double)(p1 > p2 ? p1 - p2 : p1 - p2 + m1) / (double)(m1 + 1);
}

static double noise(Block *b, double correlation_time) {
    double a = correlation_time > 0 ? exp(-b->dt / correlation_time) : 0;
    double u1 = uniform(b), u2 = uniform(b);
    b->w = a * b->w + sqrt(1 - a * a) * sqrt(-2 * log(u1)) * cos(2 * M_PI * u2);
    return b->w;
}

/* Kano: MV = OP - dir (S - J)/2 on the move; stuck at u_s once OP stops or turns; off again beyond S against dir or J
   along it; before its first move beyond (S + J)/2; an end of the span is a stop at which it stands pushed.
   mode 0: stuck before the first move, +-1 stuck, +-2 on the move */
static double kano(Block *b, double op) {
    const double *p = b->p; /* S J low high */
    double half = 0.5 * (p[0] - p[1]), dir = b->mode > 0 ? 1 : b->mode < 0 ? -1 : 0;
    if (op >= p[3] || op <= p[2]) {
        dir = op >= p[3] ? 1 : -1;
        b->place = op >= p[3] ? p[3] : p[2];
        b->mode = dir;
        b->u_s = b->last = b->place + dir * half;
        return b->place;
    }
    if (fabs(b->mode) == 2 && dir * (op - b->last) <= 0) { b->mode = dir; b->u_s = b->last; }
    if (fabs(b->mode) == 1) {
        double along = dir * (op - b->u_s);
        if (along > p[1]) b->mode = 2 * dir;
        else if (-along > p[0]) b->mode = -2 * dir;
    } else if (b->mode == 0 && fabs(op - b->u_s) > 0.5 * (p[0] + p[1])) b->mode = op > b->u_s ? 2 : -2;
    if (fabs(b->mode) == 2) b->place = op - (b->mode > 0 ? half : -half);
    b->last = op;
    return b->place;
}

static void sample(Block *b, double t) {
    const double *p = b->p;
    if (b->kind == HOLD) { s[b->out] = s[b->in[0]]; return; }
    if (b->kind == FILTER) {
        b->memory += (p[0] > 0 ? 1 - exp(-b->dt / p[0]) : 1) * (s[b->in[0]] - b->memory);
        s[b->out] = b->memory;
        return;
    }
    if (b->kind == BIQUAD) { /* b_0 b_1 b_2 a_1 a_2 */
        double u = s[b->in[0]], *h = b->past, y = p[0] * u + p[1] * h[0] + p[2] * h[1] - p[3] * h[2] - p[4] * h[3];
        h[1] = h[0]; h[0] = u; h[3] = h[2]; h[2] = y;
        s[b->out] = y;
        return;
    }
    if (b->kind == VARIABLE) { /* longest, value before the start; lines between the samples */
        if (b->n_hist == b->room) b->hist = realloc(b->hist, (b->room = 2 * b->room + 1024) * sizeof(double));
        b->hist[b->n_hist++] = s[b->in[0]];
        double age = clip(s[b->in[1]], 0, p[0]) / b->dt;
        long i = b->n_hist - 1 - (long)age;
        double newer = i >= 0 ? b->hist[i] : p[1], older = i >= 1 ? b->hist[i - 1] : p[1];
        s[b->out] = newer + (age - (long)age) * (older - newer);
        return;
    }
    if (b->kind == KANO) { s[b->out] = kano(b, s[b->in[0]]); return; }
    if (b->kind == SAMPLED_PI) { /* K_p T_i low high T_t action, then 1 for back-calculation, 2 for conditional */
        double e = p[5] * (s[b->in[0]] - s[b->in[1]]), v = p[0] * e + b->memory, op = clip(v, p[2], p[3]);
        int held = p[6] == 2 && ((v >= p[3] && e > 0) || (v <= p[2] && e < 0));
        double tt = p[4] > 0 ? p[4] : p[1];
        if (!held) b->memory += b->dt * p[0] * e / p[1];
        if (p[6] == 1) b->memory += fmin(b->dt / tt, 1) * (op - v);
        s[b->out] = op;
    } else if (b->kind == NOISE) s[b->out] = p[0] + p[1] * noise(b, p[2]); /* mean sd correlation_time */
    else { /* tau factor bias drift low high sd correlation_time step */
        double target = p[1] * s[b->in[0]] + p[2] + p[3] * t;
        double behind = p[0] * (target - b->past[0]) / b->dt; /* in the end, on a straight line */
        b->memory = target - behind
                  + (p[0] > 0 ? exp(-b->dt / p[0]) : 0) * (b->memory - b->past[0] + behind);
        b->past[0] = target;
        double v = b->memory + p[6] * noise(b, p[7]);
        if (p[8] > 0) v = floor(v / p[8] + 0.5) * p[8];
        s[b->out] = clip(v, p[4], p[5]);
    }
}

static void note(double t, int g) { /* what happens at t leaves every dead time later */
    if (g >= 4) return;
    for (int k = 0; k < NB; k++) {
        if (B[k].theta <= 0) continue;
        double at = t + B[k].theta;
        long i = n_pending;
        while (i > 0 && pending[i - 1] > at) i--;
        if (i > 0 && pending[i - 1] == at) continue; /* only the very same: what is left out is stepped over */
        if (n_pending == room_pending) {
            room_pending = 2 * room_pending + 64;
            pending = realloc(pending, room_pending * sizeof *pending);
            generation = realloc(generation, room_pending * sizeof *generation);
        }
        memmove(pending + i + 1, pending + i, (n_pending - i) * sizeof *pending);
        memmove(generation + i + 1, generation + i, (n_pending - i) * sizeof *generation);
        pending[i] = at; generation[i] = g + 1; n_pending++;
    }
}

static double source_break(const Block *b, double t) {
    const double *p = b->p;
    if (b->kind == STEP) return t < p[2] ? p[2] : INFINITY;
    if (b->kind == RAMP) return t < p[2] ? p[2] : t < p[3] ? p[3] : INFINITY;
    if (b->kind == SINE) return t < p[4] ? p[4] : INFINITY;
    if (b->kind == SQUARE) {
        if (t < p[3]) return p[3];
        double k0 = floor((t - p[3]) / p[2]);
        if (p[3] + (k0 + 1) * p[2] <= t) k0++;
        double fall = p[3] + k0 * p[2] + p[4] * p[2];
        return t < fall ? fall : p[3] + (k0 + 1) * p[2];
    }
    return INFINITY;
}

static void feel_jump(Block *b) { /* its input has jumped from old_u to what it is now */
    double now = s[b->in[0]], jump = now - b->old_u;
    if (fabs(jump) > 1e-11 * (1 + fabs(b->old_u))) {
        if (b->kind == MASSLESS && b->mode * jump < 0) { /* back: the stem stops where it was */
            b->place = clip(b->old_u - b->mode * 0.5 * (b->p[0] - b->p[1]), b->p[2], b->p[3]);
            b->mode = 0;
        }
        if (b->kind == RATES && b->mode == 0) { /* a limited rate is left behind */
            X[b->x] = b->old_u;
            b->mode = jump > 0 ? 1 : -1;
        }
    }
}

static int decides_now(const Block *b) { return b->feeds || b->sampled || b->kind == RELAY || b->kind == RESET; }

static int settle(double t, int first) { /* a block acts once all have that decide now what it reads: it feels a jump of
       its input (but at the first instant, before which there was nothing), finds its mode, takes its sample */
    int driver[400], done[400] = {0}, left = NB;
    t_left = INFINITY;
    for (int k = 0; k < NB; k++) driver[B[k].out] = k;
    signals(t, X);
    while (left) {
        int before = left;
        for (int k = 0; k < NB; k++) {
            Block *b = &B[k];
            int ready = !done[k], chain = 0, what = 1;
            for (int i = 0; i < b->nu; i++) ready &= done[driver[b->in[i]]] || !decides_now(&B[driver[b->in[i]]]);
            if (!ready) continue;
            if (!first && b->nu) { feel_jump(b); signals(t, X); }
            for (; what && chain < 50; chain++)
                if ((what = wish(b, t, X, 0))) { act(b, what, t, X); signals(t, X); }
            if (what) return 0;
            if (b->sampled && b->offset + b->taken * b->dt <= t + SAME) {
                sample(b, t);
                signals(t, X);
                b->taken++;
                note(t, 0); /* a breakpoint less than SAME before the scan may have brought us here */
            }
            done[k] = 1;
            left--;
        }
        if (left == before) return 0; /* a ring: not for this program */
    }
    for (int k = 0; k < NB; k++) B[k].old_u = B[k].nu ? s[B[k].in[0]] : 0;
    for (int k = 0; k < NB; k++) B[k].region = region_of(&B[k], t, X);
    return 1;
}

static int read_diagram(void) {
    if (scanf("%d %d", &NB, &NS) != 2) return 0;
    for (int k = 0; k < NB; k++) { /* kind np p.. nu in.. out nx x0.. theta before sampled dt offset feeds place w r.. */
        Block *b = &B[k];
        int ok = scanf("%d %d", &b->kind, &b->np) == 2;
        for (int i = 0; i < b->np; i++) ok &= scanf("%lf", &b->p[i]) == 1;
        ok &= scanf("%d", &b->nu) == 1;
        for (int i = 0; i < b->nu; i++) ok &= scanf("%d", &b->in[i]) == 1;
        ok &= scanf("%d %d", &b->out, &b->nx) == 2;
        b->x = NX;
        for (int i = 0; i < b->nx; i++) ok &= scanf("%lf", &X[NX++]) == 1;
        ok &= scanf("%lf %lf %d %lf %lf %d", &b->theta, &b->before, &b->sampled, &b->dt, &b->offset, &b->feeds) == 6;
        ok &= scanf("%lf %lf %lf", &b->place, &b->w, &s[b->out]) == 3;
        b->memory = b->u_s = b->last = b->place;
        if (b->kind == RATES || b->kind == RELAY || b->kind == SWITCH || b->kind == RESET) b->mode = b->place;
        if (b->kind == MASSLESS) b->mode = b->w;
        b->past[0] = b->past[1] = b->place;
        b->past[2] = b->past[3] = s[b->out];
        for (int i = 0; i < 6; i++) ok &= scanf("%lld", &b->r[i]) == 1;
        ok &= scanf("%lf", &b->fast) == 1;
        if (!ok) return 0;
    }
    int driver[400], done[400] = {0}, n = 0;
    for (int k = 0; k < NB; k++) driver[B[k].out] = k;
    while (n < NB) {
        int before = n;
        for (int k = 0; k < NB; k++) {
            int ready = !done[k];
            for (int i = 0; B[k].feeds && i < B[k].nu; i++) ready &= done[driver[B[k].in[i]]];
            if (ready) { done[k] = 1; order[n++] = k; }
        }
        if (n == before) return 0;
    }
    return 1;
}

static void remember(double t, double h, const double *x0, const double *x1) {
    static double f0[400], f1[400], middle[400], at[3][400];
    int any = 0;
    for (int k = 0; k < NB; k++) any |= B[k].theta > 0;
    if (!any) return;
    rates(t, x0, f0); memcpy(at[0], s, sizeof at[0]);
    rates(t + h, x1, f1); memcpy(at[2], s, sizeof at[2]);
    for (int i = 0; i < NX; i++) middle[i] = 0.5 * (x0[i] + x1[i]) + h / 8 * (f0[i] - f1[i]);
    signals(t + 0.5 * h, middle); memcpy(at[1], s, sizeof at[1]);
    for (int k = 0; k < NB; k++) {
        Block *b = &B[k];
        if (b->theta <= 0) continue;
        if (b->n_hist == b->room) b->hist = realloc(b->hist, 5 * (b->room = 2 * b->room + 1024) * sizeof(double));
        double *r = b->hist + 5 * b->n_hist++;
        r[0] = t; r[1] = t + h;
        for (int m = 0; m < 3; m++) r[2 + m] = at[m][b->in[0]];
    }
}

int main(void) {
    double t_end, share, t = 0;
    long rows, row = 0, steps = 0;
    static double x1[400], f0[400], f1[400], z[400];
    if (scanf("%lf %lf %ld", &t_end, &share, &rows) != 3) return 2;
    double *grid = malloc(rows * sizeof *grid);
    for (long i = 0; i < rows; i++) if (scanf("%lf", &grid[i]) != 1) return 2;
    if (!read_diagram()) return 2;
    note(0, 0);
    for (int first = 1;; first = 0) {
        if (!settle(t, first)) { puts("failed"); return 1; }
        while (row < rows && grid[row] <= t) {
            for (int i = 0; i < NS; i++) printf("%.17g ", s[i]);
            puts(""); row++;
        }
        if (t >= t_end) return 0;
        double stop = t_end; int g = 9;
        for (int k = 0; k < NB; k++) {
            double due = B[k].sampled ? B[k].offset + B[k].taken * B[k].dt : source_break(&B[k], t);
            if (due <= stop) { stop = due; g = 0; }
        }
        while (n_pending && pending[0] <= t) {
            n_pending--;
            memmove(pending, pending + 1, n_pending * sizeof *pending);
            memmove(generation, generation + 1, n_pending * sizeof *generation);
        }
        if (n_pending && pending[0] < stop) { stop = pending[0]; g = generation[0]; }
        t_left = nextafter(stop, -INFINITY);
        int event = 0;
        while (!event && t < stop) {
            double fast = INFINITY, theta = INFINITY, fastest = INFINITY;
            for (int k = 0; k < NB; k++) {
                if (B[k].fast > 0) fastest = fmin(fastest, B[k].fast);
                if (B[k].fast > 0 && !(B[k].kind == STEM && B[k].mode == 0)) fast = fmin(fast, B[k].fast);
                if (B[k].theta > 0) theta = fmin(theta, B[k].theta);
            }
            double h = share * fmin(fmin(fast, 1.0), 3.0 * theta);
            for (int k = 0; k < NB; k++) { /* what moved fast when it entered a dead time does so when it leaves it */
                const double *r = B[k].theta > 0 ? record_at(&B[k], t) : 0;
                if (r && r[1] - r[0] < h) h = fmax(r[1] - r[0], fmin(h, share * fastest));
            }
            if (t + 1.01 * h >= stop) h = stop - t;
            t_begin = t;
            if (++steps > MOST_STEPS) { puts("failed"); return 1; }
            rk4(t, h, X, x1);
            if (anything(t + h, x1)) {
                double low = 0, high = h;
                for (int i = 0; i < 60 && high - low > 1e-14 * (1 + t); i++) {
                    double mid = 0.5 * (low + high);
                    rk4(t, mid, X, x1);
                    if (anything(t + mid, x1)) high = mid; else low = mid;
                }
                rk4(t, high, X, x1);
                if (h != high && high > 1e-13 * (1 + t)) { h = high; event = 1; }
                else { rk4(t, h, X, x1); event = 1; }
            }
            rates(t, X, f0); rates(t + h, x1, f1);
            while (row < rows && grid[row] < (h == stop - t ? stop : t + h)) {
                double r = (grid[row] - t) / h, a = (1 + 2 * r) * (1 - r) * (1 - r), b = r * (1 - r) * (1 - r);
                double c = r * r * (3 - 2 * r), d = -r * r * (1 - r);
                for (int i = 0; i < NX; i++) z[i] = a * X[i] + b * h * f0[i] + c * x1[i] + d * h * f1[i];
                signals(grid[row], z);
                for (int i = 0; i < NS; i++) printf("%.17g ", s[i]);
                puts(""); row++;
            }
            remember(t, h, X, x1);
            t = h == stop - t ? stop : t + h;
            memcpy(X, x1, sizeof X);
            signals(t, X);
            for (int k = 0; k < NB; k++) B[k].old_u = B[k].nu ? s[B[k].in[0]] : 0;
            if (event) { transitions(t, X, 1); note(t, 0); }
        }
        if (t >= stop && g < 9) note(t, g);
    }
}
