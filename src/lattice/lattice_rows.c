/* Rows of loads on their way to the device. The compute queue is in order, so one copy there is
 * enough; on the host several may wait. */
#include "lattice.h"

#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

static size_t count(const struct lattice *l)
{
    return (size_t)l->options.n_row * LOAD_WIDTH;
}

void lattice_rows_create(struct lattice *l)
{
    if (!l->features.loads) return;
    l->rows.value = fail_alloc(count(l) * sizeof *l->rows.value);
    l->rows.last = fail_alloc(count(l) * sizeof *l->rows.last);
    for (int k = 0; k < LATTICE_SLOTS; k++)
        l->rows.host[k] = fail_alloc(count(l) * lattice_v_bytes(l));
    buffer_init(&l->rows.buffer, l->dev, "lattice loads");
    buffer_reserve(&l->rows.buffer, count(l) * lattice_v_bytes(l));
}

static void settle(struct lattice *l, int slot)
{
    if (!l->rows.sent[slot]) return;
    check_cl(clWaitForEvents(1, &l->rows.sent[slot]));
    check_cl(clReleaseEvent(l->rows.sent[slot]));
    l->rows.sent[slot] = NULL;
}

void lattice_rows_free(struct lattice *l)
{
    if (!l->features.loads) return;
    for (int k = 0; k < LATTICE_SLOTS; k++) {
        settle(l, k);
        free(l->rows.host[k]);
    }
    free(l->rows.value);
    free(l->rows.last);
    buffer_free(&l->rows.buffer);
}

void lattice_rows_send(struct lattice *l, double t, double from, double to)
{
    if (!l->features.loads) return;
    size_t n = count(l);
    l->options.rows_at(l->options.context, t, from, to, l->rows.value);
    if (l->rows.n_sent > 0 && !memcmp(l->rows.value, l->rows.last, n * sizeof *l->rows.value))
        return;
    memcpy(l->rows.last, l->rows.value, n * sizeof *l->rows.value);
    int slot = (int)(l->rows.n_sent++ % LATTICE_SLOTS);
    settle(l, slot);
    if (l->features.real_is_float)
        for (size_t i = 0; i < n; i++) ((float *)l->rows.host[slot])[i] = (float)l->rows.value[i];
    else memcpy(l->rows.host[slot], l->rows.value, n * sizeof *l->rows.value);
    buffer_write_begin(&l->rows.buffer, l->dev->compute, 0, n * lattice_v_bytes(l),
        l->rows.host[slot], NULL, &l->rows.sent[slot]);
}
