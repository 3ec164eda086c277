/* The fields of frames, a row each: what the scene may ask for, what a frame writes, what a run
 * that goes on reads back, and what `explain output.fields` says all follow these two lists.
 *
 * A row is F(name, unit, width, number, use, when, source, text):
 *   width   numbers per element or cell
 *   number  I32, I64, F64; REAL and PLACE: in the device's precision of motions and of positions;
 *           SHOWN_F64: REAL in the state, a double in what is shown
 *   use     SHOWN: output.fields may name it; STATE: the next step depends on it, so that every
 *           frame has it; BOTH; ALWAYS: both, and not asked for; AGAIN: BOTH, under the name of the
 *           row above, for the other kind of scene
 *   when    the run has it: `any`, or a condition of the method's own table
 *   source  where the numbers are
 * number, when and source are read by src/particle/particle_fields.c and src/lattice/
 * lattice_fields.c alone: a new field is a row here and, unless its numbers lie in an array that is
 * there, a function there. */
#ifndef DEMOCLES_OUTPUT_FIELDS_H
#define DEMOCLES_OUTPUT_FIELDS_H

#include "scene_item.h"

/* clang-format off */
#define OUTPUT_FIELDS_PARTICLES(F) \
F(id, "1", 1, I64, BOTH, any, HOST(gid), \
    "number of the particle, from 0 in the order of the scene") \
F(position, "m", 3, PLACE, ALWAYS, any, HOST(x), "centres of the particles") \
F(velocity, "m/s", 3, REAL, BOTH, any, HOST(v), "velocity of the centre") \
F(angular_velocity, "rad/s", 3, REAL, BOTH, any, HOST(w), "angular velocity") \
F(orientation, "1", 4, REAL, BOTH, orientation, HOST(q), "quaternion w, x, y, z") \
F(force, "N", 3, SHOWN_F64, BOTH, any, DEVICE(force), "net contact force") \
F(torque, "N m", 3, REAL, STATE, spin, DEVICE(torque), "net contact torque") \
F(reference, "m", 4, PLACE, STATE, any, LISTS(reference), \
    "centre when the lists were built, and room to move from there") \
F(reach, "m", 1, PLACE, STATE, any, LISTS(reach), "how far neighbours were listed") \
F(radius, "m", 1, F64, SHOWN, any, HOST(radius), "radius of the sphere") \
F(mass, "kg", 1, F64, SHOWN, any, HOST(mass), "mass") \
F(coordination, "1", 1, I32, SHOWN, any, MADE(coordination), \
    "number of contacts with particles and walls") \
F(overlap, "1", 1, F64, SHOWN, any, MADE(overlap), \
    "largest overlap with another particle, over the particle's radius; 0: none") \
F(material, "1", 1, I32, SHOWN, any, HOST(material), "index of the material in the scene") \
F(owner, "1", 1, I32, SHOWN, any, MADE(owner), "MPI rank that owns the particle")

#define OUTPUT_FIELDS_LATTICE(F) \
F(id, "1", 1, I64, BOTH, any, CELL(gid), "number of the cell") \
F(displacement, "m", 3, F64, CORNERS, any, CELL(u), "displacement, of the corners and the centre") \
F(rotation, "1", 4, F64, BOTH, turn, CELL(turn), "quaternion w, x, y, z") \
F(rotation, "rad", 4, F64, AGAIN, small, CELL(turn), \
    "with lattice.rotation: small: the small rotation about x, y, z, and 0") \
F(velocity, "m/s", 3, F64, BOTH, any, CELL(v), "velocity of the centre") \
F(angular_velocity, "rad/s", 3, F64, BOTH, any, CELL(w), "angular velocity") \
F(links, "1", 1, I32, STATE, breakage, CELL(links), \
    "links left, a bit for each of -x, +x, -y, +y, -z, +z") \
F(fate, "1", 1, I32, STATE, breakage, CELL(fate), \
    "how links at upper faces broke, three bits for each of x, y, z: tension 1, shear 2, bending " \
    "3, twist 4") \
F(velocity_before, "m/s", 3, F64, STATE, kick, CELL(v_before), \
    "velocity before the kick that ends the step") \
F(angular_velocity_before, "rad/s", 3, F64, STATE, kick, CELL(w_before), \
    "angular velocity before that kick") \
F(ledger, "J", LATTICE_LEDGER, F64, STATE, energy, CELL(ledger), \
    "account of work and damping, see kernels/lattice/lattice_work.h") \
F(fresh, "1", 1, I32, STATE, release, CELL(fresh), \
    "links that went with the last step, see kernels/lattice/link_release.cl") \
F(released, "J", 1, F64, STATE, release, CELL(released), "energy released by links that broke") \
F(stress, "Pa", 9, F64, SHOWN, stress, CELL(stress), \
    "stress in the world's axes, rows of the tensor") \
F(von_mises, "Pa", 1, F64, SHOWN, stress, CELL(von_mises), "von Mises' equivalent stress") \
F(broken, "1", 1, I32, SHOWN, any, CELL(broken), "number of broken links of the cell") \
F(body, "1", 1, I32, SHOWN, any, MADE(body), "index of the body in the scene") \
F(material, "1", 1, I32, SHOWN, any, MADE(material), "index of the material in the scene") \
F(owner, "1", 1, I32, SHOWN, any, MADE(owner), "MPI rank that owns the cell")
/* clang-format on */

/* CORNERS: output.fields may name it, and every frame has it, in the state by cell and in the
 * picture by corner. */
enum output_fields_use {
    OUTPUT_FIELDS_STATE = 1,
    OUTPUT_FIELDS_SHOWN = 2,
    OUTPUT_FIELDS_BOTH = OUTPUT_FIELDS_STATE | OUTPUT_FIELDS_SHOWN,
    OUTPUT_FIELDS_AGAIN = OUTPUT_FIELDS_BOTH,
    OUTPUT_FIELDS_UNASKED = 4,
    OUTPUT_FIELDS_ALWAYS = OUTPUT_FIELDS_STATE | OUTPUT_FIELDS_UNASKED,
    OUTPUT_FIELDS_CORNERS = OUTPUT_FIELDS_STATE
};

/* The words of output.fields: "|id|velocity ...". */
#define OUTPUT_FIELDS_WORD_STATE(name) ""
#define OUTPUT_FIELDS_WORD_SHOWN(name) "|" name
#define OUTPUT_FIELDS_WORD_BOTH(name) "|" name
#define OUTPUT_FIELDS_WORD_AGAIN(name) ""
#define OUTPUT_FIELDS_WORD_ALWAYS(name) ""
#define OUTPUT_FIELDS_WORD_CORNERS(name) "|" name
#define OUTPUT_FIELDS_WORD(name, unit, width, number, use, when, source, text)                     \
    OUTPUT_FIELDS_WORD_##use(#name)

/* What output.fields may name; the last row has no name. */
extern const struct scene_item output_fields_particles[], output_fields_lattice[];

#endif
