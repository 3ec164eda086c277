/* The lattice method on this rank's device: cells in runs, kernels for what the body needs, one
 * step of any scheme on any number of ranks.
 *
 * Steps as in step.h. After lattice_create, and after lattice_advance with `observe`,
 * displacements, rotations and velocities on the device are of one time, the step's. The bits do
 * not depend on the ranks, nor on which steps are observed. Knows no scene. */
#ifndef DEMOCLES_LATTICE_H
#define DEMOCLES_LATTICE_H

#include "partition/partition.h"
#include "device/reals.h"
#include "lattice_features.h"
#include "lattice_halo.h"

enum { LATTICE_SLOTS = 16 };

struct lattice_break;

struct lattice {
    struct device *dev;
    const struct comm *comm;
    struct lattice_options options;
    const struct lattice_table *scheme;
    struct lattice_features features;
    int64_t n_global;
    int n_kind;
    struct lattice_layout *layout;
    struct partition_part part; /* this rank's */
    struct lattice_halo *halo;  /* NULL on one rank */
    struct program *program;
    struct launch *force, *volume, *first;
    struct lattice_break *breakage; /* NULL where nothing breaks */
    struct buffer x, v;             /* sets of planes: kernels/lattice/lattice_state.h */
    struct buffer sum_x, sum_v, pressure;
    struct buffer
        /* features.energy: [LATTICE_LEDGER][plane] double, of the observed step and, but for the
         * kick that began, of what goes on */
        ledger;
    struct buffer word, info, base, force_list, volume_list, row, link, cell, kick, share, shares;
    int x_set, v_set;           /* where the state is that goes on */
    int x_observed, v_observed; /* where that of the observed step is */
    int64_t step;
    bool started; /* the kick that ends a step is due */
    bool counted; /* that kick is in the ledger already */
    struct {
        struct buffer buffer;
        double *value, *last;      /* [n_row][LOAD_WIDTH]: asked for, sent last */
        void *host[LATTICE_SLOTS]; /* in numbers of the device, on their way */
        cl_event sent[LATTICE_SLOTS];
        int64_t n_sent;
    } rows;
    struct timers unread, *timers; /* of exchanges; the run puts its own in place of `unread` */
};

/* `cells` and what `options` points to are borrowed during the call only, except `material`,
 * `alpha` and `context`. Collective. */
struct lattice *lattice_create(struct device *dev, const struct comm *comm,
    const struct lattice_cells *cells, const struct lattice_options *options);
void lattice_free(struct lattice *l); /* NULL is fine */

/* On to step + 1. Schemes that begin a step with a kick: forces at the step, the kick that ends it;
 * observe: state of this time left on the device, else also the kick and drifts that lead on.
 * Others: the whole step that leads here, observed or not. */
void lattice_advance(struct lattice *l, bool observe);
/* After an observed step, and at the start: on to the next. */
void lattice_begin_step(struct lattice *l);

/* The observed state of this rank's cells, in the order of layout->gid, [n_owned] each; theta is of
 * small rotations, q (w, x, y, z) of any. Those that are NULL are left out. */
struct lattice_motion {
    double (*u)[3], (*theta)[3], (*q)[4], (*v)[3], (*w)[3];
};
void lattice_read(const struct lattice *l, const struct lattice_motion *m);
/* The other way, at the start and after an observed step: what is not NULL. */
void lattice_write(struct lattice *l, const struct lattice_motion *m);
/* Of an observed step of a scheme that ends with a kick: velocities before that kick, from which
 * the run goes on (forces of damped links are theirs). */
void lattice_read_before(const struct lattice *l, const struct lattice_motion *before);
/* All of an observed step; `before` as above, unused by other schemes. */
void lattice_write_observed(struct lattice *l, int64_t step, const struct lattice_motion *m,
    const struct lattice_motion *before);
/* Digest (digest.h) over u, v, q or theta, w of the observed state; returns how many cells have a
 * NaN. Collective. */
int64_t lattice_digest(const struct lattice *l, uint64_t *digest);

/* Bytes of a number of x and of v on this device. */
size_t lattice_x_bytes(const struct lattice *l);
size_t lattice_v_bytes(const struct lattice *l);
/* A kernel of a program of this lattice, bound to its tables and state; list: runs that it goes
 * over, NULL: it has none. */
struct launch *lattice_launch(struct lattice *l, const struct program *program, const char *kernel,
    const struct buffer *list);
/* Plane `number` of a buffer, of this rank's cells in the order of layout->gid; the caller
 * frees. */
double *lattice_read_plane(
    const struct lattice *l, const struct buffer *buffer, bool is_float, int64_t number);
/* The other way; value [n_owned], `width` numbers from one to the next. */
void lattice_write_plane(struct lattice *l, struct buffer *buffer, bool is_float, int64_t number,
    const double *value, int width);

/* Makes the rows of loads those of time t, enqueued before the next kernels (lattice_rows.c). */
void lattice_rows_create(struct lattice *l);
void lattice_rows_free(struct lattice *l);
void lattice_rows_send(struct lattice *l, double t, double from, double to);

#endif
