/* Links of a lattice that break: judged once per step from the state at its start, gone at its end
 * (by the stress of cells: at the end of the next), the same on any number of ranks. There only
 * where the scene gives a strength; its kernels are built only then.
 *
 * The largest frequency, so the limit of the time step, does not rise: links only disappear
 * (lattice_limit.h). Faces of a crack do not touch again. */
#ifndef DEMOCLES_LATTICE_BREAK_H
#define DEMOCLES_LATTICE_BREAK_H

#include "lattice.h"

/* tension, shear, bending, twist: BREAK_* of kernels/lattice/law_break.h less 1 */
enum { LATTICE_BREAK_MODES = 4 };

struct lattice_break;

/* The lattice is borrowed for life. Collective. */
struct lattice_break *lattice_break_create(struct lattice *l, const struct lattice_cells *cells);
void lattice_break_free(struct lattice_break *b); /* NULL is fine */

/* Enqueue. x_in, v_in: first numbers of the sets of planes with the state to judge; ghosts and
 * pressures are of that state too. */
void lattice_break_judge(struct lattice_break *b, int64_t x_in, int64_t v_in);
void lattice_break_sever(struct lattice_break *b);

/* Has a kernel of the account of energy know what has been released
 * (kernels/lattice/link_release.cl); features.energy only. */
void lattice_break_bind(const struct lattice_break *b, struct launch *launch);

/* Names of the modes, and how many links of all ranks broke in each so far. Collective. */
const char *lattice_break_name(int mode);
void lattice_break_count(const struct lattice_break *b, int64_t count[LATTICE_BREAK_MODES]);
/* Of this rank's cells in the order of layout->gid, [n_owned] each; NULL is left out. links: those
 * left, LINK_BIT of kernels/lattice/lattice_words.h; fate: how those at its upper faces broke, and
 * which of its links are due (kernels/lattice/lattice_words.h). */
void lattice_break_read(const struct lattice_break *b, int32_t *links, int32_t *fate);
/* The other way, before the first step. */
void lattice_break_write(struct lattice_break *b, const int32_t *links, const int32_t *fate);
/* What the account of released energy has of each cell (kernels/lattice/link_release.cl), and the
 * other way; features.energy only. */
void lattice_break_read_release(const struct lattice_break *b, int32_t *fresh, double *released);
void lattice_break_write_release(
    struct lattice_break *b, const int32_t *fresh, const double *released);

#endif
