/* Elements at walls: the walls on the device, their poses ahead of time, candidates of each
 * element, and what those contacts remember.
 *
 * Poses of moving walls are computed by rank 0 for a batch of steps and broadcast as bits; the
 * device holds the row of one step at a time, copied from a batch that was uploaded as a whole.
 * Knows no law and no pair. */
#ifndef DEMOCLES_WALL_CONTACTS_H
#define DEMOCLES_WALL_CONTACTS_H

#include "pairs.h"

enum { WALL_BATCH = 1024 }; /* steps of poses computed and uploaded at once */

struct wall_list {
    int64_t n_owned, n, capacity; /* elements; candidates; room for candidates */
    /* int: first candidate of each element [n_owned + 1]; primitive and element of each candidate
     * [capacity] */
    struct buffer begin, candidate, element;
    /* int [capacity]; real [layout.history][capacity], see kernels/contact/contact_memory.h */
    struct buffer state, history;
};

struct wall_contacts {
    const struct features *features;
    const struct walls *walls;
    const struct comm *comm;
    double dt;
    struct contact_layout layout;
    struct wall_list now, old;
    struct contact_arrivals arrivals;
    struct buffer primitive, bounds, triangle_features, wall_of, material, room, pose, result,
        ledger;
    /* int [n_block + 1]: first primitive of each block; preal [n_block][6]: its box */
    struct buffer block_begin, block_bounds;
    int n_block;
    struct buffer keep, partner, near; /* of wall_keep.cl; only where joined */
    struct buffer batch;               /* preal [WALL_BATCH][n_wall][POSE_WIDTH] */
    struct wall_pose *poses;           /* [WALL_BATCH][n_wall] on the host */
    int64_t batch_first;               /* step of the first pose */
    struct wall_pose *built;           /* [n_wall] where the walls were when the lists were built */
    double *room_host; /* [n_wall] how far each may go from there [m]; negative: not there */
    struct launch *rows, *carry, *leave, *keep_launch, *copy;
};

/* What wall_contacts_create needs, all borrowed as long as the contacts live, except the scene. */
struct wall_setup {
    const struct comm *comm;
    const struct features *features;
    const struct scene *scene; /* materials of the walls */
    const struct walls *walls;
    double dt;                     /* [s] */
    const struct program *program; /* wall_lists.cl, wall_keep.cl, layout.cl */
};
struct wall_contacts *wall_contacts_create(const struct wall_setup *setup);
void wall_contacts_free(struct wall_contacts *w);

/* Brings the poses of `step` to the device; from step to step in ascending order. Collective when a
 * new batch begins. */
void wall_contacts_set_step(struct wall_contacts *w, int64_t step);
/* Its row of POSE_WIDTH numbers (kernels/particle/particle_words.h). */
void wall_contacts_pose_row(const struct wall_pose *pose, double *row);
const struct wall_pose *wall_contacts_pose(const struct wall_contacts *w, int64_t step);

/* Candidates for `step`, valid until an element or a wall has used up its room; `horizon_steps`:
 * for how long walls in motion get room; box: low and high corner of all elements [m]. */
void wall_contacts_build(struct wall_contacts *w, struct scan *scan, const struct particles *p,
    int64_t step, int horizon_steps, const double box[6]);
void wall_contacts_carry(struct wall_contacts *w, const struct buffer *old_index);

/* Whether some wall has used up its room by `step`, or appears or goes then. The same on all ranks.
 * Within the batch of the last set_step. */
bool wall_contacts_stale(const struct wall_contacts *w, int64_t step, const double box[6]);

/* Meshes: which candidates count in this step. */
void wall_contacts_select(struct wall_contacts *w, const struct particles *p);

#endif
