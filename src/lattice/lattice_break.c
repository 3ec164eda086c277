#include "lattice_break.h"

#include <stdlib.h>
#include <string.h>

#include "kernels/lattice/lattice_words.h"
#include "comm/fail.h"
#include "device/buffers.h"

struct lattice_break {
    struct lattice *l;
    struct program *program;
    struct launch *judge, *sever; /* judge: NULL where no link has a limit of its own */
    struct buffer limit, fate;
    struct program *program_principal; /* NULL: no cell has a limit */
    struct launch *follow, *principal;
    struct buffer inverse, lot, due;
    struct program *program_release; /* NULL: released energy is not asked for */
    struct launch *release;
    struct buffer fresh, released;
};

static const struct buffer_spec buffers[] = {
    {"lattice strengths", offsetof(struct lattice_break, limit)},
    {"lattice fates", offsetof(struct lattice_break, fate)},
    {"lattice limits of cells", offsetof(struct lattice_break, inverse)},
    {"lattice lots", offsetof(struct lattice_break, lot)},
    {"lattice links due", offsetof(struct lattice_break, due)},
    {"lattice fresh breaks", offsetof(struct lattice_break, fresh)},
    {"lattice released", offsetof(struct lattice_break, released)}, {0}};

/* Shares of the links' energy that are released at the step's start and at its end
 * (kernels/lattice/link_release.cl). */
static double share_before(const struct lattice *l)
{
    return l->scheme->ends_with_kick ? l->scheme->op[0].end : 0;
}

static void create_release(struct lattice_break *b)
{
    static const char *const source[] = {"link_release.cl", NULL};
    struct lattice *l = b->l;
    size_t n = (size_t)l->layout->plane;
    if (!l->features.energy) return;
    char *text = lattice_features_options(&l->features, l->layout),
         *options = fail_format("%s -DWITH_SUMS=1", text);
    b->program_release = program_build(l->dev, l->comm, "release", options, source);
    free(text);
    free(options);
    buffer_reserve(&b->fresh, n * sizeof(int32_t));
    buffer_zero(&b->fresh);
    buffer_reserve(&b->released, n * sizeof(double));
    buffer_zero(&b->released);
    b->release = lattice_launch(l, b->program_release, "link_release", &l->force_list);
    launch_bind_buffer(b->release, "fate", &b->fate);
    launch_set_real(b->release, "before", share_before(l));
    launch_set_int(b->release, "n", l->layout->n_force);
    lattice_break_bind(b, b->release);
}

void lattice_break_bind(const struct lattice_break *b, struct launch *launch)
{
    launch_bind_buffer(launch, "fresh", &b->fresh);
    launch_bind_buffer(launch, "released", &b->released);
    launch_set_real(launch, "after", 1 - share_before(b->l));
}

/* Links judged one by one, if any of them has a limit. */
static void create_judge(struct lattice_break *b, const struct lattice_cells *cells)
{
    struct lattice *l = b->l;
    int64_t n = (int64_t)l->n_kind * l->n_kind * BREAK_WIDTH;
    double *limit = lattice_features_limits(cells, &l->options);
    bool any = false;
    for (int64_t k = 0; k < n; k++) any |= k % BREAK_WIDTH < BREAK_CRITERION && limit[k] > 0;
    if (any) {
        reals_put(&b->limit, l->features.real_is_float, (size_t)n, limit);
        b->judge = lattice_launch(l, b->program, "link_break", NULL);
        launch_bind_buffer(b->judge, "limit", &b->limit);
        launch_bind_buffer(b->judge, "fate", &b->fate);
        launch_set_int(b->judge, "n", l->layout->n_run - 2);
    }
    free(limit);
}

static void put_lots(struct lattice_break *b, const struct lattice_cells *cells)
{
    const struct lattice_layout *c = b->l->layout;
    double *lot = fail_alloc((size_t)c->plane * sizeof *lot);
    for (int64_t k = 0; k < c->n_owned; k++)
        lot[c->index[k]] = lattice_features_lot(cells, &b->l->options, c->gid[k]);
    reals_put(&b->lot, b->l->features.real_is_float, (size_t)c->plane, lot);
    free(lot);
}

/* Cells judged by their stress. */
static void create_principal(struct lattice_break *b, const struct lattice_cells *cells)
{
    static const char *const source[] = {"link_principal.cl", NULL};
    struct lattice *l = b->l;
    if (!l->features.principal) return;
    char *text = lattice_features_options(&l->features, l->layout);
    double *inverse = lattice_features_principal(cells, &l->options);
    b->program_principal = program_build(l->dev, l->comm, "principal stress", text, source);
    reals_put(&b->inverse, l->features.real_is_float, 2 * (size_t)l->n_kind, inverse);
    free(inverse);
    free(text);
    put_lots(b, cells);
    buffer_reserve(&b->due, (size_t)l->layout->plane * sizeof(int32_t));
    buffer_zero(&b->due);
    b->follow = lattice_launch(l, b->program_principal, "link_due", NULL);
    launch_bind_buffer(b->follow, "fate", &b->fate);
    launch_set_int(b->follow, "n", l->layout->n_run - 2);
    b->principal = lattice_launch(l, b->program_principal, "link_judge", &l->force_list);
    launch_bind_all(b->principal, (const struct launch_binding[]){{"inverse", &b->inverse},
                                      {"lot", &b->lot}, {"fate", &b->fate}, {"due", &b->due}, {0}});
    launch_set_int(b->principal, "n", l->layout->n_force);
    launch_bind_buffer(b->sever, "due", &b->due);
}

struct lattice_break *lattice_break_create(struct lattice *l, const struct lattice_cells *cells)
{
    static const char *const source[] = {"link_break.cl", NULL};
    struct lattice_break *b = fail_alloc(sizeof *b);
    char *text = lattice_features_options(&l->features, l->layout);
    b->l = l;
    b->program = program_build(l->dev, l->comm, "breakage", text, source);
    free(text);
    buffers_init(l->dev, b, buffers);
    buffer_reserve(&b->fate, (size_t)l->layout->plane * sizeof(int32_t));
    buffer_zero(&b->fate);
    b->sever = lattice_launch(l, b->program, "link_sever", &l->force_list);
    launch_bind_buffer(b->sever, "fate", &b->fate);
    launch_set_int(b->sever, "n", l->layout->n_force);
    create_judge(b, cells);
    create_principal(b, cells);
    create_release(b);
    return b;
}

void lattice_break_free(struct lattice_break *b)
{
    if (!b) return;
    device_finish(b->l->dev);
    launch_free(b->judge);
    launch_free(b->sever);
    launch_free(b->follow);
    launch_free(b->principal);
    launch_free(b->release);
    program_free(b->program);
    program_free(b->program_principal);
    program_free(b->program_release);
    buffers_free(b, buffers);
    free(b);
}

/* launch: NULL is fine */
static void run_at(struct launch *launch, int64_t x_in, int64_t v_in, int64_t n)
{
    if (!launch) return;
    launch_set_long(launch, "x_in", x_in);
    launch_set_long(launch, "v_in", v_in);
    launch_run(launch, n);
}

void lattice_break_judge(struct lattice_break *b, int64_t x_in, int64_t v_in)
{
    const struct lattice_layout *c = b->l->layout;
    int64_t n_all = (int64_t)(c->n_run - 2) * c->run, n_own = (int64_t)c->n_force * c->run;
    run_at(b->judge, x_in, v_in, n_all);
    if (b->follow) launch_run(b->follow, n_all);
    run_at(b->principal, x_in, v_in, n_own);
    run_at(b->release, x_in, v_in, n_own);
}

void lattice_break_sever(struct lattice_break *b)
{
    const struct lattice_layout *c = b->l->layout;
    launch_run(b->sever, (int64_t)c->n_force * c->run);
}

const char *lattice_break_name(int mode)
{
    static const char *const name[LATTICE_BREAK_MODES] = {"tension", "shear", "bending", "twist"};
    return name[mode];
}

static void read_ints(
    const struct lattice *l, const struct buffer *buffer, int32_t mask, int32_t *value)
{
    size_t bytes = (size_t)l->layout->plane * sizeof(int32_t);
    int32_t *raw = fail_alloc(bytes);
    buffer_read(buffer, 0, bytes, raw);
    for (int64_t k = 0; k < l->layout->n_owned; k++) value[k] = raw[l->layout->index[k]] & mask;
    free(raw);
}

void lattice_break_read(const struct lattice_break *b, int32_t *links, int32_t *fate)
{
    if (links) read_ints(b->l, &b->l->word, CELL_LINKS, links);
    if (!fate) return;
    int64_t n = b->l->layout->n_owned;
    int32_t *word = fail_alloc((size_t)n * sizeof *word);
    read_ints(b->l, &b->fate, -1, fate);
    read_ints(b->l, &b->l->word, -1, word);
    for (int64_t k = 0; k < n; k++) fate[k] |= WORD_DUE(word[k]) << FATE_DUE_AT;
    free(word);
}

/* Bits of the mask, the others stay. */
static void write_ints(struct lattice *l, struct buffer *buffer, int32_t mask, const int32_t *value)
{
    size_t bytes = (size_t)l->layout->plane * sizeof(int32_t);
    int32_t *raw = fail_alloc(bytes);
    buffer_read(buffer, 0, bytes, raw);
    for (int64_t k = 0; k < l->layout->n_owned; k++)
        raw[l->layout->index[k]] = (raw[l->layout->index[k]] & ~mask) | (value[k] & mask);
    buffer_write(buffer, 0, bytes, raw);
    free(raw);
}

void lattice_break_write(struct lattice_break *b, const int32_t *links, const int32_t *fate)
{
    int64_t n = b->l->layout->n_owned;
    int32_t due = 63 << WORD_DUE_AT, modes = (1 << FATE_DUE_AT) - 1,
            *word = fail_alloc((size_t)n * sizeof *word);
    for (int64_t k = 0; k < n; k++) word[k] = links[k] | fate[k] >> FATE_DUE_AT << WORD_DUE_AT;
    write_ints(b->l, &b->l->word, CELL_LINKS | due, word);
    write_ints(b->l, &b->fate, modes, fate);
    free(word);
}

void lattice_break_read_release(const struct lattice_break *b, int32_t *fresh, double *released)
{
    double *plane = lattice_read_plane(b->l, &b->released, false, 0);
    memcpy(released, plane, (size_t)b->l->layout->n_owned * sizeof *released);
    read_ints(b->l, &b->fresh, -1, fresh);
    free(plane);
}

void lattice_break_write_release(
    struct lattice_break *b, const int32_t *fresh, const double *released)
{
    write_ints(b->l, &b->fresh, -1, fresh);
    lattice_write_plane(b->l, &b->released, false, 0, released, 1);
}

void lattice_break_count(const struct lattice_break *b, int64_t count[LATTICE_BREAK_MODES])
{
    int64_t n = b->l->layout->n_owned;
    int32_t *fate = fail_alloc((size_t)n * sizeof *fate);
    for (int mode = 0; mode < LATTICE_BREAK_MODES; mode++) count[mode] = 0;
    lattice_break_read(b, NULL, fate);
    for (int64_t k = 0; k < n; k++)
        for (int axis = 0; axis < 3; axis++)
            if (FATE_MODE(fate[k], axis)) count[FATE_MODE(fate[k], axis) - 1]++;
    free(fate);
    comm_sum_i64(b->l->comm, count, LATTICE_BREAK_MODES);
}
