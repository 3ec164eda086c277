#include "record_reader.h"

#include "comm/fail.h"
#include "kernels/particle/incidence.h"

enum {
    POSITION,
    INCIDENCE_BEGIN,
    INCIDENCE,
    WALL_BEGIN,
    FORCE,
    TORQUE,
    REFERENCE,
    FLAGS,
    ORIENTATION,
    NOTHING,
    N_BUFFER
};

void reader_open(struct reader *r, struct device *dev, const struct features *features)
{
    static const char *const sources[] = {"gather.cl", NULL};
    static const char *const value[] = {
        "gravity_x", "gravity_y", "gravity_z", "dt", "half_dt", "margin_dt", "radius", "inverse_m"};
    r->dev = dev;
    r->program = fixture_program(dev, features, FEATURES_BODY, sources);
    r->gather = launch_create(r->program, "gather");
    for (int k = 0; k < 8; k++) launch_set_real_if(r->gather, value[k], k < 6 ? 0 : 1);
    launch_set_int(r->gather, "observe", 1);
}

void reader_close(struct reader *r)
{
    launch_free(r->gather);
    program_free(r->program);
}

/* Elements 2 p and 2 p + 1 are the two ends of pair p and of nothing else; the others have one wall
 * contact each. */
static void set_lists(struct reader *r, int n_pair, int n_wall)
{
    size_t n = (size_t)(2 * n_pair + n_wall), bytes = (n + 1) * sizeof(int),
           n_end = 2 * (size_t)n_pair;
    int *begin = fail_alloc(bytes), *wall_begin = fail_alloc(bytes),
        *incidence = fail_alloc(n_end * INCIDENCE_ALIGN * sizeof(int));
    for (size_t e = 0; e <= n; e++) {
        begin[e] = (int)(INCIDENCE_ALIGN * (e < n_end ? e : n_end));
        wall_begin[e] = e > n_end ? (int)(e - n_end) : 0;
    }
    for (size_t k = 0; k < n_end * INCIDENCE_ALIGN; k++)
        incidence[k] = k % INCIDENCE_ALIGN ? 2 * n_pair : (int)(k / INCIDENCE_ALIGN);
    fixture_bind(r->dev, r->gather, &r->buffer[INCIDENCE_BEGIN], "incidence_begin", bytes, begin);
    fixture_bind(r->dev, r->gather, &r->buffer[INCIDENCE], "incidence",
        n_end * INCIDENCE_ALIGN * sizeof(int), incidence);
    fixture_bind(r->dev, r->gather, &r->buffer[WALL_BEGIN], "wall_begin", bytes, wall_begin);
    free(begin);
    free(wall_begin);
    free(incidence);
}

void reader_read(struct reader *r, struct buffer *pair_result, int n_pair,
    struct buffer *wall_result, int n_wall, struct reading *out)
{
    size_t n = (size_t)(2 * n_pair + n_wall);
    struct record *element = fail_alloc(n * sizeof *element);
    real *vector = fail_alloc(4 * n * sizeof *vector);
    for (size_t e = 0; e < n; e++) element[e].radius = 1;
    set_lists(r, n_pair, n_wall);
    fixture_bind(r->dev, r->gather, &r->buffer[POSITION], "position", n * sizeof *element, element);
    launch_bind_buffer(r->gather, "motion", &r->buffer[POSITION]);
    fixture_bind(r->dev, r->gather, &r->buffer[FORCE], "force", 4 * n * sizeof(real), NULL);
    fixture_bind(r->dev, r->gather, &r->buffer[TORQUE], "torque", 4 * n * sizeof(real), vector);
    fixture_bind(r->dev, r->gather, &r->buffer[REFERENCE], "reference", 64, NULL);
    fixture_bind(r->dev, r->gather, &r->buffer[FLAGS], "flags", 64, NULL);
    fixture_bind(r->dev, r->gather, &r->buffer[ORIENTATION], "orientation", 64, NULL);
    fixture_buffer(r->dev, &r->buffer[NOTHING], "nothing", 64, NULL);
    launch_bind_buffer(r->gather, "result", pair_result ? pair_result : &r->buffer[NOTHING]);
    launch_bind_buffer_if(
        r->gather, "wall_result", wall_result ? wall_result : &r->buffer[NOTHING]);
    launch_set_count(r->gather, "n_owned", n);
    launch_run(r->gather, (int64_t)n);
    for (int which = 0; which < 2; which++) {
        buffer_read(&r->buffer[which ? TORQUE : FORCE], 0, 4 * n * sizeof *vector, vector);
        for (size_t e = 0; e < n; e++)
            memcpy(which ? out[e].torque : out[e].force, vector + 4 * e, sizeof out[e].force);
    }
    for (int b = 0; b < N_BUFFER; b++) buffer_free(&r->buffer[b]);
    free(element);
    free(vector);
}
