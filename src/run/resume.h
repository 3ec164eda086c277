/* Restart of a run: finds the latest intact frame in a folder of results, and reads its scene and
 * the counters of the run as a whole.
 *
 * A frame holds all that the next step depends on, in the run's own bits, and nothing of ranks and
 * owners. The scene is that of the frame: its resolved text, whose paths are absolute. Only keys
 * that the state does not depend on can be changed. Files that the scene names are read again and
 * compared with the first reading by a checksum. */
#ifndef DEMOCLES_RESUME_H
#define DEMOCLES_RESUME_H

#include "results/h5_read.h"
#include "results/log.h"
#include "scene/scene.h"
#include "results/snapshot.h"

struct sim;

struct resume {
    struct h5_reader *reader; /* until resume_close */
    char *dir, *path;         /* of the results, of the frame */
    int64_t index, step;      /* number in the frame's name */
    double dt;                /* [s] */
    struct scene *before;     /* as the frame has it, without changes */
};

/* Finds and opens the newest frame of `dir` that is whole; warns of each newer one that is not, and
 * says what is wrong with it. Where there is none all stop with EXIT_SCENE. Collective. */
struct resume *resume_open(const struct comm *comm, struct log *log, const char *dir);
/* The scene to go on with: the frame's with `set` applied. A key that cannot change, or a mistake:
 * all stop with EXIT_SCENE. Collective. */
struct scene *resume_scene(
    const struct comm *comm, struct resume *resume, const char *const *set, int n_set);
/* Once all is read. */
void resume_close(struct resume *resume);
void resume_free(struct resume *resume); /* NULL is fine */

/* Numbers of the run as a whole that every frame has: steps of the last looks, counters. */
enum { RESUME_SCALARS = 8 };
void resume_note(const struct sim *s, struct frame_scalar scalar[RESUME_SCALARS]);
void resume_recall(struct sim *s);
/* A number of the frame as a whole: an integer from 0 to `most`, a real that is positive or 0, or
 * all stop with EXIT_IO. Collective. */
int64_t resume_integer(const struct sim *s, const char *name, int64_t most);
double resume_real(const struct sim *s, const char *name);
/* After the plan: what has been made of the scene is what the frame was made of, or all stop with
 * EXIT_SCENE. Collective. */
void resume_check_inputs(const struct sim *s);

#endif
