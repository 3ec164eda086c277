/* What the lattice method measures. */
#include "lattice_method.h"

#include <math.h>
#include <string.h>

#include "comm/fail.h"

int lattice_method_measure_columns(enum measure_kind kind, const struct series_column **column)
{
    static const struct series_column probe[] = {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"u_x", "m"},
        {"u_y", "m"}, {"u_z", "m"}, {"v_x", "m/s"}, {"v_y", "m/s"}, {"v_z", "m/s"},
        {"w_x", "rad/s"}, {"w_y", "rad/s"}, {"w_z", "rad/s"}};
    static const struct series_column energy[] = {{"kinetic", "J"}, {"rotational", "J"},
        {"gravity", "J"}, {"elastic", "J"}, {"link_damping", "J"}, {"mass_damping", "J"},
        {"released", "J"}, {"work", "J"}, {"balance", "J"}};
    static const struct series_column momentum[] = {{"p_x", "N s"}, {"p_y", "N s"}, {"p_z", "N s"},
        {"l_x", "N m s"}, {"l_y", "N m s"}, {"l_z", "N m s"}};
    static const struct series_column peak[] = {
        {"von_mises", "Pa"}, {"x", "m"}, {"y", "m"}, {"z", "m"}};
    static const struct series_column broken[] = {
        {"tension", "1"}, {"shear", "1"}, {"bending", "1"}, {"twist", "1"}};
    if (kind == MEASURE_BROKEN) {
        *column = broken;
        return LATTICE_BREAK_MODES;
    }
    *column = kind == MEASURE_ENERGY       ? energy
              : kind == MEASURE_MOMENTUM   ? momentum
              : kind == MEASURE_STRESS_MAX ? peak
                                           : probe;
    return kind == MEASURE_ENERGY       ? 9
           : kind == MEASURE_STRESS_MAX ? 4
           : kind == MEASURE_MOMENTUM   ? 6
                                        : 12;
}

/* The cell whose centre at the start is nearest, the first of several; the same on every rank. */
static int64_t nearest(const struct lattice_cells *cells, const double at[3])
{
    int64_t best = 0;
    double least = HUGE_VAL, x[3];
    for (int64_t i = 0; i < cells->n; i++) {
        lattice_cells_centre(cells, i, x);
        double d = (x[0] - at[0]) * (x[0] - at[0]) + (x[1] - at[1]) * (x[1] - at[1]) +
                   (x[2] - at[2]) * (x[2] - at[2]);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    return best;
}

/* The cell's owner gives the bits, the others zeros. */
static void measure_probe(
    struct sim *s, const double at[3], const struct lattice_state *t, double *value)
{
    int64_t gid = nearest(s->lattice->cells, at), bits[12] = {0};
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

/* The largest von Mises stress, and the centre at the start of the cell that has it, the first of
 * several. */
static void measure_peak(struct sim *s, const struct lattice_state *t, double *value)
{
    double largest = -1;
    int64_t gid = INT64_MAX;
    for (int64_t i = 0; i < t->n; i++) largest = fmax(largest, t->von_mises[i]);
    comm_max_f64(s->comm, &largest, 1);
    for (int64_t i = t->n; i-- > 0;)
        if (t->von_mises[i] >= largest) gid = t->gid[i];
    comm_min_i64(s->comm, &gid, 1);
    value[0] = gid == INT64_MAX ? (double)NAN : largest;
    if (gid < INT64_MAX) lattice_cells_centre(s->lattice->cells, gid, value + 1);
}

static void measure_broken(const struct sim *s, double *value)
{
    int64_t count[LATTICE_BREAK_MODES] = {0};
    if (s->lattice->lattice->breakage) lattice_break_count(s->lattice->lattice->breakage, count);
    for (int mode = 0; mode < LATTICE_BREAK_MODES; mode++) value[mode] = (double)count[mode];
}

void lattice_method_measure(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS])
{
    bool by_cell = false, by_energy = false;
    for (int i = 0; i < s->scene->n_measure; i++) {
        bool is_energy = s->scene->measure[i].kind == MEASURE_ENERGY ||
                         s->scene->measure[i].kind == MEASURE_MOMENTUM;
        by_energy |= due[i] && is_energy;
        by_cell |= due[i] && !is_energy && s->scene->measure[i].kind != MEASURE_BROKEN;
    }
    struct lattice_energy e = {.kinetic = 0};
    if (by_energy) lattice_energy_now(s->lattice->account, &e);
    struct lattice_state *t = by_cell ? lattice_state_create(s) : NULL;
    const double energy[] = {e.kinetic, e.rotational, e.gravity, e.elastic, e.links, e.mass,
        e.released, e.work, lattice_energy_balance(&s->lattice->energy_start, &e)};
    for (int i = 0; i < s->scene->n_measure; i++) {
        const struct measure *what = &s->scene->measure[i];
        if (!due[i]) continue;
        if (what->kind == MEASURE_ENERGY) memcpy(value[i], energy, sizeof energy);
        else if (what->kind == MEASURE_STRESS_MAX) measure_peak(s, t, value[i]);
        else if (what->kind == MEASURE_BROKEN) measure_broken(s, value[i]);
        else if (what->kind == MEASURE_PROBE) measure_probe(s, what->at, t, value[i]);
        else {
            memcpy(value[i], e.momentum, sizeof e.momentum);
            memcpy(value[i] + 3, e.angular, sizeof e.angular);
        }
    }
    lattice_state_free(t);
}
