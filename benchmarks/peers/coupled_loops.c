/* Coupled PI loops with dead times, by hand: fixed-step RK4, what is under way read from a ring by cubic Hermite.
 *
 *   e_i = SP_i (t >= 1 s) - y_i,   v_i = Kp_i e_i + z_i,   z_i' = Kp_i/Ti_i e_i
 *   u_i = v_i + a y_(i+1) + b y_(i+2),   tau_i y_i' = u_i(t - theta_i) - y_i      (i modulo n, u = 0 before 0)
 *
 * Value and slope of u at each step make its history. Jumps that leave a dead time within a step are not located.
 */
#include <math.h>
#include <stdlib.h>

enum { FIELDS = 5, MOST = 64 }; /* SP, Kp, Ti, tau, theta per loop: order known to c_coupled.py */

typedef struct {
    int n;
    double a, b, h;
    const double *p;
    double *u, *du; /* history: step k, loop i at k * n + i */
} Loops;

static void inputs(const Loops *l, double t, const double *y, double *u)
{
    for (int i = 0; i < l->n; i++) {
        const double *p = l->p + FIELDS * i;
        double e = (t >= 1.0 - 1e-9 ? p[0] : 0.0) - y[i];
        u[i] = p[1] * e + y[l->n + i] + l->a * y[(i + 1) % l->n] + l->b * y[(i + 2) % l->n];
    }
}

static double late(const Loops *l, int i, double t)
{
    double s = (t - l->p[FIELDS * i + 4]) / l->h;
    if (s < 0.0)
        return 0.0;
    long k = (long)s;
    s -= (double)k;
    const double *u = l->u + k * l->n + i, *du = l->du + k * l->n + i;
    double r = 1.0 - s, v0 = u[0], v1 = u[l->n], d0 = l->h * du[0], d1 = l->h * du[l->n];
    return r * r * ((1.0 + 2.0 * s) * v0 + s * d0) + s * s * ((1.0 + 2.0 * r) * v1 - r * d1);
}

static void slopes(const Loops *l, double t, const double *y, double *f)
{
    for (int i = 0; i < l->n; i++) {
        const double *p = l->p + FIELDS * i;
        double e = (t >= 1.0 - 1e-9 ? p[0] : 0.0) - y[i];
        f[i] = (late(l, i, t) - y[i]) / p[3];
        f[l->n + i] = p[1] / p[2] * e;
    }
}

/* One row of y per log interval of `per_row` steps; returns 0, or 1 without memory or with too many loops. */
int coupled_loops(int n, double a, double b, const double *p, double h, int per_row, int rows, double *log)
{
    long steps = (long)per_row * (rows - 1);
    double *u = malloc(sizeof(double) * (size_t)((steps + 1) * n));
    double *du = malloc(sizeof(double) * (size_t)((steps + 1) * n));
    if (n > MOST || !u || !du) {
        free(u), free(du);
        return 1;
    }
    Loops l = {n, a, b, h, p, u, du};
    double y[2 * MOST] = {0.0}, x[2 * MOST], k1[2 * MOST], k2[2 * MOST], k3[2 * MOST], k4[2 * MOST];
    for (long k = 0;; k++) {
        double t = (double)k * h;
        inputs(&l, t, y, u + k * n);
        slopes(&l, t, y, k1);
        for (int i = 0; i < n; i++)
            du[k * n + i] =
                -p[FIELDS * i + 1] * k1[i] + k1[n + i] + a * k1[(i + 1) % n] + b * k1[(i + 2) % n];
        if (k % per_row == 0)
            for (int i = 0; i < n; i++)
                log[k / per_row * n + i] = y[i];
        if (k == steps)
            break;
        for (int i = 0; i < 2 * n; i++)
            x[i] = y[i] + 0.5 * h * k1[i];
        slopes(&l, t + 0.5 * h, x, k2);
        for (int i = 0; i < 2 * n; i++)
            x[i] = y[i] + 0.5 * h * k2[i];
        slopes(&l, t + 0.5 * h, x, k3);
        for (int i = 0; i < 2 * n; i++)
            x[i] = y[i] + h * k3[i];
        slopes(&l, t + h, x, k4);
        for (int i = 0; i < 2 * n; i++)
            y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    }
    free(u), free(du);
    return 0;
}
