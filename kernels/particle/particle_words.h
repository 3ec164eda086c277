/* Numbers that host and kernels of the particles agree on. */
#ifndef DEMOCLES_PARTICLE_WORDS_H
#define DEMOCLES_PARTICLE_WORDS_H

/* Neighbour rows (rows.cl): so many entries of a row are kept by the pass that counts. */
#define ROW_FOUND 32
/* Boundary pairs begin at a multiple of this, and arrays of contacts are rounded up to it. */
#define PAIR_ALIGN 64

/* Bounds (select.cl): work-items of a group; preal of each group: -low (3), high (3), -smallest
 * reach, largest reach [m], largest squared speed [m2/s2]. */
#define SELECT_GROUP 64
#define BOUNDS_WIDTH 9

/* Cell grids (grid.h), per level. Reals: lower corner x y z [m], cells per metre x y z, largest
 * reach on the level [m]; ints: cells x y z, number of the first cell. */
#define GRID_REALS 7
#define GRID_INTS 4

/* So many primitives of a wall at most have a common box (wall_lists.cl). */
#define WALL_BLOCK 16

/* A wall's pose in preal: rotation 9 (rows), translation 3; velocity 3, spin 3, centre 3 of the
 * half step; active; velocity 3, spin 3, centre 3 of the step itself. */
#define POSE_WIDTH 31
/* preal of a candidate of a joined wall (wall_keep.cl). */
#define NEAR_WIDTH 6
#define NEAR_VALLEY 5
/* Real of a wall contact's result: force, and torque where something rotates, padded to fours. */
#define WALL_RESULT_WIDTH(with_rotation) ((with_rotation) ? 8 : 4)

#endif
