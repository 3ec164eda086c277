/* Directions: vectors of any length. */
#ifndef DEMOCLES_VECTOR_H
#define DEMOCLES_VECTOR_H

#include <stdbool.h>

/* Makes the length of v one and returns what it was, at any length: squares of components below
 * 1e-154 or above 1e154 would vanish or be infinite, so v is brought near one first, by a power of
 * two, which changes no digit. v must be a direction. */
double vector_normalise(double v[3]);

/* Whether v has one: it is finite, and its largest component is not zero and has all its digits
 * (2.2e-308 or more). */
bool vector_is_direction(const double v[3]);

#endif
