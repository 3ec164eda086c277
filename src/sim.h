/* A run: the one owner of everything, and the main loop.
 *
 * The loop knows steps, output and stops; what a step is, the method knows (step.h). */
#ifndef DEMOCLES_SIM_H
#define DEMOCLES_SIM_H

#include "assigned.h"
#include "balance.h"
#include "energy.h"
#include "ghosts.h"
#include "log.h"
#include "owners.h"
#include "step.h"
#include "timer.h"
#include "trace.h"
#include "watch.h"

/* From the command line. */
struct sim_options {
    const char *dir;                 /* results */
    bool force, quiet, profile;      /* profile: device time of every kernel into run.json, at a small price */
    bool trace;                      /* a timeline: trace.h */
    int64_t trace_from, trace_steps; /* -1: as trace_create wants; how many */
    const char *device;              /* NULL: best */
    enum precision precision;        /* PRECISION_DEFAULT: the scene's */
    int64_t n_step;                  /* last step, -1: from the scene's end */
    double max_time;                 /* [s] of wall time; infinity: none */
    struct resume *from;             /* frame in `dir` to go on from; NULL: from the start */
};

struct sim {
    const struct sim_options *options;
    struct scene *scene;
    struct comm *comm;
    struct device *dev;
    struct log *log;
    struct features features;
    struct walls *walls;
    int64_t n_first;             /* elements at the start, of all ranks */
    double domain[6], period[3]; /* box low, high [m]; 0 where not periodic */
    const struct step_ops *ops;
    const struct resume *from; /* NULL: from the start */
    int64_t inputs;            /* checksum of elements and walls, or cells and loads, as the scene makes them */

    struct lattice_run *solid; /* lattice method: lattice_method.h */

    /* particle method */
    struct elements_host *first; /* as generated, all elements on every rank */
    int64_t *left;               /* [n_measure] elements that left the run where a count holds, on this rank */
    struct program *program_lists, *program_pair, *program_wall, *program_body, *program_assign;
    struct particles *particles;
    struct cells *cells;
    struct scan *scan;
    struct pairs *pairs;
    struct wall_contacts *wall_contacts; /* NULL without walls */
    struct owners *owners;
    struct ghosts *ghosts;
    struct assigned *assigned; /* NULL: cut pairs are computed on both ranks, or there is one rank */
    struct rcb *rcb;
    struct launch *select_room, *pair_force, *wall_force, *gather, *kick_drift;
    struct buffer table_pair, table_wall;
    struct limit *limit;
    double skin, horizon;       /* room to move: skin + horizon |v| [m], [s] */
    int64_t built_at;           /* step of the last list build */
    struct cells_bounds bounds; /* of owned elements at the last build */
    double box[6];              /* of all elements of all ranks at the last build */

    int64_t step, n_step; /* now; last */
    int64_t begun_at;     /* step at which this process took up the run */
    int64_t limit_at;     /* of the last look at the limit */
    bool observed;        /* the state on the device is that of a full step */
    double dt, dt_limit;  /* [s]; rigorous limit at the last build */
    struct {
        int64_t next;   /* step of the next look whether the elements are at rest; 0: the scene does not ask */
        bool reached;   /* the run ends then */
        double left;    /* share of the largest force [1], at the last look; NaN before the first */
        double damping; /* of mass, set by the last look [1/s] */
    } rest;
    struct watch watch;
    struct timers timers;
    struct trace *trace; /* NULL: none */
    struct outputs *output;

    /* account of the run */
    int64_t n_rebuild, n_removed;
    struct balance *balance;
    struct energy *energy;
    struct energy_sums energy_start;
    double element_steps;         /* elements times steps so far */
    struct device_counters plain; /* what the plain steps added: those without regroup, observation or the step after one */
    int64_t n_plain;
    struct halo_traffic sent_before; /* by this rank before the first step */
    double started;                  /* timer_now at the start */
};

/* Reads nothing: the scene is there. Opens the device, builds kernels, makes elements, lists and output. Collective; errors stop all ranks. */
struct sim *sim_create(struct scene *scene, struct comm *comm, struct log *log, const struct sim_options *options);
/* Runs to the end or to a stop; returns the exit code. Collective. */
int sim_run(struct sim *s);
void sim_free(struct sim *s);

#endif
