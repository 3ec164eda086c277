#include "restitution.h"

#include <assert.h>
#include <math.h>

#define PI 3.14159265358979323846

/* acos(z)/sqrt(1-z^2), and acosh(z)/sqrt(z^2-1) beyond z = 1; 1 there. With s = sqrt(|1-z^2|) they
 * are atan2(s, z)/s and asinh(s)/s, which keep all digits near z = 1, where acos and acosh lose
 * half of them. */
static double arc_quotient(double z)
{
    double s = sqrt(fabs((1 - z) * (1 + z)));
    if (s == 0) return 1;
    return z < 1 ? atan2(s, z) / s : asinh(s) / s;
}

double restitution_of_damping(double z, bool attraction)
{
    if (!attraction) return exp(-2 * z * arc_quotient(z));
    return z < 1 ? exp(-PI * z / sqrt((1 - z) * (1 + z))) : 0;
}

/* Without attraction: Newton on f(z) = 2 z q(z) + ln e = 0, q = acos(z)/sqrt(1-z^2). From (1 - z^2)
 * q' = z q - 1 follows f' = 2 (q - z)/(1 - z^2), which is 4/3 + 4 (1-z)/5 + ... near z = 1. f is
 * increasing and concave, so that from the left of the root Newton may overshoot once but then
 * approaches from one side. */
static double damping_without_attraction(double e)
{
    double target = -log(e);
    /* the inverse with attraction: always below the root */
    double z = target / sqrt(PI * PI + target * target);
    for (int k = 0; k < 100; k++) {
        double q = arc_quotient(z), d = 1 - z;
        double slope = fabs(d) < 1e-4 ? 4.0 / 3 + 0.8 * d : 2 * (q - z) / ((1 - z) * (1 + z));
        double next = z - (2 * z * q - target) / slope;
        if (fabs(next - z) <= 1e-15 * fabs(next)) return next;
        z = next;
    }
    return z;
}

double restitution_damping(double e, bool attraction)
{
    assert(e > 0 && e <= 1);
    if (e == 1) return 0;
    if (!attraction) return damping_without_attraction(e);
    double l = log(e);
    return -l / sqrt(PI * PI + l * l);
}
