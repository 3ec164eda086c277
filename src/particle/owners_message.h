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

/* Contacts with a memory of the n elements in `index` (device), from pairs or from walls (one of
 * them NULL). */
void owners_pick_contacts(struct owners_contacts *c, struct scan *scan, const struct buffer *index,
    int64_t n, struct pairs *pairs, struct wall_contacts *walls, size_t real);

/* Messages in ascending order of destination owner[i]; a negative owner goes nowhere. bytes_to
 * [n_rank] is filled. */
void *owners_pack(const struct owners_leaving *l, const int *owner, int n_rank, int64_t *bytes_to);
/* `like`: for the sizes. */
struct owners_arriving owners_unpack(
    const struct owners_leaving *like, const void *data, int64_t bytes);

/* To the device, for the carriers. key_bytes: 8 for gids, 4 for primitives. */
void owners_store_contacts(struct contact_arrivals *a, const struct owners_contacts *c, int64_t n,
    size_t key_bytes, int width, size_t real);

void owners_leaving_free(struct owners_leaving *l);
void owners_arriving_free(struct owners_arriving *a);

#endif
