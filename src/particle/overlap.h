/* Watches what contacts that are too soft do unseen: the largest overlap of a run, and centres that
 * pass walls. Looks at list builds and wherever the limit of the time step is looked at, so that no
 * other step pays for it. */
#ifndef DEMOCLES_OVERLAP_H
#define DEMOCLES_OVERLAP_H

#include <stdbool.h>

struct overlap;
struct report;
struct sim;

/* Share of the smaller radius [1] from which on an overlap is worth a warning: the contact laws are
 * for small ones. */
#define OVERLAP_BOUND 0.2

/* After limit_create, whose program has the kernels. overlap_free: NULL is fine. Collective. */
struct overlap *overlap_create(struct sim *s);
void overlap_free(struct overlap *overlap);

/* Who has passed a wall since the lists were built that are still there. Not collective. */
void overlap_look_behind(struct sim *s);
/* The largest overlap of now; ghosts are of now. Not collective. */
void overlap_look(struct sim *s);
/* Brings the ranks' findings together, and warns of each kind once. Collective. */
void overlap_warn(struct sim *s);
/* Into run.json what has been found; `observed`: after a last look. Collective. */
void overlap_report(struct sim *s, struct report *r, bool observed);

#endif
