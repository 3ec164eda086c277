/* Numbers that host and kernels of the lattice agree on.
 *
 * Word of a cell: bits 0-5 its links (-x, +x, -y, +y, -z, +z), 6-11 its fixed DOF (x, y, z, and
 * rotation about them), 12 whether this rank owns it, 16-23 its kind, 24-29 its links that are due
 * (link_principal.cl). Planes of x: u(3), then q (w, x, y, z) or theta(3); of v: v(3), w(3). */
#ifndef DEMOCLES_LATTICE_WORDS_H
#define DEMOCLES_LATTICE_WORDS_H

/* Bits of a mask of links. */
#define LINK_BIT(axis, upper) (1 << (2 * (axis) + (upper)))

#define WORD_FIX 6
#define WORD_OWNED 12
#define WORD_KIND 16
#define WORD_DUE_AT 24
#define WORD_DUE(word) ((word) >> WORD_DUE_AT & 63)

/* Fate of a cell: three bits for each upper face (x, y, z), the mode of law_break.h in which that
 * link broke; the lower cell of a link has it. Written to files with the links that are due in the
 * bits above. */
#define FATE_MODE(fate, axis) ((fate) >> (3 * (axis)) & 7)
#define FATE_DUE_AT 9

#define LATTICE_X(with_turn) ((with_turn) ? 7 : 6)
#define LATTICE_V 6
#define LATTICE_LEDGER 3 /* planes of double, WITH_ENERGY: struct lattice_ledger */

/* Rows of tables of real. */
/* kn ks kt kb r_i r_j h eta; row: kind of the lower cell times n_kind + kind of the higher */
#define LINK_WIDTH 8
/* 1/m [1/kg], 1/J [1/(kg m2)], lambda [Pa], 1/(4 G) [1/Pa], 1/(2 h) [1/m], eta [s], alpha [1/s],
 * h^3 [m3]; row: kind */
#define CELL_WIDTH 8
/* WITH_SHARES, of a cell that the surface of its body cuts: covered shares of its faces, in the
 * order of the mask; of each the place of the covered part's middle along the two axes after the
 * face's [m]; share of the volume, one over that of the mass, least D (law_volume.h) */
#define SHARE_FACE 0
#define SHARE_OFFSET 6
#define SHARE_VOLUME 18
#define SHARE_PER_MASS 19
#define SHARE_LEAST 20
#define SHARE_WIDTH 24
/* one over the limits of normal and shear force, bending and twisting moment, criterion
 * (law_break.h); row: as links */
#define BREAK_WIDTH 5
#define BREAK_CRITERION 4
/* the kick that ends a step, the one that begins the next, KICK_PART each; row: kind */
#define KICK_WIDTH 12
#define KICK_PART 6 /* f g, and s G A C that WITH_ENERGY alone reads (lattice_work.h) */
/* Info of a run: its kind, and this if its cells have to be looked at one by one. */
#define RUN_MIXED 256

/* Sums over cells (lattice_account.h); of momentum and angular momentum three each. */
#define ACCOUNT_KINETIC 0
#define ACCOUNT_ROTATIONAL 1
#define ACCOUNT_GRAVITY 2
#define ACCOUNT_ELASTIC 3
#define ACCOUNT_MOMENTUM 4
#define ACCOUNT_ANGULAR 7
#define ACCOUNT_WORK 10 /* these three 0 without WITH_ENERGY */
#define ACCOUNT_LINKS 11
#define ACCOUNT_MASS 12
#define ACCOUNT_RELEASED 13 /* 0 without WITH_ENERGY and WITH_BREAK */
#define ACCOUNT_STRAINED 14 /* links out of the range of small strain (lattice_account.h) */
#define ACCOUNT_WIDTH 15

#endif
