#include "jacobi.h"

#include <math.h>

/* One rotation that makes a[p][q] zero. */
static void rotate(double *a, int n, int p, int q)
{
    double h = a[p * n + q];
    if (fabs(h) < 1e-300) return;
    double theta = (a[q * n + q] - a[p * n + p]) / (2 * h);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)),
           c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < n; k++) {
        double x = a[k * n + p], y = a[k * n + q];
        a[k * n + p] = c * x - s * y;
        a[k * n + q] = s * x + c * y;
    }
    for (int k = 0; k < n; k++) {
        double x = a[p * n + k], y = a[q * n + k];
        a[p * n + k] = c * x - s * y;
        a[q * n + k] = s * x + c * y;
    }
}

void jacobi(double *a, int n, double *smallest, double *largest)
{
    for (int sweep = 0; sweep < 50; sweep++) {
        double off = 0, diagonal = 0;
        for (int p = 0; p < n; p++)
            for (int q = 0; q < n; q++) *(p == q ? &diagonal : &off) += a[p * n + q] * a[p * n + q];
        if (off <= 1e-28 * diagonal) break;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) rotate(a, n, p, q);
    }
    *smallest = *largest = a[0];
    for (int p = 1; p < n; p++) {
        *smallest = fmin(*smallest, a[p * n + p]);
        *largest = fmax(*largest, a[p * n + p]);
    }
}
