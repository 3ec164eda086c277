/* A frame of the particle method: the device's state as tables, for the picture and for going on from it. */
#ifndef DEMOCLES_FRAME_H
#define DEMOCLES_FRAME_H

#include "sim.h"

/* Writes frame number `index` of the observed state at s->step. Collective. */
void frame_write(struct sim *s, int64_t index);

#endif
