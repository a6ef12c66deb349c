/* The ideal loop with a sticking stem, by hand: fixed-step RK4 in each mode, events bisected.
 *
 *   e = SP - y,  OP = Kp e + z,  z' = Kp/Ti e,  y' = (K x - y)/tau
 *   stuck: x' = 0 while |k (OP - x)| <= Fs;   slip: M v' = k (OP - x) - s Fc - Fv v until v returns to 0
 *
 * One row (t, SP, PV, OP, MV, v) per log interval into the caller's buffer. A step is cut short where it would
 * pass a log time, so rows are integrated values, not interpolated ones. No allocation, no global state.
 */
#include <math.h>

enum { COLUMNS = 6, HALVINGS = 40 };

typedef struct {
    double K, tau, Kp, Ti, M, k, Fv, Fc, Fs, SP; /* order known to c_loop.py */
} Loop;

typedef struct {
    double y, z, x, v;
} State;

typedef struct {
    double y, z, v;
} Slope; /* x' is v */

/* Coefficients divided out once. */
typedef struct {
    double a, b, Kp, Ki, SP, k_M, Fv_M, Fc_M, fs;
} Rates;

static inline double output(const Rates *r, double y, double z) { return r->Kp * (r->SP - y) + z; }

static inline Slope slope(const Rates *r, State w, double coulomb)
{
    Slope d;
    d.y = r->b * w.x - r->a * w.y;
    d.z = r->Ki * (r->SP - w.y);
    d.v = r->k_M * (output(r, w.y, w.z) - w.x) - r->Fv_M * w.v - coulomb;
    return d;
}

static inline State moved(State w, Slope d, double v, double h)
{
    State n = {w.y + h * d.y, w.z + h * d.z, w.x + h * v, w.v + h * d.v};
    return n;
}

static inline State slip_step(const Rates *r, State w, double coulomb, double h)
{
    Slope d1 = slope(r, w, coulomb);
    State w2 = moved(w, d1, w.v, 0.5 * h);
    Slope d2 = slope(r, w2, coulomb);
    State w3 = moved(w, d2, w2.v, 0.5 * h);
    Slope d3 = slope(r, w3, coulomb);
    State w4 = moved(w, d3, w3.v, h);
    Slope d4 = slope(r, w4, coulomb);
    double c = h / 6.0;
    State n = {w.y + c * (d1.y + 2.0 * (d2.y + d3.y) + d4.y),
               w.z + c * (d1.z + 2.0 * (d2.z + d3.z) + d4.z),
               w.x + c * (w.v + 2.0 * (w2.v + w3.v) + w4.v),
               w.v + c * (d1.v + 2.0 * (d2.v + d3.v) + d4.v)};
    return n;
}

/* RK4 with x constant; y does not depend on z, so z needs the four values of y only. */
static inline State stuck_step(const Rates *r, State w, double h)
{
    double drive = r->b * w.x;
    double k1 = drive - r->a * w.y;
    double y2 = w.y + 0.5 * h * k1;
    double k2 = drive - r->a * y2;
    double y3 = w.y + 0.5 * h * k2;
    double k3 = drive - r->a * y3;
    double y4 = w.y + h * k3;
    double k4 = drive - r->a * y4;
    double c = h / 6.0;
    State n = {w.y + c * (k1 + 2.0 * (k2 + k3) + k4),
               w.z + c * r->Ki * (6.0 * r->SP - (w.y + 2.0 * (y2 + y3) + y4)), w.x, 0.0};
    return n;
}

/* Offset from the mode's end: positive once the stem must slip (stuck) or has stopped (slip). */
static inline double over(const Rates *r, State w, int s)
{
    return s ? -s * w.v : fabs(output(r, w.y, w.z) - w.x) - r->fs;
}

static inline State step(const Rates *r, State w, int s, double h)
{
    return s ? slip_step(r, w, s * r->Fc_M, h) : stuck_step(r, w, h);
}

/* Returns the number of stick and slip events; rows must hold n_rows * 6 doubles. */
int ideal_loop(const Loop *p, int n_rows, double log_interval, double h_stuck, double h_slip, double *rows)
{
    const Rates r = {1.0 / p->tau, p->K / p->tau, p->Kp,        p->Kp / p->Ti, p->SP,
                     p->k / p->M,  p->Fv / p->M,  p->Fc / p->M, p->Fs / p->k};
    State w = {0.0, 0.0, 0.0, 0.0};
    int s = 0, events = 0; /* s: 0 stuck, else direction of slip */

    for (int i = 0;; i++) {
        double *row = rows + (long)COLUMNS * i;
        row[0] = i * log_interval;
        row[1] = r.SP;
        row[2] = w.y;
        row[3] = output(&r, w.y, w.z);
        row[4] = w.x;
        row[5] = w.v;
        if (i == n_rows - 1)
            return events;

        double left = log_interval;
        while (left > 0.0) {
            double h = s ? h_slip : h_stuck;
            if (left < h * (1.0 + 1e-9)) /* absorbs the rounding of left, which would cost a sliver step */
                h = left;
            State n = step(&r, w, s, h);
            if (over(&r, n, s) <= 0.0) {
                w = n;
                left -= h;
                continue;
            }
            double low = 0.0, high = h; /* the event lies in (low, high]; take high, just past it */
            for (int j = 0; j < HALVINGS; j++) {
                double middle = 0.5 * (low + high);
                State m = step(&r, w, s, middle);
                if (over(&r, m, s) > 0.0)
                    high = middle, n = m;
                else
                    low = middle;
            }
            w = n;
            left -= high;
            w.v = 0.0;
            s = s ? 0 : (output(&r, w.y, w.z) > w.x ? 1 : -1);
            events++;
        }
    }
}
