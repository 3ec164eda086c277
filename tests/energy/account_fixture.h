/* A made-up state of elements, pairs and wall contacts, as a whole on one rank or dealt out to
 * many, without a run behind it. */
#ifndef ACCOUNT_FIXTURE_H
#define ACCOUNT_FIXTURE_H

#include "kernels/contact/ledger.h"
#include "particle/particle.h"

enum { N_ELEMENT = 5000, N_PAIR = 14000, N_WALL = 2, PAIR_GAP = 30 };

struct account_state {
    double x[N_ELEMENT][3], v[N_ELEMENT][3], w[N_ELEMENT][3], radius[N_ELEMENT],
        inverse_m[N_ELEMENT];
    int lower[N_PAIR], upper[N_PAIR];  /* gids */
    double pair[N_PAIR][LEDGER_WIDTH]; /* ledgers */
    /* element i at primitive i % N_WALL, which is wall i % N_WALL */
    double at_wall[N_ELEMENT][LEDGER_WIDTH];
    unsigned char taken[N_ELEMENT]; /* element has left */
    double gravity[3], domain[6], period[3];
};

/* Random numbers of many magnitudes. is_float: such as a float holds. */
void account_random(struct account_state *a, bool is_float);

/* The elements of `rank` out of n_rank on the device, with all contacts that have one of them; the
 * other elements are ghosts. */
struct sim *account_sim(struct device *dev, struct comm *comm, const struct account_state *a,
    const struct features *features, int rank, int n_rank);
void account_free(struct sim *s);
/* Elements in `taken` leave, as in a regroup: s->owners->removed is filled, the others move up;
 * gids of before stay in the spare. */
void account_leave(struct sim *s, const struct account_state *a);
/* Writes the elements that are still there anew. */
void account_write_elements(struct sim *s, const struct account_state *a);
int account_owner(int gid, int n_rank);

#endif
