/* lattice_speed N [single] [turn] [nu] [scheme] [run] [energy]: cells per second of a block of N^3
 * cells on one rank, and of the memory (triad) in the same run. In seconds that this process had a
 * core, best of many short spans: others may use the machine. A tool, not a test. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "comm/fail.h"
#include "lattice_bodies.h"

enum { ROUNDS = 150 };

/* Seconds on a core, of all threads. */
static double busy(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* STREAM's triad a = b + s c over arrays beyond all caches, best of many [byte/s], fills of cache
 * lines not counted. */
static double triad(void)
{
    enum { N = 1 << 21 };
    double *a = fail_alloc(N * sizeof *a), *b = fail_alloc(N * sizeof *b),
           *c = fail_alloc(N * sizeof *c), best = 0;
    for (int i = 0; i < N; i++) a[i] = b[i] = c[i] = i;
    for (int k = 0; k < ROUNDS; k++) {
        double t = busy();
        for (int i = 0; i < N; i++) a[i] = b[i] + 1e-3 * k * c[i];
        t = busy() - t;
        if (24.0 * N / t > best) best = 24.0 * N / t;
    }
    if (a[N / 2] < 0) printf("?\n");
    free(a);
    free(b);
    free(c);
    return best;
}

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    int n = argc > 1 ? atoi(argv[1]) : 30, size[3] = {n, n, n};
    struct link_material m = {7900, 2.1e11, argc > 4 ? atof(argv[4]) : 0, 0};
    struct lattice_options o = {.dt = 1e-8, .material = &m, .n_material = 1, .n_row = 1};
    o.real_is_float = o.position_is_float = argc > 2 && !strcmp(argv[2], "single");
    o.turn = argc > 3 && !strcmp(argv[3], "turn");
    o.scheme = argc > 5 ? (enum lattice_scheme)atoi(argv[5]) : LATTICE_LEAPFROG;
    o.run.length = argc > 6 ? atoi(argv[6]) : 0;
    o.energy = argc > 7;
    struct device *dev = device_open(comm, NULL, false, false);
    struct lattice_cells *cells = bodies_create(1, size, 0.01, 1, bodies_block);
    bodies_shake(cells, 1, 1);
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    int steps = 1 + (int)(200000 / cells->n); /* short: others may use the core */
    double memory = triad(), best = 0;
    for (int k = 0; k < ROUNDS; k++) {
        device_finish(dev);
        double t = busy();
        for (int i = 0; i < steps; i++) lattice_begin_step(l), lattice_advance(l, false);
        device_finish(dev);
        t = busy() - t;
        double rate = (l->scheme->ends_with_kick ? 2.0 : 1.0) * steps * (double)cells->n / t;
        if (rate > best) best = rate;
    }
    /* x: read, written, line fetched before; v: read and written in place; word */
    double fills = 4 + (3 * 6 + 2 * 6) * (double)lattice_v_bytes(l),
           plain = 4 + 4 * 6 * (double)lattice_v_bytes(l);
    printf("%lld cells, runs of %d: %.1f million cells/s, %.2f ns per cell; triad %.1f GB/s (%.1f "
           "with fills); bytes per cell %.0f (%.0f with fills): "
           "%.0f %% of the triad, with fills %.0f %%\n",
        (long long)cells->n, l->layout->run, best / 1e6, 1e9 / best, memory / 1e9,
        memory / 1e9 * 4 / 3, plain, fills, 100 * best * plain / memory,
        100 * best * fills / (memory * 4 / 3));
    lattice_free(l);
    bodies_free(cells);
    device_free(dev);
    comm_free(comm);
    return 0;
}
