/* The columns of the time series that measures write, besides the time: what `explain measure.KIND`
 * says of them, the header of the file, and for energies the account itself and run.json all follow
 * these lists. Each ends with a row without a name. */
#ifndef DEMOCLES_MEASURE_COLUMNS_H
#define DEMOCLES_MEASURE_COLUMNS_H

#include "scene_item.h"

/* The terms of the account of energy [J], in the order of columns; T(name, sign, known, source,
 * text):
 *   name    also the member of struct energy_sums, struct lattice_energy
 *   sign    with which it counts in the balance, which adds the terms with 1 first
 *   known   ALWAYS, or MEASURED: only where a measure of energy asks for it
 *   source  which of the sums it is; read by src/particle/energy.c and src/lattice/
 *           lattice_energy.c alone */
/* clang-format off */
#define MEASURE_ENERGY_PARTICLES(T) \
T(kinetic, 1, ALWAYS, SUMS_KINETIC, "kinetic energy of the centres") \
T(rotational, 1, ALWAYS, SUMS_ROTATIONAL, "kinetic energy of rotation") \
T(gravity, 1, ALWAYS, SUMS_GRAVITY, "potential energy, 0 at the low corner of the domain") \
T(elastic, 1, MEASURED, ELASTIC, "stored in the springs of contacts") \
T(dashpot_normal, 1, MEASURED, TOTALS + LEDGER_NORMAL, \
    "taken by dashpots along the normal since the start") \
T(dashpot_tangential, 1, MEASURED, TOTALS + LEDGER_TANGENTIAL, "taken by dashpots across it") \
T(sliding, 1, MEASURED, TOTALS + LEDGER_SLIDING, "taken by friction") \
T(rolling, 1, MEASURED, TOTALS + LEDGER_ROLLING, "taken by the torque against rolling") \
T(bonds, 1, MEASURED, TOTALS + LEDGER_BONDS, "taken by bonds that broke") \
T(wall_work, -1, MEASURED, TOTALS + LEDGER_WORK, "given by moving walls") \
T(removed, 1, MEASURED, REMOVED, "left with elements that left the run, and with their contacts")

#define MEASURE_ENERGY_LATTICE(T) \
T(kinetic, 1, ALWAYS, ACCOUNT_KINETIC, "kinetic energy of the centres") \
T(rotational, 1, ALWAYS, ACCOUNT_ROTATIONAL, "kinetic energy of rotation") \
T(gravity, 1, ALWAYS, ACCOUNT_GRAVITY, "potential energy, 0 where the cells began") \
T(elastic, 1, ALWAYS, ACCOUNT_ELASTIC, "stored in links and volumes") \
T(link_damping, 1, MEASURED, ACCOUNT_LINKS, "taken by damping of links since the start") \
T(mass_damping, 1, MEASURED, ACCOUNT_MASS, "taken by damping of masses") \
T(released, 1, MEASURED, ACCOUNT_RELEASED, "released by links that broke") \
T(work, -1, MEASURED, ACCOUNT_WORK, "given by loads and prescribed motion")
/* clang-format on */

extern const struct scene_item measure_columns_count[], measure_columns_energy_particles[],
    measure_columns_energy_lattice[], measure_columns_momentum[], measure_columns_wall_force[],
    measure_columns_wall_torque[], measure_columns_probe_particles[],
    measure_columns_probe_lattice[], measure_columns_stress_max[], measure_columns_broken[];

/* What the fields of a probe of a cell add to its columns; and what they are, by their names. */
extern const struct scene_item measure_columns_rotation[], measure_columns_small_rotation[],
    measure_columns_stress[], measure_columns_von_mises[], measure_columns_probe_fields[];

#endif
