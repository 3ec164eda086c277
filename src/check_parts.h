/* Parts of `democles check`. Private to check*.c. */
#ifndef DEMOCLES_CHECK_PARTS_H
#define DEMOCLES_CHECK_PARTS_H

#include "features.h"

/* The contact laws of all pairs of materials that can meet, with what follows from the sizes of the elements. */
void check_contacts(const struct scene *scene, const struct elements_host *elements);

/* Device memory [byte] per element without pairs, and per listed pair; for one rank, so without ghosts, and without walls. Arrays that have grown
 * hold up to a quarter more, and never shrink: what counts is the largest number of pairs so far. */
double check_element_bytes(const struct features *features);
double check_pair_bytes(const struct features *features);

#endif
