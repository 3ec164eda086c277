/* The parts of the particle method, by file: particle_input.c, particle_setup.c, particle_resume.c,
 * particle_cut.c, particle_regroup.c, particle_step.c, particle_limit.c, particle_frame.c,
 * particle_contacts.c, particle_measures.c, particle_report.c. What step.h describes is not
 * described again. */
#ifndef DEMOCLES_PARTICLE_H
#define DEMOCLES_PARTICLE_H

#include "assigned.h"
#include "energy.h"
#include "ghosts.h"
#include "limit.h"
#include "overlap.h"
#include "owners.h"
#include "run/sim.h"

/* What a run of particles has besides what struct sim holds. */
struct particle_run {
    struct features features;
    struct walls *walls;
    double domain[6], period[3]; /* box low, high [m]; 0 where not periodic */
    struct elements_host *first; /* as generated, all elements on every rank */
    /* [n_measure] removed elements that a count goes on counting, on this rank */
    int64_t *n_removed_in;
    struct program *program_lists, *program_pair, *program_wall, *program_body, *program_assign;
    struct particles *particles;
    struct cells *cells;
    struct scan *scan;
    struct pairs *pairs;
    struct wall_contacts *wall_contacts; /* NULL without walls */
    struct owners *owners;
    struct ghosts *ghosts;
    /* NULL: cut pairs are computed on both ranks, or there is one rank */
    struct assigned *assigned;
    struct rcb *rcb;
    struct launch *select_room, *pair_force, *wall_force, *gather, *kick_drift;
    struct buffer table_pair, table_wall;
    struct limit *limit;
    struct overlap *overlap;
    double skin, horizon;       /* room to move: skin + horizon |v| [m], [s] */
    int64_t built_at;           /* step of the last list build */
    struct cells_bounds bounds; /* of owned elements at the last build */
    double box[6];              /* of all elements of all ranks at the last build */
    struct energy *energy;
    struct energy_sums energy_start;
};

extern const struct step_ops particle_ops;

void particle_read(struct sim *s);
void particle_plan(struct sim *s);
void particle_setup(struct sim *s);
void particle_warn(struct sim *s);
void particle_free(struct sim *s);
/* Migrates elements to their owners and rebuilds ghosts and lists; histories are carried over.
 * Collective. */
void particle_regroup(struct sim *s);
/* Makes a new tree of cuts by the scene's method; the elements migrate later. Collective. */
void particle_cut(struct sim *s);
/* Builds ghosts, lists and everything that depends on their sizes, for owned elements that are in
 * place, and sets the room that each may move. particle_lists does the same for `step`, with the
 * room that is already set. Collective. */
void particle_build(struct sim *s);
void particle_lists(struct sim *s, int64_t step);
/* Restarts from the frame s->from, in place of the start of a run: elements, lists and the memory
 * of contacts. Collective. */
void particle_resume(struct sim *s);
/* Makes the first tree of cuts, through the positions x [n][3] of all ranks: interactions are not
 * known yet. Collective. */
void particle_spread(struct sim *s, const double *x, int64_t n);
/* Forces of pairs and walls at the present step, into the result records. */
void particle_forces(struct sim *s);
void particle_advance(struct sim *s, bool observe);
void particle_begin_step(struct sim *s);
/* Binds the step's kernels to buffers; sets sizes. After every build. */
void particle_bind(struct sim *s);

/* Largest safe time step by the bound of kernels/contact/law_limit.h over the contacts of now, and
 * the element that sets it (limit.h). Never over what is safe; where it is not below s->dt, no
 * further than needed to say so. Collective. */
struct limit_result particle_limit(struct sim *s);
/* The limit [s] for the densest packing that the scene's elements can form, at the speeds that its
 * geometry allows: what `step: auto` starts from; infinity if nothing can touch. Reads the scene,
 * the walls and the first elements alone. */
double particle_limit_dense(const struct sim *s);

void particle_check_limit(struct sim *s);

int64_t particle_number(const struct sim *s);
int64_t particle_owned(const struct sim *s);
void particle_frame(struct sim *s, int64_t index);
int particle_measure_columns(const struct sim *s, const struct measure *measure,
    struct series_column column[STEP_MEASURE_COLUMNS]);
void particle_measure(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS]);
/* An element has left the run at x [m]: counts whose region holds the place go on counting it. Not
 * collective. */
void particle_note_removed(struct sim *s, const double x[3]);
bool particle_digest(struct sim *s, uint64_t *digest);
void particle_count(const struct sim *s, struct step_counts *counts);
void particle_report_features(const struct sim *s, struct report *r);
void particle_report_state(struct sim *s, struct report *r, bool observed);
int particle_launches(const struct sim *s, struct step_launch launch[STEP_LAUNCHES]);

#endif
