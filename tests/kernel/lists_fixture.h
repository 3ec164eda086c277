/* Elements, cells and pairs on the device as the driver has them, and neighbours by brute force. */
#ifndef LISTS_FIXTURE_H
#define LISTS_FIXTURE_H

#include "kernel_fixture.h"
#include "particle/pairs.h"

/* A rank's elements on the host: owned first, then ghosts. */
struct crowd {
    int n_owned, n_all;
    struct record *element; /* [n_all] */
    int64_t *gid;           /* [n_all] */
    preal *reach;           /* [n_all] */
};

struct lists {
    struct device *dev;
    struct features features;
    struct program *program, *force;
    struct scan *scan;
    struct cells *cells;
    struct particles *particles;
    struct pairs *pairs;
};

#define LISTS_PERIOD 1.0 /* [m] in the directions that the flags make periodic: from 0 to 1 */

void lists_open(struct lists *l);
void lists_close(struct lists *l);

struct crowd crowd_create(int n_owned, int n_all);
void crowd_free(struct crowd *c);
/* Whether the listing reaches of a and b overlap, nearest image. */
bool crowd_meet(const struct crowd *c, int a, int b);

/* To the device; sorts into cells; builds rows and pairs. What was `now` becomes `old`. */
void lists_build(struct lists *l, const struct crowd *c);
/* The first n ints of a buffer; the caller frees. */
int *lists_ints(const struct buffer *buffer, int64_t n);

#endif
