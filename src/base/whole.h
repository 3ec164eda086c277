/* Whole numbers of reals, for any real. In C a conversion of what does not fit (1e300, infinity,
 * not a number) is undefined; here it gives the nearest number that fits, and 0 for what is not a
 * number. Every real that a file, a scene or a measurement gives is converted by these. */
#ifndef DEMOCLES_WHOLE_H
#define DEMOCLES_WHOLE_H

#include <stdint.h>

int64_t whole_i64(double x);   /* towards zero, like a cast */
int whole_int(double x);       /* the same for an int */
int64_t whole_floor(double x); /* downwards */
int64_t whole_round(double x); /* to the nearest, halves away from zero */

/* Steps of `dt` in a period: the nearest whole number, at least 1. A period that is longer than any
 * run is never over (INT64_MAX). */
int64_t whole_steps(double period, double dt);

#endif
