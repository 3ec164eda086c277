/* Stress of the cells in the observed state (lattice.h), from the very forces that move them; its
 * kernel is built only when this is. */
#ifndef DEMOCLES_LATTICE_STRESS_H
#define DEMOCLES_LATTICE_STRESS_H

#include "lattice.h"

struct lattice_stress;

/* How a cell at the surface counts (kernels/lattice/law_stress.h): the mean over its volume, half
 * of the inside where a face is free and the other is not; or (extrapolate) the value at the face
 * that bears a force. The lattice is borrowed for life. Collective. */
struct lattice_stress *lattice_stress_create(struct lattice *l, bool extrapolate);
void lattice_stress_free(struct lattice_stress *s); /* NULL is fine */

/* Of this rank's cells in the order of layout->gid: symmetric part, rows of the tensor in the
 * world's axes, and von Mises' equivalent [Pa]. Both [n_owned]; NULL is left out. Collective. */
void lattice_stress_run(struct lattice_stress *s, double (*stress)[9], double *von_mises);

#endif
