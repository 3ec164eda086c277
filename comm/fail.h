/* Fatal errors, and allocation that never returns NULL. An error is printed to stderr once, and all
 * ranks leave together. Where several ranks meet the same trouble at the same time, each of them
 * calls fail_stop, and MPI_Abort by the first ends the others. */
#ifndef DEMOCLES_FAIL_H
#define DEMOCLES_FAIL_H

#include <stdarg.h>
#include <stddef.h>

/* Exit codes of the program, a contract with the user. */
enum {
    EXIT_DONE = 0,
    EXIT_USAGE = 2,
    EXIT_SCENE = 3,    /* scene or input file wrong, nothing was started */
    EXIT_DEVICE = 4,   /* no usable device, or a kernel that does not build */
    EXIT_NUMERICS = 5, /* step over its limit, NaN, runaway energy, lost elements */
    EXIT_IO = 6,
    EXIT_STOPPED = 75 /* on request, frame written */
};

/* Prints `democles: error: [rank R:] text` and stops all ranks with the exit code: MPI_Abort where
 * MPI runs, else exit. Not collective. */
_Noreturn void fail_stop(int exit_code, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The same where every rank arrives at the same conclusion with the same text: collective, rank 0
 * prints, all finalise MPI and exit in order. */
_Noreturn void fail_stop_together(int exit_code, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The same where all has been said: collective, no message. */
_Noreturn void fail_leave(int exit_code);

/* Besides printing it, fail_stop and fail_stop_together tell an error to `also` before they leave,
 * on the rank that prints, which may be any: `text` names it if it is not rank 0. Up to two of
 * them; NULL takes back what has the context. Not collective. */
void fail_tell(void (*also)(void *context, int exit_code, const char *text), void *context);

/* A warning, printed by rank 0 alone. */
void fail_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Memory or fail_stop. Zero bytes give a valid pointer. fail_alloc returns zeroed memory. */
void *fail_alloc(size_t bytes);
void *fail_realloc(void *old, size_t bytes);
char *fail_strdup(const char *text);
/* printf into fresh memory, owned by the caller. */
char *fail_format(const char *format, ...) __attribute__((format(printf, 1, 2)));
char *fail_vformat(const char *format, va_list args) __attribute__((format(printf, 1, 0)));

#endif
