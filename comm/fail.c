#include "fail.h"

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Rank in the world, or -1 where MPI does not run (not yet, no longer, or a host test). */
static int world_rank(void)
{
    int started = 0, ended = 0, rank = -1;
    MPI_Initialized(&started);
    MPI_Finalized(&ended);
    if (started && !ended) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

enum { LISTENERS = 2, TEXT = 4096 };
static struct {
    void (*also)(void *context, int exit_code, const char *text);
    void *context;
} listener[LISTENERS];

void fail_tell(void (*also)(void *context, int exit_code, const char *text), void *context)
{
    for (int k = 0; k < LISTENERS; k++) {
        if (also ? listener[k].also != NULL : listener[k].context != context) continue;
        listener[k].also = also;
        listener[k].context = also ? context : NULL;
        return;
    }
}

/* An error on the way out is not told: it would come back here. */
static void tell(int exit_code, const char *text)
{
    for (int k = 0; k < LISTENERS; k++) {
        void (*also)(void *context, int exit_code, const char *text) = listener[k].also;
        listener[k].also = NULL;
        if (also) also(listener[k].context, exit_code, text);
    }
}

/* One line in one write, so that mpirun cannot put the output of another rank between its
 * pieces. */
static void print_line(const char *kind, const char *text)
{
    fprintf(stderr, "democles: %s: %s\n", kind, text);
    fflush(stderr);
}

static void report(int exit_code, const char *text)
{
    print_line("error", text);
    tell(exit_code, text);
}

_Noreturn void fail_stop(int exit_code, const char *format, ...)
{
    int rank = world_rank();
    char text[TEXT];
    va_list args;
    int n = rank > 0 ? snprintf(text, sizeof text, "rank %d: ", rank) : 0;
    va_start(args, format);
    vsnprintf(text + n, sizeof text - (size_t)n, format, args);
    va_end(args);
    report(exit_code, text);
    fflush(stdout);
    if (rank >= 0) MPI_Abort(MPI_COMM_WORLD, exit_code);
    /* No exit handlers: device libraries may have work under way on other threads. */
    _exit(exit_code);
}

_Noreturn void fail_leave(int exit_code)
{
    fflush(stdout);
    if (world_rank() >= 0) MPI_Finalize();
    _exit(exit_code);
}

_Noreturn void fail_stop_together(int exit_code, const char *format, ...)
{
    int rank = world_rank();
    if (rank <= 0) {
        char text[TEXT];
        va_list args;
        va_start(args, format);
        vsnprintf(text, sizeof text, format, args);
        va_end(args);
        report(exit_code, text);
    }
    fail_leave(exit_code);
}

void fail_warn(const char *format, ...)
{
    if (world_rank() > 0) return;
    char text[TEXT];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    print_line("warning", text);
}

void *fail_alloc(size_t bytes)
{
    void *p = calloc(bytes ? bytes : 1, 1);
    if (!p) fail_stop(EXIT_IO, "out of memory: %zu bytes were asked for", bytes);
    return p;
}

void *fail_realloc(void *old, size_t bytes)
{
    void *p = realloc(old, bytes ? bytes : 1);
    if (!p) fail_stop(EXIT_IO, "out of memory: %zu bytes were asked for", bytes);
    return p;
}

char *fail_strdup(const char *text)
{
    size_t n = strlen(text) + 1;
    return memcpy(fail_alloc(n), text, n);
}

char *fail_vformat(const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    int n = vsnprintf(NULL, 0, format, args);
    char *text = fail_alloc((size_t)n + 1);
    vsnprintf(text, (size_t)n + 1, format, again);
    va_end(again);
    return text;
}

char *fail_format(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *text = fail_vformat(format, args);
    va_end(args);
    return text;
}
