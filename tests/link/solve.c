/* Conjugate gradients on the linear law; K is applied as the difference of forces, so tractions and
 * the law itself are all that is known. */
#include "body.h"

typedef double vector[BODY_MOST][6];

static void put(struct body *b, const vector x)
{
    for (int i = 0; i < b->n; i++) {
        b->u[i] = p3((preal)x[i][0], (preal)x[i][1], (preal)x[i][2]);
        b->theta[i] = p3((preal)x[i][3], (preal)x[i][4], (preal)x[i][5]);
    }
}

/* Forces and torques for x, of free DOF. */
static void get(struct body *b, const vector x, const int (*free)[6], vector f)
{
    put(b, x);
    body_forces(b);
    for (int i = 0; i < b->n; i++) {
        const double y[6] = {(double)b->force[i].x, (double)b->force[i].y, (double)b->force[i].z,
            (double)b->torque[i].x, (double)b->torque[i].y, (double)b->torque[i].z};
        for (int c = 0; c < 6; c++) f[i][c] = free[i][c] ? y[c] : 0;
    }
}

/* The scale of a rotation DOF is h. */
static double product(const struct body *b, const vector x, const vector y)
{
    double sum = 0;
    for (int i = 0; i < b->n; i++)
        for (int c = 0; c < 6; c++) sum += (c < 3 ? 1 : 1 / (b->h * b->h)) * x[i][c] * y[i][c];
    return sum;
}

double body_solve(struct body *b, const double (*f)[6], const int (*free)[6], int rounds)
{
    static vector x, r, p, zero, f_0, f_p;
    double norm, rr;
    for (int i = 0; i < b->n; i++)
        for (int c = 0; c < 6; c++) x[i][c] = zero[i][c] = 0;
    get(b, zero, free, f_0);
    for (int i = 0; i < b->n; i++)
        for (int c = 0; c < 6; c++) r[i][c] = f_0[i][c] + (free[i][c] ? f[i][c] : 0);
    /* preconditioned by the scale of the rotations alone: M^-1 = (1, 1/h^2) */
    for (int i = 0; i < b->n; i++)
        for (int c = 0; c < 6; c++) p[i][c] = c < 3 ? r[i][c] : r[i][c] / (b->h * b->h);
    norm = rr = product(b, r, r);
    for (int round = 0; round < rounds && rr > 1e-30 * norm; round++) {
        double pKp = 0, step, next;
        get(b, p, free, f_p);
        for (int i = 0; i < b->n; i++)
            for (int c = 0; c < 6; c++) pKp += p[i][c] * (f_0[i][c] - f_p[i][c]);
        step = rr / pKp;
        for (int i = 0; i < b->n; i++)
            for (int c = 0; c < 6; c++) {
                x[i][c] += step * p[i][c];
                r[i][c] -= step * (f_0[i][c] - f_p[i][c]);
            }
        next = product(b, r, r);
        for (int i = 0; i < b->n; i++)
            for (int c = 0; c < 6; c++)
                p[i][c] = (c < 3 ? r[i][c] : r[i][c] / (b->h * b->h)) + next / rr * p[i][c];
        rr = next;
    }
    put(b, x);
    body_forces(b);
    return sqrt(rr / norm);
}
