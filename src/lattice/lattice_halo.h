/* Ghosts of the lattice: fetched before each evaluation of the forces, while the device works on
 * cells that need none. The order of calls, and why the copy of arrivals cannot overtake what still
 * reads the ones before, is that of ghosts.h. Knows records and indices, no physics. */
#ifndef DEMOCLES_LATTICE_HALO_H
#define DEMOCLES_LATTICE_HALO_H

#include "device/exchange.h"
#include "lattice_layout.h"

struct lattice_halo {
    struct exchange exchange;
    struct buffer send, recv; /* places of the records */
    struct launch *pack, *unpack;
};

/* What travels of each cell: the first `n` planes of a set in the buffer, numbers of `bytes`. */
struct lattice_planes {
    const struct buffer *buffer;
    int n;
    size_t bytes;
};

/* word: buffer of the cells' words where links break, else NULL. Collective. */
struct lattice_halo *lattice_halo_create(const struct comm *comm, const struct program *program,
    const struct lattice_layout *layout, struct lattice_planes x, struct lattice_planes v,
    const struct buffer *word);
void lattice_halo_free(struct lattice_halo *h);

/* Packs from the sets of planes that begin with numbers x_in and v_in, reads back, posts
 * receives. */
void lattice_halo_begin(struct lattice_halo *h, int64_t x_in, int64_t v_in, struct timers *timers);
/* After the interior's kernels are enqueued: sends, waits for arrivals, enqueues what puts them in
 * place. `nearly_done`: see exchange_swap. */
void lattice_halo_swap(struct lattice_halo *h, cl_event *nearly_done, struct timers *timers);

#endif
