/* Migration: variable-size messages to any ranks, where nobody knows beforehand who will send to
 * whom (the rare path). */
#ifndef DEMOCLES_MIGRATE_H
#define DEMOCLES_MIGRATE_H

#include "comm.h"

/* Collective. Sends `bytes_to[r]` bytes (any number of ranks, 0: none), lying in `send` rank after
 * rank, and returns what has come in, rank after rank in ascending order, in a buffer that the
 * caller frees; `bytes_from[r]` [n_rank] is filled. Messages above 1 GiB are cut. */
void *migrate_bytes(
    const struct comm *comm, const void *send, const int64_t *bytes_to, int64_t *bytes_from);

#endif
