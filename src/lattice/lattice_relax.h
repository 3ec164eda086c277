/* The way of a lattice to its state of rest: dynamic relaxation (Underwood 1983, in Belytschko and
 * Hughes, Computational Methods for Transient Analysis). The body moves with mass-proportional
 * damping of alpha = 2 w, critical for a motion of frequency w, and w is that of the motion of now,
 * by Rayleigh's quotient over one step:
 *     w^2 = -v.(F(x + dt v) - F(x))/(dt v.m v)
 * If alpha is too large, fast motions die and slow ones are left, whose quotient is lower; if it is
 * too small, the slowest are left. In the end all decay like exp(-w_1 t). The damping of mass that
 * the scene gives is not used.
 *
 * Sums are in integers (kernels/common/sums.h), so the way has the same bits on any number of
 * ranks. Needs a scheme of one kick and one drift. Knows no scene. */
#ifndef DEMOCLES_LATTICE_RELAX_H
#define DEMOCLES_LATTICE_RELAX_H

#include "lattice.h"

struct lattice_relax;

struct lattice_rest {
    /* largest component of force, or of torque over h/2, that moves or brakes a cell [N] */
    double left;
    double scale; /* largest component of stress times h^2 [N] */
    double alpha; /* [1/s] */
};

/* The lattice has been made with mass_damping; its options.alpha become ones of this. `end` [s]:
 * rest counts once the loads are those of that time and lead nothing. Lattice and cells are
 * borrowed for life. Collective. */
struct lattice_relax *lattice_relax_create(
    struct lattice *l, const struct lattice_cells *cells, double end);
void lattice_relax_free(struct lattice_relax *r); /* NULL is fine */
/* Two observed states, one step after the other, make a look; then the damping is set anew.
 * Collective. */
void lattice_relax_first(struct lattice_relax *r);
/* Returns whether left <= tolerance scale. */
bool lattice_relax_second(struct lattice_relax *r, double tolerance);
/* What the next look and the next step depend on, and the other way. */
enum { LATTICE_RELAX_NOTES = 5 };
void lattice_relax_note(const struct lattice_relax *r, double note[LATTICE_RELAX_NOTES]);
void lattice_relax_recall(struct lattice_relax *r, const double note[LATTICE_RELAX_NOTES]);
const struct lattice_rest *lattice_relax_rest(const struct lattice_relax *r);

#endif
