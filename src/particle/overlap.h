/* Watches what may go wrong unseen: the largest overlap of a run, centres that pass walls, and
 * elements that leave the room which their lists gave them. Looks at list builds and wherever the
 * limit of the time step is looked at, so that no other step pays for it. */
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

/* Who has passed a wall, and how far elements have gone, since the lists were built that are still
 * there. Not collective. */
void overlap_look_behind(struct sim *s);
/* The largest overlap of now; ghosts are of now. Not collective. */
void overlap_look(struct sim *s);
/* Brings the ranks' findings together, and warns of each kind once. Collective. */
void overlap_warn(struct sim *s);
/* What has been found so far, largest of all ranks [1]: overlap over the smaller radius, after
 * overlap_warn; displacement over the room of the lists. Collective. */
double overlap_largest(const struct sim *s);
double overlap_room_used(const struct sim *s);
/* Into run.json what has been found; `observed`: after a last look. Collective. */
void overlap_report(struct sim *s, struct report *r, bool observed);

#endif
