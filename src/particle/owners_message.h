/* What travels with an element that changes its owner, as bytes: its fields, and the contacts that
 * remember something.
 *
 * Per element: fields one after the other, number of pair contacts, number of wall contacts; then
 * those contacts, each with key (partner's gid, or primitive), state and history. Knows no MPI. */
#ifndef DEMOCLES_OWNERS_MESSAGE_H
#define DEMOCLES_OWNERS_MESSAGE_H

#include "wall_contacts.h"

/* Contacts of a list of elements: element i has begin[i] <= k < begin[i + 1]. */
struct owners_contacts {
    int *begin;           /* [n + 1] */
    int64_t *key;         /* [n_contact] */
    int *state;           /* [n_contact] */
    char *history;        /* [n_contact][width * real] */
    size_t history_bytes; /* per contact */
};

struct owners_leaving {
    int64_t n;
    size_t bytes[FIELD_N];
    void *field[FIELD_N];
    struct owners_contacts pair, wall;
};

struct owners_arriving {
    int64_t n;
    char *field[FIELD_N];
    struct owners_contacts pair, wall;
};

/* Contacts with a memory of the n elements in `index` (device); the caller frees what c points to.
 * walls: NULL where there are none. */
void owners_pick_pairs(struct owners_contacts *c, struct scan *scan, const struct buffer *index,
    int64_t n, const struct pairs *pairs);
void owners_pick_walls(struct owners_contacts *c, struct scan *scan, const struct buffer *index,
    int64_t n, const struct wall_contacts *walls);

/* Messages in ascending order of destination owner[i]; a negative owner goes nowhere. bytes_to
 * [n_rank] is filled. */
void *owners_pack(const struct owners_leaving *l, const int *owner, int n_rank, int64_t *bytes_to);
/* `like`: for the sizes. */
struct owners_arriving owners_unpack(
    const struct owners_leaving *like, const void *data, int64_t bytes);

/* Contacts of n elements that have arrived to the device, for the carriers. */
void owners_store_pairs(struct pairs *pairs, const struct owners_contacts *c, int64_t n);
void owners_store_walls(struct wall_contacts *walls, const struct owners_contacts *c, int64_t n);

void owners_leaving_free(struct owners_leaving *l);
void owners_arriving_free(struct owners_arriving *a);

#endif
