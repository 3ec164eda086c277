/* Creates the lattice on the device: owners of the cells, their layout in memory, tables and
 * kernels. */
#include "lattice.h"

#include <stdlib.h>

#include "kernels/lattice/lattice_words.h"
#include "comm/fail.h"
#include "device/buffers.h"
#include "lattice_break.h"
#include "lattice_owners.h"

static const char *const sources[] = {"link_force.cl", "lattice_pack.cl", NULL};
static const char *const sources_volume[] = {
    "link_force.cl", "link_volume.cl", "lattice_pack.cl", NULL};

#define ROW(member, name)                                                                          \
    {                                                                                              \
        "lattice " name, offsetof(struct lattice, member)                                          \
    }
static const struct buffer_spec buffers[] = {ROW(x, "x"), ROW(v, "v"), ROW(sum_x, "sums of x"),
    ROW(sum_v, "sums of v"), ROW(pressure, "pressure"), ROW(ledger, "ledger"), ROW(word, "words"),
    ROW(row, "rows"), ROW(info, "runs"), ROW(base, "bases"), ROW(force_list, "forces"),
    ROW(volume_list, "volumes"), ROW(link, "links"), ROW(cell, "kinds"), ROW(kick, "kicks"),
    ROW(share, "places of shares"), ROW(shares, "shares"), {0}};
#undef ROW

static void put_table(struct lattice *l, struct buffer *buffer, double *value, int64_t n)
{
    reals_put(buffer, l->features.real_is_float, (size_t)n, value);
    free(value);
}

static void create_state(struct lattice *l)
{
    size_t n = (size_t)l->layout->plane, n_x = LATTICE_X(l->features.turn),
           n_set = l->features.rk ? 3 : 2, x = lattice_x_bytes(l), v = lattice_v_bytes(l);
    size_t n_last = l->features.energy && l->features.nystrom ? LATTICE_V : 0,
           n_p = l->features.energy && l->features.link_damping ? 2 : 1;
    const struct {
        struct buffer *buffer;
        size_t bytes;
    } state[] = {{&l->x, n_set * n_x * n * x}, {&l->v, n_set * LATTICE_V * n * v},
        {&l->sum_x, l->features.rk ? 9 * n * x : 0},
        {&l->sum_v, l->features.rk ? (LATTICE_V + n_last) * n * v : 0},
        {&l->pressure, l->features.volume ? n_p * n * v : 0},
        {&l->ledger, l->features.energy ? LATTICE_LEDGER * n * sizeof(double) : 0}};
    for (size_t k = 0; k < sizeof state / sizeof *state; k++) {
        buffer_reserve(state[k].buffer, state[k].bytes);
        buffer_zero(state[k].buffer);
    }
}

static void create_tables(struct lattice *l, const struct lattice_cells *cells)
{
    const struct lattice_layout *c = l->layout;
    int n = cells->n_kind;
    const struct {
        struct buffer *buffer;
        const int *value;
        int64_t n;
    } list[] = {{&l->word, c->word, c->plane}, {&l->row, c->row, c->plane},
        {&l->info, c->info, c->n_run}, {&l->base, c->base, 4 * (int64_t)c->n_run},
        {&l->force_list, c->force, c->n_force}, {&l->volume_list, c->volume, c->n_volume},
        {&l->share, c->share, l->features.shares ? c->plane : 0}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++)
        buffer_put(list[k].buffer, (size_t)list[k].n * sizeof *list[k].value, list[k].value);
    put_table(l, &l->link, lattice_features_links(cells, &l->options), (int64_t)n * n * LINK_WIDTH);
    put_table(l, &l->cell, lattice_features_cells(cells, &l->options), (int64_t)n * CELL_WIDTH);
    if (l->features.shares)
        put_table(l, &l->shares, lattice_features_shares(cells, &l->options),
            (int64_t)cells->n_share * SHARE_WIDTH);
    if (l->features.rk) put_table(l, &l->kick, fail_alloc(sizeof(double)), 1);
    else
        put_table(l, &l->kick, lattice_features_kicks(cells, &l->options),
            (int64_t)(l->scheme->n + 2) * n * KICK_WIDTH);
    lattice_rows_create(l);
}

/* At rest in place, then the cells' velocities. */
static void first_state(struct lattice *l, const struct lattice_cells *cells)
{
    int64_t n = l->layout->n_owned, plane = l->layout->plane;
    struct lattice_motion m = {.v = cells->v ? fail_alloc((size_t)n * sizeof *m.v) : NULL,
        .w = cells->w ? fail_alloc((size_t)n * sizeof *m.w) : NULL};
    double *one = fail_alloc((size_t)plane * sizeof *one);
    for (int64_t i = 0; i < plane; i++) one[i] = 1;
    /* no rotation, also of what is not there */
    for (int set = 0; set < (l->features.rk ? 3 : 2) && l->features.turn; set++) {
        reals_write(&l->x, l->features.position_is_float, (size_t)((7 * set + 3) * plane),
            (size_t)plane, one);
    }
    for (int64_t k = 0; k < n; k++)
        for (int a = 0; a < 3; a++) {
            if (m.v) m.v[k][a] = cells->v[l->layout->gid[k]][a];
            if (m.w) m.w[k][a] = cells->w[l->layout->gid[k]][a];
        }
    lattice_write(l, &m);
    free(m.v);
    free(m.w);
    free(one);
}

struct lattice *lattice_create(struct device *dev, const struct comm *comm,
    const struct lattice_cells *cells, const struct lattice_options *options)
{
    struct lattice *l = fail_alloc(sizeof *l);
    l->dev = dev;
    l->timers = &l->unread;
    l->comm = comm;
    l->options = *options;
    l->scheme = lattice_schemes_table(options->scheme);
    l->features = lattice_features_of(cells, options);
    l->n_global = cells->n;
    l->n_kind = cells->n_kind;
    struct lattice_lay run = options->run.length > 0 ? options->run : lattice_layout_run(cells);
    int *owner = lattice_owners(comm, cells, options, run.axis);
    l->layout = lattice_layout_create(
        cells, owner, comm->rank, comm->n_rank, run, l->features.volume ? 2 : 1);
    char *text = lattice_features_options(&l->features, l->layout);
    l->program =
        program_build(dev, comm, "lattice", text, l->features.volume ? sources_volume : sources);
    free(text);
    buffers_init(dev, l, buffers);
    create_state(l);
    create_tables(l, cells);
    l->force = lattice_launch(l, l->program, "link_force", &l->force_list);
    if (l->features.volume)
        l->volume = lattice_launch(l, l->program, "link_volume", &l->volume_list);
    if (l->scheme->first > 0)
        l->first = lattice_launch(l, l->program, "lattice_first", &l->force_list);
    if (comm->n_rank > 1)
        l->halo = lattice_halo_create(comm, l->program, l->layout,
            (struct lattice_planes){&l->x, LATTICE_X(l->features.turn), lattice_x_bytes(l)},
            (struct lattice_planes){
                &l->v, l->features.link_damping ? LATTICE_V : 0, lattice_v_bytes(l)},
            l->features.breakage ? &l->word : NULL);
    l->part =
        lattice_owners_part(cells, owner, comm->rank, l->halo ? l->halo->exchange.halo->n_send : 0);
    free(owner);
    if (l->features.breakage) l->breakage = lattice_break_create(l, cells);
    first_state(l, cells);
    return l;
}

void lattice_free(struct lattice *l)
{
    if (!l) return;
    device_finish(l->dev);
    lattice_halo_free(l->halo);
    lattice_break_free(l->breakage);
    lattice_rows_free(l);
    launch_free(l->force);
    launch_free(l->volume);
    launch_free(l->first);
    program_free(l->program);
    buffers_free(l, buffers);
    lattice_layout_free(l->layout);
    free(l);
}
