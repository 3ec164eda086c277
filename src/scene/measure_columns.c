#include "measure_columns.h"

#include <stddef.h>

#define END                                                                                        \
    {                                                                                              \
        NULL, NULL, NULL                                                                           \
    }
#define ENERGY(name, sign, known, source, text) {#name, "J", text},
#define BALANCE                                                                                    \
    {                                                                                              \
        "balance", "J",                                                                            \
            "sum of the terms less what was given, less the same at the start: 0 but "             \
            "for errors of the time step"                                                          \
    }

const struct scene_item measure_columns_count[] = {
    {"count", "1", "particles that are there and those that were removed from the run there"},
    {"present", "1", "particles that are there"},
    {"removed", "1", "particles that were removed from the run there"}, END};

const struct scene_item measure_columns_energy_particles[] = {
    MEASURE_ENERGY_PARTICLES(ENERGY) BALANCE, END};

const struct scene_item measure_columns_energy_lattice[] = {
    MEASURE_ENERGY_LATTICE(ENERGY) BALANCE, END};

const struct scene_item measure_columns_momentum[] = {{"p_x", "N s", "momentum along x"},
    {"p_y", "N s", "along y"}, {"p_z", "N s", "along z"},
    {"l_x", "N m s", "angular momentum about the origin, about x"}, {"l_y", "N m s", "about y"},
    {"l_z", "N m s", "about z"}, END};

const struct scene_item measure_columns_wall_force[] = {
    {"force_x", "N", "force of the elements on the wall along x"}, {"force_y", "N", "along y"},
    {"force_z", "N", "along z"}, {"contacts", "1", "contacts with a force"}, END};

const struct scene_item measure_columns_wall_torque[] = {
    {"torque_x", "N m", "torque of the particles on the wall about the point, along x"},
    {"torque_y", "N m", "along y"}, {"torque_z", "N m", "along z"}, END};

const struct scene_item measure_columns_probe_particles[] = {{"x", "m", "place of the centre"},
    {"y", "m", ""}, {"z", "m", ""}, {"v_x", "m/s", "velocity"}, {"v_y", "m/s", ""},
    {"v_z", "m/s", ""}, {"w_x", "rad/s", "angular velocity"}, {"w_y", "rad/s", ""},
    {"w_z", "rad/s", ""}, END};

const struct scene_item measure_columns_probe_lattice[] = {{"x", "m", "place of the centre"},
    {"y", "m", ""}, {"z", "m", ""}, {"u_x", "m", "displacement"}, {"u_y", "m", ""},
    {"u_z", "m", ""}, {"v_x", "m/s", "velocity"}, {"v_y", "m/s", ""}, {"v_z", "m/s", ""},
    {"w_x", "rad/s", "angular velocity"}, {"w_y", "rad/s", ""}, {"w_z", "rad/s", ""}, END};

const struct scene_item measure_columns_stress_max[] = {
    {"von_mises", "Pa", "largest von Mises stress"},
    {"x", "m", "place at the start of the cell that has it"}, {"y", "m", ""}, {"z", "m", ""}, END};

const struct scene_item measure_columns_broken[] = {{"tension", "1", "links broken in tension"},
    {"shear", "1", "in shear"}, {"bending", "1", "in bending"}, {"twist", "1", "in twist"}, END};

const struct scene_item measure_columns_rotation[] = {{"rotation_w", "1", "quaternion"},
    {"rotation_x", "1", ""}, {"rotation_y", "1", ""}, {"rotation_z", "1", ""}, END};

const struct scene_item measure_columns_small_rotation[] = {
    {"rotation_x", "rad", "small rotation about x"}, {"rotation_y", "rad", "about y"},
    {"rotation_z", "rad", "about z"}, END};

const struct scene_item measure_columns_stress[] = {{"stress_xx", "Pa", "stress"},
    {"stress_xy", "Pa", ""}, {"stress_xz", "Pa", ""}, {"stress_yx", "Pa", ""},
    {"stress_yy", "Pa", ""}, {"stress_yz", "Pa", ""}, {"stress_zx", "Pa", ""},
    {"stress_zy", "Pa", ""}, {"stress_zz", "Pa", ""}, END};

const struct scene_item measure_columns_von_mises[] = {
    {"von_mises", "Pa", "von Mises' equivalent stress"}, END};

const struct scene_item measure_columns_probe_fields[] = {
    {"displacement", "m", "columns u_x, u_y, u_z, of every probe"},
    {"rotation", "1",
        "columns rotation_w, rotation_x ...: quaternion; with lattice.rotation: small three angles "
        "[rad]"},
    {"velocity", "m/s", "columns v_x, v_y, v_z, of every probe"},
    {"angular_velocity", "rad/s", "columns w_x, w_y, w_z, of every probe"},
    {"stress", "Pa", "columns stress_xx, stress_xy ... stress_zz, in the world's axes"},
    {"von_mises", "Pa", "column von_mises: von Mises' equivalent stress"}, END};
