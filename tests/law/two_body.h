/* Two spheres, or a sphere and a plane, under the contact law: leapfrog in the kick-drift-kick form
 * of the solver, nothing else. What the solver's kernels do with lists and buffers is done here
 * with two structs, so that a wrong number is the law's. */
#ifndef DEMOCLES_TWO_BODY_H
#define DEMOCLES_TWO_BODY_H

#include "kernels/contact/law_contact.h"

struct body {
    pvec3 x;     /* [m] */
    vec3 v, w;   /* full step [m/s], [rad/s] */
    vec3 force;  /* [N] */
    vec3 torque; /* [N m] */
    vec3 kick;   /* what the last half kick gave v and w [m/s], [rad/s] */
    vec3 spun;
    real m, r;     /* [kg], [m] */
    real mobility; /* 1; 0: held fast */
};

struct two_body {
    struct body b[2];
    int plane;    /* b[1] is the plane z = 0, elements above it; it does not move */
    vec3 gravity; /* [m/s2] */
    vec3 pull;    /* further force on b[0] [N] */
    real dt;      /* [s] */
    struct contact_parameters p;
    struct contact_history h;
    struct contact_kinematics k; /* of the last step */
    struct contact_result r;     /* of the last step */
    double lost[5];              /* dashpots n, t, sliding, rolling, bonds [J] */
};

struct body two_body_sphere(real m, real r, pvec3 x, vec3 v, vec3 w);

/* Parameters for the sizes of b and s->dt. */
void two_body_set(struct two_body *s, struct contact_material c);
void two_body_step(struct two_body *s);

/* Kinetic energy at the full step, elastic energy and minus the work of gravity [J]. */
double two_body_kinetic(const struct two_body *s);
double two_body_energy(const struct two_body *s);
double two_body_lost(const struct two_body *s);

#endif
