/* One row of loads: what acts on a cell besides links and gravity. Row 0 is no load. Shared by host
 * and device. */
#ifndef DEMOCLES_LOADS_H
#define DEMOCLES_LOADS_H

enum {
    LOAD_FORCE = 0, /* 3: world, on the centre [N] */
    /* 9: L_x, L_y, L_z, world forces times h/2; torque = sum over axes a of (R e_a) x L_a [N m] */
    LOAD_LEVER = 3,
    LOAD_BODY = 12,         /* 3: force that turns with the cell (pressure), R B [N] */
    LOAD_TRACTION = 15,     /* 1: sum over pressed faces of t.n, for Th [Pa] */
    LOAD_ACCELERATION = 16, /* 3: not divided by mass [m/s2] */
    /* 6: what LOAD_TRACTION sums, t.n of each face in the order of the mask of links [Pa]; only
     * what is measured reads it */
    LOAD_NORMAL = 19,
    LOAD_TURN = 25, /* 3: torque that turns with the cell, of pressures on cut cells [N m] */
    /* 6: v and w of DOF that are prescribed (their CELL_FIX bit is set) [m/s] [rad/s] */
    LOAD_VELOCITY = 28,
    LOAD_NOW = 34,  /* 6: the same at the time of the forces */
    LOAD_RATE = 40, /* 1: change of LOAD_TRACTION, for the balance of energy [Pa/s] */
    LOAD_WIDTH = 41
};

#endif
