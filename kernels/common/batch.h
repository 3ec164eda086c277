/* How a work-group goes over its batch of contacts: FOR_BATCH (l, n) visits 0 <= l < n <= BATCH.
 *
 * On a GPU a batch has one work-item per contact, and phases that hand over through local memory
 * are kept apart by BATCH_BARRIER. With pocl on a CPU (WITH_ONE_LANE) one work-item does the whole
 * batch, in plain loops without barriers. BATCH_VECTOR before a loop says that its rounds are
 * independent and asks for BATCH_WIDTH lanes: two of the machine's vectors of 32 bytes side by
 * side, because a contact law is one long chain of operations, and a processor that waits for the
 * end of one chain has room for others; four run out of registers (a tenth more time for pairs, a
 * fifth for walls). The driver's own loop over work-items cannot be told so. (Pointers
 * that a kernel writes through are `restrict`: where a table is looked up by number, the compiler
 * has no other way to see it.) Measured on the settled bed, pocl 3.1, AMD Zen 5, ns per pair and
 * step: 17 there, 12 here in double; 11.5 and 8 in single precision. Same bits. */
#ifndef DEMOCLES_BATCH_H
#define DEMOCLES_BATCH_H

#include "types.h"

#ifndef BATCH
#define BATCH 64
#endif
#ifdef __OPENCL_VERSION__
#ifndef BATCH_WIDTH /* lanes that BATCH_VECTOR asks for */
#if REAL_IS_FLOAT
#define BATCH_WIDTH 16
#else
#define BATCH_WIDTH 8
#endif
#endif
#if WITH_ONE_LANE
#define BATCH_LANES 1
#define BATCH_BARRIER
#ifdef __clang__
#define BATCH_TEXT(x) _Pragma(#x)
#define BATCH_ASK(width) BATCH_TEXT(clang loop vectorize(assume_safety) vectorize_width(width))
#define BATCH_VECTOR BATCH_ASK(BATCH_WIDTH)
#endif
#else
#define BATCH_LANES BATCH
#define BATCH_BARRIER barrier(CLK_LOCAL_MEM_FENCE)
#endif
#ifndef BATCH_VECTOR
#define BATCH_VECTOR
#endif
#define FOR_BATCH(l, n) for (size_t l = get_local_id(0); l < (n); l += BATCH_LANES)
/* The same in pieces of BATCH_WIDTH, before each of which PREFETCH fetches what later pieces read
 * or write; BATCH is a multiple of BATCH_WIDTH. Where a piece is longer than the window in which a
 * processor reorders instructions, it would compute and wait by turns. */
#if WITH_ONE_LANE && defined(__clang__)
#define FOR_PIECES(piece) for (size_t piece = 0; piece < BATCH; piece += BATCH_WIDTH)
#define FOR_PIECE(l, piece) for (size_t l = piece; l < piece + BATCH_WIDTH; l++)
#define PREFETCH(p) __builtin_prefetch((const void *)(uintptr_t)(p), 0, 2)
#else
#define FOR_PIECES(piece) for (size_t piece = 0; piece < 1; piece++)
#define FOR_PIECE(l, piece) FOR_BATCH (l, BATCH)
#define PREFETCH(p)
#endif
#endif

#endif
