/* What the lattice method measures. */
#include "lattice_method.h"

#include <math.h>
#include <string.h>

#include "fail.h"

int lattice_method_measure_columns(enum measure_kind kind, const struct series_column **column)
{
    static const struct series_column probe[] = {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"u_x", "m"}, {"u_y", "m"}, {"u_z", "m"}, {"v_x", "m/s"},
        {"v_y", "m/s"}, {"v_z", "m/s"}, {"w_x", "rad/s"}, {"w_y", "rad/s"}, {"w_z", "rad/s"}};
    (void)kind;
    *column = probe;
    return 12;
}

/* The cell whose centre at the start is nearest, the first of several; the same on every rank. */
static int64_t nearest(const struct lattice_cells *cells, const double at[3])
{
    int64_t best = 0;
    double least = HUGE_VAL, x[3];
    for (int64_t i = 0; i < cells->n; i++) {
        lattice_cells_centre(cells, i, x);
        double d = (x[0] - at[0]) * (x[0] - at[0]) + (x[1] - at[1]) * (x[1] - at[1]) + (x[2] - at[2]) * (x[2] - at[2]);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    return best;
}

/* The cell's owner gives the bits, the others zeros. */
static void measure_probe(struct sim *s, const double at[3], const struct lattice_state *t, double *value)
{
    int64_t gid = nearest(s->solid->cells, at), bits[12] = {0};
    for (int64_t i = 0; i < t->n; i++) {
        if (t->gid[i] != gid) continue;
        double x[3];
        for (int a = 0; a < 3; a++) x[a] = t->centre[i][a] + t->u[i][a];
        memcpy(bits, x, sizeof x);
        memcpy(bits + 3, t->u[i], sizeof x);
        memcpy(bits + 6, t->v[i], sizeof x);
        memcpy(bits + 9, t->w[i], sizeof x);
    }
    comm_sum_i64(s->comm, bits, 12);
    memcpy(value, bits, sizeof bits);
}

void lattice_method_measure(struct sim *s, const bool *due, double (*value)[MEASURE_COLUMNS])
{
    struct lattice_state *t = lattice_state_create(s);
    for (int i = 0; i < s->scene->n_measure; i++)
        if (due[i]) measure_probe(s, s->scene->measure[i].at, t, value[i]);
    lattice_state_free(t);
}
