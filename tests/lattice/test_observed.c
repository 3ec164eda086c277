/* What is measured of the observed state, on any number of ranks: stress of cells, energies and
 * momenta have the bits that one rank finds, whichever scheme led there, and asking does not change
 * what follows, nor does an account that is kept. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "lattice/lattice_energy.h"
#include "lattice/lattice_stress.h"
#include "tests/mpi_check.h"

static struct device *dev;
static struct comm *comm, alone;

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    (void)context;
    for (int r = 1; r < 5; r++)
        for (int k = 0; k < LOAD_WIDTH; k++) {
            bool over_drift = k >= LOAD_VELOCITY && k < LOAD_NOW;
            rows[r * LOAD_WIDTH + k] =
                (k < LOAD_VELOCITY ? 50 : 3) * sin(r + k + 3e3 * (over_drift ? from + to : t));
        }
}

struct seen {
    double (*stress)[10]; /* [n] by gid, with von Mises; 0 of other ranks' cells */
    struct lattice_energy energy[2];
    uint64_t digest;
};

/* Five steps, measured at the third (if `peek`) and the last. */
static struct seen look(const struct comm *who, const struct lattice_cells *cells,
    const struct lattice_options *o, bool extrapolate, bool peek)
{
    struct lattice *l = lattice_create(dev, who, cells, o);
    struct lattice_stress *stress = lattice_stress_create(l, extrapolate);
    struct lattice_account *account = lattice_energy_create(l, cells);
    size_t n = (size_t)l->layout->n_owned;
    double(*own)[9] = fail_alloc(n * sizeof *own), *mises = fail_alloc(n * sizeof *mises);
    struct seen s = {.stress = fail_alloc((size_t)cells->n * sizeof *s.stress)};
    lattice_begin_step(l);
    for (int step = 1; step <= 5; step++) {
        bool now = step == 5 || (step == 3 && peek);
        lattice_advance(l, now);
        if (!now) continue;
        lattice_stress_run(stress, own, mises);
        lattice_energy_now(account, &s.energy[step == 5]);
        if (step < 5) lattice_begin_step(l);
    }
    CHECK(lattice_digest(l, &s.digest) == 0);
    for (size_t k = 0; k < n; k++) {
        memcpy(s.stress[l->layout->gid[k]], own[k], sizeof *own);
        s.stress[l->layout->gid[k]][9] = mises[k];
    }
    free(own);
    free(mises);
    lattice_energy_free(account);
    lattice_stress_free(stress);
    lattice_free(l);
    return s;
}

static void check(
    const int size[3], bodies_solid *solid, int n_grid, bool extrapolate, struct lattice_options o)
{
    struct link_material material[2] = {{1000, 2e7, 0.3, 0}, {700, 1e7, 0.1, 0}};
    const double alpha[2] = {0, 50};
    material[0].damping = o.scheme == LATTICE_LEAPFROG || o.scheme == LATTICE_RK4 ? 2e-5 : 0;
    o.dt = 1e-4;
    o.energy = true;
    o.alpha = alpha;
    o.material = material;
    o.n_material = 2;
    o.n_row = 5;
    o.rows_at = rows_at;
    o.gravity[2] = -9.81;
    struct lattice_cells *cells = bodies_create(n_grid, size, 0.1, 2, solid);
    bodies_shake(cells, 5, 100);
    struct seen one = look(&alone, cells, &o, extrapolate, true),
                all = look(comm, cells, &o, extrapolate, true),
                blind = look(comm, cells, &o, extrapolate, false);
    o.energy = false;
    struct seen plain = look(comm, cells, &o, extrapolate, false);
    int64_t n_same = 0, n_live = 0;
    const double *e = &one.energy[1].kinetic;
    for (int64_t i = 0; i < cells->n; i++) {
        bool is_other = true, is_same = !memcmp(one.stress[i], all.stress[i], sizeof *one.stress);
        for (int c = 0; c < 10; c++) is_other &= !(all.stress[i][c] < 0 || all.stress[i][c] > 0);
        CHECK(is_same || is_other);
        bool is_live = one.stress[i][9] > 0; /* not a lone cell */
        n_live += is_live;
        n_same += is_live && is_same;
    }
    comm_sum_i64(comm, &n_same, 1);
    CHECK(n_same == n_live && n_live > cells->n * 9 / 10); /* each by the rank that has it */
    CHECK(one.digest == all.digest && one.digest == blind.digest && one.digest == plain.digest);
    CHECK(!memcmp(one.energy, all.energy, sizeof one.energy));
    CHECK(!memcmp(&all.energy[1], &blind.energy[1], sizeof blind.energy[1]));
    CHECK(memcmp(&one.energy[0], &one.energy[1], sizeof one.energy[0])); /* something happens */
    for (size_t k = 0; k < sizeof one.energy[1] / sizeof *e; k++) {
        bool may_be_zero = &e[k] == &one.energy[1].released || &e[k] == &one.energy[1].n_strained ||
                           (&e[k] == &one.energy[1].link_damping && !(material[0].damping > 0));
        CHECK(fabs(e[k]) > 0 || may_be_zero);
    }
    CHECK(isnan(plain.energy[1].work) && plain.energy[1].elastic == e[3]);
    free(one.stress);
    free(all.stress);
    free(blind.stress);
    free(plain.stress);
    bodies_free(cells);
}

int main(int argc, char **argv)
{
    const int size[3] = {41, 7, 5};
    const enum lattice_scheme scheme[3] = {LATTICE_LEAPFROG, LATTICE_RK4, LATTICE_PEFRL};
    comm = comm_create(&argc, &argv);
    alone =
        (struct comm){.world = MPI_COMM_SELF, .node = MPI_COMM_SELF, .n_rank = 1, .n_node_rank = 1};
    dev = device_open(comm, NULL, true, false);
    if (!dev->fp64) return 77;
    for (int k = 0; k < 3; k++)
        check(size, bodies_mixed, 2, k == 1,
            (struct lattice_options){.turn = k != 1, .scheme = scheme[k]});
    check(
        size, bodies_mixed, 1, true, (struct lattice_options){.turn = true, .real_is_float = true});
    device_free(dev);
    comm_free(comm);
    return 0;
}
