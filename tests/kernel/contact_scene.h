/* Contacts of two materials with whatever the flags of this test say, through the driver's own
 * table (contact_table.h), as the laws take them. */
#ifndef CONTACT_SCENE_H
#define CONTACT_SCENE_H

#include "kernel_fixture.h"
#include "kernels/contact/contact_memory.h"
#include "particle/contact_table.h"

enum { N_MATERIAL = 2 };
#define STEP 1e-5 /* [s] */

/* Material 0 with itself has all that the flags offer; other pairs differ, where there is a table
 * to tell them by. */
static inline struct contact contact_scene_contact(int a, int b)
{
    int k = a + b;
    struct contact c = {.between = {a, b},
        .attraction = !(WITH_NO_ATTRACTION && k != 1),
        .damping_ratio = 0.2 + 0.1 * k};
    c.normal_law = WITH_HERTZ && (!WITH_LINEAR || k == 1) ? NORMAL_HERTZ : NORMAL_LINEAR;
    c.stiffness = 1e4 + 3e3 * k;
    c.has_tangential = WITH_TANGENTIAL && k != 2;
    c.stiffness_ratio = k == 1 ? -1 : 0.8;
    if (c.normal_law == NORMAL_LINEAR) c.stiffness_ratio = 0.8;
    c.tangential_damping = WITH_TANGENTIAL_DAMPING && k != 1 ? 0.3 : 0;
    c.damping_factor = -1;
    c.friction = 0.3 + 0.1 * k;
    c.slip = WITH_WHOLE_SLIP && k != 1 ? SLIP_WHOLE : SLIP_SPRING;
    c.lever = WITH_RADIUS_LEVER && k != 1 ? LEVER_RADIUS : LEVER_CONTACT;
    c.rescale = !(WITH_NO_RESCALE && (k == 0 || c.normal_law == NORMAL_HERTZ));
    c.cap = WITH_CAP_MAGNITUDE && k != 1 ? CAP_MAGNITUDE : CAP_COMPRESSION;
    c.rolling = WITH_ROLLING_EPSD && k != 1 ? ROLLING_EPSD
                : WITH_ROLLING_CDT          ? ROLLING_CDT
                                            : ROLLING_NONE;
    c.rolling_friction = 0.1;
    c.rolling_stiffness = 2.25;
    c.rolling_damping = 0.2;
    c.binding_force = WITH_BINDING && k != 2 && !(WITH_JKR && k == 1) ? 0.1 : 0;
    c.adhesion_work =
        WITH_JKR && c.normal_law == NORMAL_HERTZ && !(c.binding_force > 0) ? 0.5 : 0; /* J/m2 */
    return c;
}

struct contact_scene {
    struct material material[N_MATERIAL];
    struct contact contact[3];
    struct scene scene;
};

static inline void contact_scene_init(struct contact_scene *s)
{
    static struct contact_scene empty;
    *s = empty;
    for (int k = 0; k < N_MATERIAL; k++)
        s->material[k] = (struct material){
            .density = 2000 + 3000 * k, .young = 1e7 + 1e7 * k, .poisson = 0.2 + 0.1 * k};
    for (int k = 0; k < 3; k++) s->contact[k] = contact_scene_contact(k / 2, (k + 1) / 2);
    s->scene = (struct scene){
        .material = s->material, .n_material = N_MATERIAL, .contact = s->contact, .n_contact = 3};
}

/* Row of all pairs of materials, as particle_setup.c makes them. width: MATERIAL_ROW or
 * PARAMETER_ROW reals. */
enum { TABLE_WIDTH = WITH_SIZES ? MATERIAL_WIDTH : PARAMETER_WIDTH };
static inline void contact_scene_row(
    const struct contact_scene *s, int a, int b, bool wall, double radius, double mass, double *row)
{
    if (WITH_SIZES) contact_table_material(&s->scene, a, b, row);
    else contact_table_parameters(&s->scene, a, b, wall, radius, mass, STEP, row);
}

/* Histories in memory and as the law has them. */
static inline vec3 contact_scene_plane(const real *history, size_t capacity, size_t at, int plane)
{
    const real *h = history + (size_t)plane * capacity + at;
    return v3(h[0], h[capacity], h[2 * capacity]);
}

static inline struct contact_history contact_scene_history(
    const int *state, const real *history, size_t capacity, size_t at)
{
    vec3 zero = v3(0, 0, 0);
    struct contact_history h = {zero, zero, 0, 0, zero, zero};
    if (WITH_HISTORY) h.state = state[at];
    if (WITH_TANGENTIAL) h.xi = contact_scene_plane(history, capacity, at, XI_AT);
    if (WITH_ROLLING_EPSD) h.theta = contact_scene_plane(history, capacity, at, THETA_AT);
    if (WITH_ENERGY) h.damping_n = history[DAMPING_N_AT * capacity + at];
    if (WITH_ENERGY && WITH_TANGENTIAL_DAMPING)
        h.damping_t = contact_scene_plane(history, capacity, at, DAMPING_T_AT);
    if (WITH_ENERGY && WITH_ROLLING)
        h.damping_r = contact_scene_plane(history, capacity, at, DAMPING_R_AT);
    return h;
}

static inline void contact_scene_same(const char *what, long at, vec3 device, vec3 host)
{
    fixture_same(what, at, device.x, host.x);
    fixture_same(what, at, device.y, host.y);
    fixture_same(what, at, device.z, host.z);
}

/* What the device has written against the law on the host. */
static inline void contact_scene_check_history(
    const int *state, const real *history, size_t capacity, size_t at, struct contact_history host)
{
    struct contact_history h = contact_scene_history(state, history, capacity, at);
    if (WITH_HISTORY) assert_int_equal(h.state, host.state);
    if (WITH_TANGENTIAL) contact_scene_same("friction spring", (long)at, h.xi, host.xi);
    if (WITH_ROLLING_EPSD) contact_scene_same("rolling angle", (long)at, h.theta, host.theta);
    if (WITH_ENERGY) fixture_same("normal dashpot", at, h.damping_n, host.damping_n);
    if (WITH_ENERGY && WITH_TANGENTIAL_DAMPING)
        contact_scene_same("tangential dashpot", (long)at, h.damping_t, host.damping_t);
    if (WITH_ENERGY && WITH_ROLLING)
        contact_scene_same("rolling moment", (long)at, h.damping_r, host.damping_r);
}

/* A ledger's share of one step [LEDGER_WIDTH]: losses add up, the elastic energy is of now. */
static inline void contact_scene_ledger(struct contact_result r, double *ledger)
{
    ledger[LEDGER_NORMAL] += (double)r.loss_n;
    ledger[LEDGER_TANGENTIAL] += (double)r.loss_t;
    ledger[LEDGER_SLIDING] += (double)r.loss_s;
    ledger[LEDGER_ROLLING] += (double)r.loss_r;
    ledger[LEDGER_BONDS] += (double)r.loss_b;
    ledger[LEDGER_ELASTIC] = (double)r.elastic;
}

#endif
