/* A small frame whose numbers follow from the global id alone: rank r holds (3 + 2 r) elements,
 * rank 1 none. */
#ifndef FRAME_FIXTURE_H
#define FRAME_FIXTURE_H

#include "comm/comm.h"
#include "results/snapshot.h"

enum { FIXTURE_STEP = 4200, FIXTURE_INDEX = 7, FIXTURE_LARGEST = 64 };

static inline int64_t fixture_count(int rank)
{
    return rank == 1 ? 0 : 3 + 2 * rank;
}

static inline double fixture_position(int64_t gid, int axis)
{
    return 0.001 * (double)gid + 0.1 * axis + 1.0 / 3.0;
}

static inline double fixture_velocity(int64_t gid, int axis)
{
    return (double)(gid * gid) - 0.7 * axis;
}

struct fixture {
    double position[FIXTURE_LARGEST][3], velocity[FIXTURE_LARGEST][3];
    float radius[FIXTURE_LARGEST];
    int64_t gid[FIXTURE_LARGEST];
    int32_t coordination[FIXTURE_LARGEST];
    struct column point[5], element[4], pair[1];
    struct table state[2];
    struct frame_scalar scalar[2];
    struct frame frame;
};

static inline void fixture_fill(struct fixture *f, const struct comm *comm)
{
    int64_t n = fixture_count(comm->rank), begin = comm_exscan_i64(comm, n);
    for (int64_t i = 0; i < n; i++) {
        f->gid[i] = begin + i;
        f->radius[i] = 0.001f * (float)(begin + i + 1);
        f->coordination[i] = (int32_t)(begin + i) % 5;
        for (int k = 0; k < 3; k++) {
            f->position[i][k] = fixture_position(begin + i, k);
            f->velocity[i][k] = fixture_velocity(begin + i, k);
        }
    }
    f->point[0] =
        (struct column){"position", "m", "centre of the element", COLUMN_F64, 3, f->position};
    f->point[1] =
        (struct column){"velocity", "m/s", "velocity of the centre", COLUMN_F64, 3, f->velocity};
    f->point[2] = (struct column){"radius", "m", "radius", COLUMN_F32, 1, f->radius};
    f->point[3] = (struct column){"id", "1", "global id", COLUMN_I64, 1, f->gid};
    f->point[4] = (struct column){
        "coordination", "1", "contacts of the element", COLUMN_I32, 1, f->coordination};
    f->element[0] = f->point[3];
    f->element[1] = f->point[0];
    f->element[2] = f->point[1];
    f->element[3] = (struct column){
        "displacement", "m", "since the lists were built, in µm steps", COLUMN_F64, 3, f->velocity};
    f->pair[0] =
        (struct column){"partner", "1", "global id of the second element", COLUMN_I64, 1, f->gid};
    f->state[0] = (struct table){"elements", n, f->element, 4};
    f->state[1] = (struct table){"pairs", 0, f->pair, 1};
    f->scalar[0] = (struct frame_scalar){"dt", COLUMN_F64, 1e-5, 0};
    f->scalar[1] = (struct frame_scalar){"n_removed", COLUMN_I64, 0, 12};
    f->frame = (struct frame){.step = FIXTURE_STEP,
        .time = 0.042,
        .index = FIXTURE_INDEX,
        .points = {"points", n, f->point, 5},
        .state = f->state,
        .n_state = 2,
        .resolved = "title: a scene\n",
        .scalar = f->scalar,
        .n_scalar = 2};
}

#endif
