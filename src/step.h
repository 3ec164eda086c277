/* What a method offers the main loop. */
#ifndef DEMOCLES_STEP_H
#define DEMOCLES_STEP_H

#include <stdbool.h>

struct sim;

struct step_ops {
    const char *name;
    void (*setup)(struct sim *s);                 /* kernels, elements on their ranks, forces at step 0; state then observable */
    bool (*stale)(struct sim *s);                 /* whether something the host knows of asks for a regroup before this step */
    void (*regroup)(struct sim *s);               /* owners, ghosts, lists: collective and rare */
    void (*advance)(struct sim *s, bool observe); /* forces at the step; observe: state of this time left on the device, else on to the next */
    void (*resume)(struct sim *s);                /* after an observed step: on to the next */
    void (*free)(struct sim *s);
};

extern const struct step_ops particle_ops;

#endif
