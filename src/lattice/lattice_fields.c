#include "lattice_fields.h"

#include <stddef.h>
#include <string.h>

#include "comm/fail.h"
#include "kernels/lattice/lattice_words.h"
#include "run/resume.h"
#include "scene/output_fields.h"

struct field_row {
    const char *name, *unit, *text;
    int width;
    enum column_type type;
    enum output_fields_use use;
    bool (*is_there)(const struct lattice_run *run);
    /* One of: 1 + offset of the array in struct lattice_state; a function that gives the number of
     * one cell of this rank by its number among all. */
    size_t at;
    int32_t (*make)(const struct sim *s, int64_t cell);
};

static bool is_there_any(const struct lattice_run *r)
{
    (void)r;
    return true;
}

static bool is_there_turn(const struct lattice_run *r)
{
    return r->lattice->features.turn;
}

static bool is_there_small(const struct lattice_run *r)
{
    return !r->lattice->features.turn;
}

static bool is_there_kick(const struct lattice_run *r)
{
    return r->lattice->scheme->ends_with_kick;
}

static bool is_there_energy(const struct lattice_run *r)
{
    return r->lattice->features.energy;
}

static bool is_there_breakage(const struct lattice_run *r)
{
    return r->lattice->breakage;
}

static bool is_there_release(const struct lattice_run *r)
{
    return r->lattice->features.energy && r->lattice->breakage;
}

static bool is_there_stress(const struct lattice_run *r)
{
    return r->stress;
}

static int32_t make_body(const struct sim *s, int64_t cell)
{
    return s->lattice->cells->body[cell];
}

static int32_t make_material(const struct sim *s, int64_t cell)
{
    const struct lattice_cells *c = s->lattice->cells;
    return c->kind[c->kind_of[cell]].material;
}

static int32_t make_owner(const struct sim *s, int64_t cell)
{
    (void)cell;
    return s->comm->rank;
}

#define CELL(member) .at = 1 + offsetof(struct lattice_state, member)
#define MADE(function) .make = make_##function
#define FIELD_ROW(name_, unit_, width_, type_, use_, when_, source_, text_)                        \
    {.name = #name_,                                                                               \
        .unit = unit_,                                                                             \
        .text = text_,                                                                             \
        .width = width_,                                                                           \
        .type = COLUMN_##type_,                                                                    \
        .use = OUTPUT_FIELDS_##use_,                                                               \
        .is_there = is_there_##when_,                                                              \
        source_},

static const struct field_row field_row[] = {OUTPUT_FIELDS_LATTICE(FIELD_ROW)};
enum { N_ROW = sizeof field_row / sizeof *field_row };

static bool is_state(const struct sim *s, const struct field_row *row)
{
    return row->use & OUTPUT_FIELDS_STATE && row->is_there(s->lattice);
}

static const void *array_of(const struct lattice_state *state, const struct field_row *row)
{
    return *(void *const *)(const void *)((const char *)state + row->at - 1);
}

static void add(const struct sim *s, struct sheet *sheet, const struct lattice_state *state,
    const struct field_row *row)
{
    const void *data = row->at ? array_of(state, row) : NULL;
    if (row->make) {
        int32_t *value = sheet_keep(sheet, fail_alloc((size_t)state->n * sizeof *value));
        for (int64_t i = 0; i < state->n; i++) value[i] = row->make(s, state->gid[i]);
        data = value;
    }
    sheet_add(sheet, row->name, row->unit, row->text, row->type, row->width, data);
}

void lattice_fields_show(
    const struct sim *s, struct sheet *sheet, const struct lattice_state *state)
{
    for (int i = 0; i < s->scene->output.n_field; i++)
        for (int k = 0; k < N_ROW; k++)
            if (field_row[k].use & OUTPUT_FIELDS_SHOWN && field_row[k].is_there(s->lattice) &&
                !strcmp(field_row[k].name, s->scene->output.field[i]))
                add(s, sheet, state, &field_row[k]);
}

void lattice_fields_state(
    const struct sim *s, struct sheet *sheet, const struct lattice_state *state)
{
    for (int k = 0; k < N_ROW; k++)
        if (is_state(s, &field_row[k])) add(s, sheet, state, &field_row[k]);
}

void lattice_fields_read(const struct sim *s, struct frame_table *table)
{
    for (int k = 0; k < N_ROW; k++)
        if (is_state(s, &field_row[k]))
            frame_table_add(
                table, s->from->reader, field_row[k].name, field_row[k].type, field_row[k].width);
}

struct lattice_state lattice_fields_rows(const struct sim *s, const struct frame_table *table)
{
    struct lattice_state state = {.n = table->n};
    for (int k = 0; k < N_ROW; k++)
        if (is_state(s, &field_row[k])) {
            void *data = frame_table_get(table, field_row[k].name);
            memcpy((char *)&state + field_row[k].at - 1, &data, sizeof data);
        }
    return state;
}

bool lattice_fields_need_stress(char *const *field, int n)
{
    bool need = false;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < N_ROW; k++)
            need |=
                field_row[k].is_there == is_there_stress && !strcmp(field_row[k].name, field[i]);
    return need;
}
