/* A run: the one owner of everything, and the main loop.
 *
 * The loop knows steps, output and stops; what a step is, the method knows (step.h). */
#ifndef DEMOCLES_SIM_H
#define DEMOCLES_SIM_H

#include "account.h"
#include "balance.h"
#include "results/log.h"
#include "step.h"
#include "base/timer.h"
#include "device/trace.h"
#include "device/watch.h"

/* From the command line. */
struct sim_options {
    const char *dir; /* results */
    /* profile: device time of every kernel into run.json, at a small price */
    bool force, quiet, profile;
    bool trace;                      /* a timeline: trace.h */
    int64_t trace_from, trace_steps; /* -1: as trace_create wants; how many */
    const char *device;              /* NULL: best */
    enum precision precision;        /* PRECISION_DEFAULT: the scene's */
    int64_t n_step;                  /* last step, -1: from the scene's end */
    double max_time;                 /* [s] of wall time; infinity: none */
};

struct sim {
    const struct sim_options *options;
    struct scene *scene;
    struct comm *comm;
    struct device *dev;
    struct log *log;
    int64_t n_first; /* elements at the start, of all ranks */
    const struct step_ops *ops;
    struct resume *from; /* frame of the folder of results to go on from; NULL: from the start */
    /* checksum of elements and walls, or cells and loads, as the scene makes them */
    int64_t inputs;

    /* What a run of each method has besides; the other one is NULL. */
    struct particle_run *particle; /* particle/particle.h */
    struct lattice_run *lattice;   /* lattice/lattice_method.h */

    int64_t step, n_step; /* now; last */
    int64_t begun_at;     /* step at which this process took up the run */
    int64_t limit_at;     /* of the last look at the limit */
    bool observed;        /* the state on the device is that of a full step */
    double dt, dt_limit;  /* [s]; rigorous limit at the last build */
    struct {
        /* step of the next look whether the elements are at rest; 0: the scene does not ask */
        int64_t next;
        bool reached;   /* the run ends then */
        double left;    /* share of the largest force [1], at the last look; NaN before the first */
        double damping; /* of mass, set by the last look [1/s] */
    } rest;
    struct watch watch;
    struct timers timers;
    struct trace *trace; /* NULL: none */
    struct outputs *output;

    int64_t n_rebuild, n_removed;
    struct balance *balance;
    struct account account;
    struct halo_traffic sent_before; /* by this rank before the first step */
    double started;                  /* timer_now at the start */
    bool is_recorded;                /* run.json has been written */
};

/* Reads nothing: the scene is there. ops: of the scene's method. Opens the device, builds kernels,
 * makes elements, lists and output. Collective; errors stop all ranks. */
struct sim *sim_create(struct scene *scene, struct comm *comm, struct log *log,
    const struct step_ops *ops, struct resume *from, const struct sim_options *options);
/* A measure of energy on a device without double precision: message, exit code 4. Collective. */
void sim_require_double(const struct sim *s);
/* Runs to the end or to a stop; returns the exit code. Collective. */
int sim_run(struct sim *s);
void sim_free(struct sim *s);

#endif
