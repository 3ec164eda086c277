#include "vector.h"

#include <float.h>
#include <math.h>

static double largest(const double v[3])
{
    return fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
}

double vector_normalise(double v[3])
{
    int exponent;
    frexp(largest(v), &exponent);
    for (int k = 0; k < 3; k++) v[k] = ldexp(v[k], -exponent);
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) v[k] /= length;
    return ldexp(length, exponent);
}

bool vector_is_direction(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && largest(v) >= DBL_MIN;
}
