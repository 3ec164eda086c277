/* The elements of this rank on its device: owned ones first, ghosts behind them.
 *
 * Each field (enum and table below) is a property that an element keeps when it is reordered,
 * migrates or is written to a frame. What is computed anew at a list rebuild (reference, reach) or
 * at each step (force, torque) is a buffer of its own. Knows no lists, no walls, no messages. */
#ifndef DEMOCLES_PARTICLES_H
#define DEMOCLES_PARTICLES_H

#include "features.h"
#include "device/launch.h"
#include "device/reals.h"
#include "kernels/common/flags.h"

enum { FIELD_STATE, FIELD_GID, FIELD_ORIENTATION, FIELD_N };

/* One carried field: `bytes` per element (0: the scene does not have it), in two buffers that
 * change places when elements are reordered. */
struct field {
    size_t bytes;
    struct buffer now, spare;
};

struct particles {
    int64_t n_owned, n_ghost, n_global;
    struct field field[FIELD_N];
    /* preal [n_owned][4]: place when the lists were built, room to move [m] */
    struct buffer reference;
    struct buffer reach;          /* preal [n_owned + n_ghost]: listing reach [m] */
    struct buffer force, torque;  /* real [n_owned][4] of the last observed step [N], [N m] */
    struct buffer flags;          /* int [FLAG_N] */
    struct launch *gather, *copy; /* records by index; words */
};

static inline size_t particles_real(const struct features *f)
{
    return reals_size(f->real_is_float);
}
static inline size_t particles_preal(const struct features *f)
{
    return reals_size(f->position_is_float);
}

/* Of a record of FIELD_STATE, as kernels/particle/element.h has it. */
static inline size_t particles_record(const struct features *f)
{
    size_t floats = 4 * ((size_t)f->kick + (size_t)f->spin_kick);
    return 4 * particles_preal(f) + (f->spin ? 8 : 4) * particles_real(f) + floats * sizeof(float);
}

/* `lists`: program with records.cl. */
struct particles *particles_create(
    struct device *dev, const struct features *features, const struct program *lists);
void particles_free(struct particles *p);

/* Room for n elements in all; what the fields hold for the first `keep` elements stays. */
void particles_reserve(
    struct particles *p, const struct features *features, int64_t n, int64_t keep);
/* The spare buffers, contents lost. */
void particles_reserve_spare(struct particles *p, int64_t n);
/* spare[i] = now[index[i]] for i < n, all fields; then particles_swap makes the spare ones
 * current. */
void particles_permute(struct particles *p, const struct buffer *index, int64_t n);
void particles_swap(struct particles *p);

/* Owned elements on the host, as plain doubles (float bits widen exactly), for frames, digests and
 * tests. */
struct particles_host {
    int64_t n;
    int64_t *gid;
    double *x, *v, *w, *q; /* [n][3], [n][3], [n][3], [n][4] (1 0 0 0 where not tracked) */
    double *radius, *mass;
    int32_t *material;
};
struct particles_host *particles_download(const struct particles *p,
    const struct features *features, const struct scene *scene, const struct elements_host *first);
/* n elements, all numbers zero but the quaternions' w. */
struct particles_host *particles_host_create(int64_t n);
/* Radius, material and mass of row i, by its gid. */
void particles_host_kind(struct particles_host *host, int64_t i, const struct scene *scene,
    const struct elements_host *first);
void particles_host_free(struct particles_host *host);

/* Fills the empty store with the generated elements whose take[i] is set. */
void particles_take(struct particles *p, const struct features *features,
    const struct elements_host *elements, const struct scene *scene, const unsigned char *take);
/* Replaces all elements by the rows of `host`; leaves p->n_global as it is. */
void particles_replace(
    struct particles *p, const struct features *features, const struct particles_host *host);
/* Overwrites positions and motion of the owned elements, which stay in their order. */
void particles_write_state(
    struct particles *p, const struct features *features, const struct particles_host *host);

#endif
