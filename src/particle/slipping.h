/* How many contacts of now slip. Looks once, at the end of a run, at what the kernels left. */
#ifndef DEMOCLES_SLIPPING_H
#define DEMOCLES_SLIPPING_H

struct sim;

/* Share of the pairs in contact with friction whose tangential force is at its limit [1]; walls do
 * not count; NaN without such pairs. The state is an observed one, ghosts are of now. The same on
 * any number of ranks. Collective. */
double slipping_share(struct sim *s);

#endif
