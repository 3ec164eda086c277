#include "lattice_stress.h"

#include <stdlib.h>

#include "comm/fail.h"
#include "lattice_observed.h"

enum { VON_MISES = 6, N_PLANE };

struct lattice_stress {
    struct lattice *l;
    struct program *program;
    struct launch *launch;
    struct buffer stress;
};

struct lattice_stress *lattice_stress_create(struct lattice *l, bool extrapolate)
{
    static const char *const source[] = {"link_stress.cl", NULL};
    struct lattice_stress *s = fail_alloc(sizeof *s);
    char *text = lattice_features_options(&l->features, l->layout);
    s->l = l;
    s->program = program_build(l->dev, l->comm, "stress", text, source);
    free(text);
    buffer_init(&s->stress, l->dev, "lattice stress");
    buffer_reserve(&s->stress, N_PLANE * (size_t)l->layout->plane * lattice_v_bytes(l));
    s->launch = lattice_launch(l, s->program, "link_stress", &l->force_list);
    launch_bind_buffer(s->launch, "stress", &s->stress);
    launch_set_int(s->launch, "n", l->layout->n_force);
    launch_set_int(s->launch, "extrapolate", extrapolate);
    return s;
}

void lattice_stress_free(struct lattice_stress *s)
{
    if (!s) return;
    device_finish(s->l->dev);
    launch_free(s->launch);
    program_free(s->program);
    buffer_free(&s->stress);
    free(s);
}

void lattice_stress_run(struct lattice_stress *s, double (*stress)[9], double *von_mises)
{
    static const int plane_of[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2}; /* of xx, yy, zz, yz, zx, xy */
    struct lattice *l = s->l;
    lattice_observed_refresh(l, true);
    lattice_observed_bind(l, s->launch);
    launch_run(s->launch, (int64_t)l->layout->n_force * l->layout->run);
    for (int p = 0; p < N_PLANE; p++) {
        if (p == VON_MISES ? !von_mises : !stress) continue;
        double *value = lattice_read_plane(l, &s->stress, l->features.real_is_float, p);
        for (int64_t k = 0; k < l->layout->n_owned; k++) {
            if (p == VON_MISES) von_mises[k] = value[k];
            for (int c = 0; c < 9; c++)
                if (plane_of[c] == p) stress[k][c] = value[k];
        }
        free(value);
    }
}
