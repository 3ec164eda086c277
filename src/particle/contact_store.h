/* What pairs and wall contacts share in memory: how wide a history is, and those that come with
 * elements from elsewhere. */
#ifndef DEMOCLES_CONTACT_STORE_H
#define DEMOCLES_CONTACT_STORE_H

#include "kernels/contact/contact_state.h"
#include "kernels/contact/ledger.h"
#include "device/launch.h"

enum { CONTACT_LEDGER_WIDTH = LEDGER_WIDTH }; /* double per contact */

/* How wide contacts are in memory, as the program of a force says itself
 * (kernels/contact/layout.cl). */
struct contact_layout {
    int history, result; /* planes of real; real per result record */
    bool remembers;      /* state bits and history exist */
};
struct contact_layout contact_layout(struct device *dev, const struct program *program);

/* Contacts that came with elements from other ranks, by arrival: rows as in pairs.cl. */
struct contact_arrivals {
    int64_t n; /* elements */
    int64_t n_contact;
    struct buffer begin, key, state, history; /* key: partner's gid (pairs) or primitive (walls) */
};

void contact_arrivals_init(struct device *dev, struct contact_arrivals *a, const char *name);
void contact_arrivals_free(struct contact_arrivals *a);

#endif
