/* Two spheres that fly at each other, meet obliquely, and part. The usual test of the laws:
 * everything happens in it once. */
#ifndef DEMOCLES_IMPACT_H
#define DEMOCLES_IMPACT_H

#include "two_body.h"

struct impact {
    int hertz, no_attraction;
    double z_n, z_t, mu;
    double slant; /* tangential over normal speed */
    double spin;  /* surface speed of both spins over normal speed */
    double ratio; /* r_j/r_i; 0: 1 */
    double f_b;   /* [N] */
    double mu_r;  /* rolling friction */
    double k_r;   /* its stiffness ratio, 0: CDT */
    double eta_r;
    double duration; /* in contact times; 0: 1.9 */
    int choices;     /* CONTACT_ bits besides */
};

#define IMPACT_SPEED 0.5 /* of approach [m/s] */
#define IMPACT_R 5e-3    /* [m] */
#define IMPACT_M 2e-3    /* [kg] */
#define IMPACT_K 1e4     /* linear [N/m] */
#define IMPACT_E 1e7     /* Hertz: E* [Pa]; G* is 0.2 E* (nu = 1/3) */

/* Contact time of the elastic impact [s]. */
double impact_time(const struct impact *c);

/* n: steps per contact time. phase in [0, 1): the same flight, seen at times shifted by phase
 * dt. */
void impact_start(struct two_body *s, const struct impact *c, int n, double phase);

/* To the end; returns the number of steps. */
int impact_run(struct two_body *s, const struct impact *c, int n, double phase);

/* Velocities v, w r of both, 12 numbers [m/s]. */
void impact_velocities(const struct two_body *s, double out[12]);

/* Largest difference of `a` and `b`. */
double impact_difference(const double a[12], const double b[12]);

#endif
