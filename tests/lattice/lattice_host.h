/* The lattice on the host, from the laws that the kernels include: same flags, same order, one loop
 * over all cells. */
#ifndef LATTICE_HOST_H
#define LATTICE_HOST_H

#include "lattice_bodies.h"
#include "kernels/lattice/lattice_fate.h"
#include "kernels/lattice/lattice_through.h"
#include "kernels/lattice/lattice_work.h"

struct host {
    const struct lattice_cells *cells;
    struct lattice_options options;
    const struct lattice_table *scheme;
    int64_t n;
    int64_t (*neighbour)[6];
    struct link_cell *now, *next, *start; /* [n] */
    struct lattice_sums *sums;            /* [n] */
    real *p, *p_still;                    /* [n] lambda Th, and without dashpots */
    struct lattice_ledger *ledger;        /* [n] */
    vec3 *last_a, *last_b;                /* [n] accelerations of the stage before */
    int *links, *fate;                    /* [n] links left; kernels/lattice/lattice_words.h */
    real *link, *cell, *kick, *rows;      /* tables */
    real *share;                          /* NULL: all cells are whole */
    real *limit, *inverse;                /* NULL: nothing breaks */
    int *due;                             /* [n] links that go with the next step */
    double *rows_double;
    int64_t step;
    bool started, counted;
};

struct host *host_create(const struct lattice_cells *cells, const struct lattice_options *options);
void host_free(struct host *h);
/* As lattice_advance and lattice_begin_step, but for an observed step of a scheme that ends with a
 * kick: `seen` [n] gets the state, what goes on stays, but for the ledger. */
void host_step(struct host *h);
void host_observe(struct host *h, struct link_cell *seen);
/* Stress of all cells [n] in the state `seen` of this step. */
void host_stress(const struct host *h, struct link_cell *seen, bool extrapolate,
    struct stress *stress, real *von_mises);

#endif
