#include "scene_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene.h"

/* clang-format off */
#define AT(record, member) (1 + offsetof(struct record, member))
#define IS(record, member, index) {.at = AT(record, member), .value = (index)}
#define HAS(record, member) {.at = AT(record, member), .is_bool = true, .value = true}
#define VEC(record, member) .at = AT(record, member), .width = 3
#define ABOVE_ZERO {.given = true, .low_open = true, .low = 0, .high = HUGE_VAL}
#define FROM_ZERO {.given = true, .low = 0, .high = HUGE_VAL}
#define FROM_ONE {.given = true, .low = 1, .high = HUGE_VAL}
#define FROM_TWO {.given = true, .low = 2, .high = HUGE_VAL}
#define ZERO_TO_ONE {.given = true, .low = 0, .high = 1}
#define SHARE {.given = true, .low_open = true, .low = 0, .high = 1}
#define POISSON {.given = true, .low_open = true, .low = -1, .high = 0.5}
#define POISSON_OPEN {.given = true, .low_open = true, .high_open = true, .low = -1, .high = 0.5}
#define BELOW_ONE {.given = true, .low_open = true, .high_open = true, .low = 0, .high = 1}

/* Shapes, for the struct region `member` of a record. `member` ends with a dot, or is empty where the record is the region. */
#define BOX_KEYS(base, record, member, need)                                                                                                         \
    {base ".box", KEY_MAP, need, .mark = IS(record, member kind, REGION_BOX), .text = "box along the axes"},                                         \
    {base ".box.min", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member min), .text = "lowest corner"},                                            \
    {base ".box.max", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member max), .text = "highest corner"}
#define CYLINDER_KEYS(base, record, member, need)                                                                                                    \
    {base ".cylinder", KEY_MAP, need, .mark = IS(record, member kind, REGION_CYLINDER), .text = "circular cylinder"},                                \
    {base ".cylinder.from", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member from), .text = "one end of the axis"},                               \
    {base ".cylinder.to", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member to), .text = "other end of the axis"},                                 \
    {base ".cylinder.radius", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(record, member radius), .text = "radius"}
#define SPHERE_KEYS(base, record, member, need)                                                                                                      \
    {base ".sphere", KEY_MAP, need, .mark = IS(record, member kind, REGION_SPHERE), .text = "sphere"},                                               \
    {base ".sphere.center", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member center), .text = "its middle"},                                      \
    {base ".sphere.radius", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(record, member radius), .text = "radius"}
#define STL_KEYS(base, record, member)                                                                                                               \
    {base ".stl", KEY_FILE, ONE_OF, .at = AT(record, member stl), .mark = IS(record, member kind, REGION_STL),                                       \
        .text = "inside of a closed surface in an STL file"},                                                                                        \
    {base ".scale", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "1", ABOVE_ZERO, .when = "stl", .absent = 1, .at = AT(record, member scale),                  \
        .text = "metres per unit of the STL file"}

const struct scene_key scene_keys[] = {
{"title", KEY_TEXT, .fallback = "''", .at = AT(scene, title), .text = "what the scene shows, for people"},
{"method", KEY_CHOICE, NEEDED, .words = "particles|lattice", .at = AT(scene, method),
    .text = "the method: particles that touch, or solids as a lattice of bonded cells"},
{"time", KEY_MAP, NEEDED, .text = "how long and how finely"},
{"time.end", KEY_NUMBER, NEEDED, UNIT_TIME, .range = ABOVE_ZERO, .at = AT(scene, time.end), .text = "simulated time at which the run ends"},
{"time.step", KEY_NUMBER, OPTIONAL, UNIT_TIME, "auto", ABOVE_ZERO, .special = "auto", .at = AT(scene, time.step),
    .text = "time step; auto: safety times the rigorous limit"},
{"time.safety", KEY_NUMBER, .fallback = "0.8", .range = SHARE, .at = AT(scene, time.safety), .text = "share of the limit that step: auto takes"},
{"time.scheme", KEY_CHOICE, .fallback = "leapfrog", .words = "leapfrog|rk4|rkn4|pefrl|vefrl", .at = AT(scene, time.scheme),
    .text = "time integration; particles: leapfrog, kick-drift-kick with one force per step"},
{"time.allow_unstable", KEY_BOOL, .fallback = "false", .at = AT(scene, time.allow_unstable), .text = "run although step is over its limit"},
{"precision", KEY_CHOICE, .fallback = "double", .words = "|double|mixed|single", .at = AT(scene, precision),
    .text = "arithmetic; mixed: positions in double, contacts in single"},
{"gravity", KEY_VECTOR, OPTIONAL, UNIT_ACCELERATION, "[0, 0, 0]", VEC(scene, gravity), .text = "field acceleration"},

{"materials", KEY_NAMED, NEEDED, .at = AT(scene, material), .count_at = AT(scene, n_material), .size = sizeof(struct material),
    .label_at = AT(material, name), .text = "materials by name"},
{"materials.NAME.density", KEY_NUMBER, NEEDED, UNIT_DENSITY, .range = ABOVE_ZERO, .at = AT(material, density), .text = "mass per volume"},
{"materials.NAME.young", KEY_NUMBER, OPTIONAL, UNIT_PRESSURE, .range = ABOVE_ZERO, .at = AT(material, young), .only = "particles",
    .text = "Young's modulus, for law: hertz"},
{"materials.NAME.young", KEY_NUMBER, NEEDED, UNIT_PRESSURE, .range = ABOVE_ZERO, .at = AT(material, young), .only = "lattice",
    .text = "Young's modulus"},
{"materials.NAME.poisson", KEY_NUMBER, .range = POISSON, .at = AT(material, poisson), .only = "particles",
    .text = "Poisson's ratio, for law: hertz"},
{"materials.NAME.poisson", KEY_NUMBER, NEEDED, .range = POISSON_OPEN, .at = AT(material, poisson), .only = "lattice", .text = "Poisson's ratio"},
{"materials.NAME.damping", KEY_MAP, .only = "lattice", .text = "what takes energy out: mass and link, or a ratio at a frequency"},
{"materials.NAME.damping.mass", KEY_NUMBER, OPTIONAL, UNIT_FREQUENCY, .range = FROM_ZERO, .at = AT(material, mass_damping),
    .text = "alpha: deceleration alpha v of each cell; slows rigid motion too, costs no time step"},
{"materials.NAME.damping.link", KEY_NUMBER, OPTIONAL, UNIT_TIME, .range = FROM_ZERO, .at = AT(material, link_damping),
    .text = "eta: links resist with their stiffness times eta times the rate; ratio eta w/2, costs time step"},
{"materials.NAME.damping.ratio", KEY_NUMBER, OPTIONAL, .range = ABOVE_ZERO, .at = AT(material, damping_ratio),
    .text = "share of critical damping at one frequency, in place of mass and link"},
{"materials.NAME.damping.at", KEY_NUMBER, NEEDED, UNIT_FREQUENCY, .range = ABOVE_ZERO, .when = "ratio", .at = AT(material, damping_at),
    .text = "that frequency f"},
{"materials.NAME.damping.by", KEY_CHOICE, .fallback = "mass", .words = "mass|link", .when = "ratio", .at = AT(material, damping_by),
    .text = "mass: alpha = 4 pi f ratio; link: eta = ratio/(pi f), which costs much time step at a low frequency"},
{"materials.NAME.strength", KEY_MAP, .only = "lattice", .mark = HAS(material, has_strength),
    .text = "what links bear; between unlike materials the weaker counts"},
{"materials.NAME.strength.tension", KEY_NUMBER, ONE_OF, UNIT_PRESSURE, .range = ABOVE_ZERO, .special = "none", .special_value = HUGE_VAL,
    .at = AT(material, tension), .text = "stress across a face"},
{"materials.NAME.strength.energy", KEY_NUMBER, ONE_OF, UNIT_FRACTURE, .range = ABOVE_ZERO, .at = AT(material, energy),
    .text = "G_c, in place of tension and criterion: 0.75 sqrt(E' G_c/h), largest; a slow crack then spends G_c whatever the cell is"},
{"materials.NAME.strength.plane", KEY_CHOICE, .fallback = "strain", .words = "stress|strain", .when = "energy", .at = AT(material, plane),
    .text = "E' = E (plane stress: thin plates) or E/(1 - nu^2)"},
{"materials.NAME.strength.shear", KEY_NUMBER, OPTIONAL, UNIT_PRESSURE, "none", ABOVE_ZERO, .special = "none", .special_value = HUGE_VAL,
    .at = AT(material, shear), .text = "stress along a face"},
{"materials.NAME.strength.criterion", KEY_CHOICE, .fallback = "stress", .words = "sum|largest|stress", .when = "tension",
    .at = AT(material, criterion), .text = "sum or largest of the shares of force and moments, or the stress at the face's edge"},

{"contacts", KEY_LIST, .only = "particles", .at = AT(scene, contact), .count_at = AT(scene, n_contact), .size = sizeof(struct contact),
    .text = "what happens where two materials touch; a part that is absent costs nothing"},
{"contacts[].between", KEY_PAIR, NEEDED, .at = AT(contact, between), .text = "the two materials"},
{"contacts[].normal", KEY_MAP, .text = "force along the line of centres"},
{"contacts[].normal.law", KEY_CHOICE, NEEDED, .words = "linear|hertz", .at = AT(contact, normal_law),
    .text = "spring: linear, or Hertz from young and poisson"},
{"contacts[].normal.stiffness", KEY_NUMBER, NEEDED, UNIT_STIFFNESS, .range = ABOVE_ZERO, .when = "law: linear", .at = AT(contact, stiffness),
    .text = "normal stiffness k_n"},
{"contacts[].normal.damping_ratio", KEY_NUMBER, ONE_OF, .range = FROM_ZERO, .at = AT(contact, damping_ratio),
    .text = "z_n, share of critical damping"},
{"contacts[].normal.restitution", KEY_NUMBER, ONE_OF, .range = SHARE, .absent = -1, .at = AT(contact, restitution),
    .text = "speed after over speed before an impact, in place of damping_ratio"},
{"contacts[].normal.attraction", KEY_BOOL, .fallback = "true", .at = AT(contact, attraction),
    .text = "whether the dashpot may pull as a contact ends"},
{"contacts[].tangential", KEY_MAP, .mark = HAS(contact, has_tangential), .text = "spring, dashpot and Coulomb slider across it"},
{"contacts[].tangential.stiffness_ratio", KEY_NUMBER, .range = ABOVE_ZERO, .absent = -1, .at = AT(contact, stiffness_ratio),
    .text = "k_t/k_n; needed with law: linear, else Mindlin's"},
{"contacts[].tangential.damping_ratio", KEY_NUMBER, .fallback = "0", .range = FROM_ZERO, .at = AT(contact, tangential_damping),
    .text = "z_t: gamma_t = 2 z_t sqrt(k_t (2/7) m*)"},
{"contacts[].tangential.friction", KEY_NUMBER, NEEDED, .range = FROM_ZERO, .at = AT(contact, friction), .text = "coefficient of friction"},
{"contacts[].rolling", KEY_MAP, .text = "torque against rolling"},
{"contacts[].rolling.model", KEY_CHOICE, NEEDED, .words = "|cdt|epsd", .at = AT(contact, rolling),
    .text = "cdt: constant torque; epsd: spring, slider and dashpot (for piles that stand)"},
{"contacts[].rolling.friction", KEY_NUMBER, NEEDED, .range = FROM_ZERO, .at = AT(contact, rolling_friction),
    .text = "mu_r: largest torque mu_r R* F_n"},
{"contacts[].rolling.damping_ratio", KEY_NUMBER, .fallback = "0", .range = FROM_ZERO, .when = "model: epsd", .at = AT(contact, rolling_damping),
    .text = "eta_r: dashpot 2 eta_r sqrt(k_r I_r)"},
{"contacts[].rolling.stiffness_factor", KEY_NUMBER, .fallback = "2.25", .range = ABOVE_ZERO, .when = "model: epsd", .absent = 2.25,
    .at = AT(contact, rolling_stiffness), .text = "k_r/(k_n (mu_r R*)^2)"},
{"contacts[].binding", KEY_MAP, .text = "bond that forms at the first touch and pulls until it breaks"},
{"contacts[].binding.force", KEY_NUMBER, NEEDED, UNIT_FORCE, .range = ABOVE_ZERO, .at = AT(contact, binding_force),
    .text = "pull at which it breaks"},

{"walls", KEY_LIST, .only = "particles", .at = AT(scene, wall), .count_at = AT(scene, n_wall), .size = sizeof(struct wall),
    .label_at = AT(wall, line), .text = "rigid surfaces"},
{"walls[].name", KEY_NAME, NEEDED, .at = AT(wall, name), .text = "name, for measures and messages"},
{"walls[].material", KEY_MATERIAL, NEEDED, .at = AT(wall, material), .text = "its material"},
{"walls[].surface", KEY_MAP, NEEDED, .text = "its shape at time 0"},
{"walls[].surface.plane", KEY_MAP, ONE_OF, .mark = IS(wall, kind, SURFACE_PLANE), .text = "infinite plane; elements stay on the normal's side"},
{"walls[].surface.plane.point", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, point), .text = "a point of it"},
{"walls[].surface.plane.normal", KEY_VECTOR, NEEDED, VEC(wall, normal), .text = "direction, of any length"},
{"walls[].surface.rectangle", KEY_MAP, ONE_OF, .mark = IS(wall, kind, SURFACE_RECTANGLE), .text = "plate that acts on both sides"},
{"walls[].surface.rectangle.center", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, point), .text = "its middle"},
{"walls[].surface.rectangle.normal", KEY_VECTOR, NEEDED, VEC(wall, normal), .text = "direction, of any length"},
{"walls[].surface.rectangle.size", KEY_VECTOR, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(wall, size), .width = 2, .text = "its two edges"},
{"walls[].surface.box", KEY_MAP, ONE_OF, .mark = IS(wall, kind, SURFACE_BOX), .text = "six planes around the elements"},
{"walls[].surface.box.min", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, min), .text = "lowest corner"},
{"walls[].surface.box.max", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, max), .text = "highest corner"},
{"walls[].surface.cylinder", KEY_MAP, ONE_OF, .mark = IS(wall, kind, SURFACE_CYLINDER), .text = "circular cylinder"},
{"walls[].surface.cylinder.from", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, from), .text = "one end of the axis"},
{"walls[].surface.cylinder.to", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, to), .text = "other end of the axis"},
{"walls[].surface.cylinder.radius", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(wall, radius), .text = "its radius"},
{"walls[].surface.cylinder.inside", KEY_BOOL, .fallback = "true", .at = AT(wall, inside), .text = "whether elements stay inside it"},
{"walls[].surface.stl", KEY_FILE, ONE_OF, .at = AT(wall, stl), .mark = IS(wall, kind, SURFACE_STL),
    .text = "triangles of an STL file, acting on both sides"},
{"walls[].surface.scale", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "1", ABOVE_ZERO, .when = "stl", .absent = 1, .at = AT(wall, scale),
    .text = "metres per unit of the STL file"},
{"walls[].motion", KEY_MAP, .fallback = "{}", .text = "how it moves; parts add up"},
{"walls[].motion.velocity", KEY_VECTOR, OPTIONAL, UNIT_VELOCITY, "[0, 0, 0]", VEC(wall, velocity), .text = "steady translation"},
{"walls[].motion.rotation", KEY_MAP, .text = "steady rotation"},
{"walls[].motion.rotation.center", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, rotation_center), .text = "a point of the axis"},
{"walls[].motion.rotation.axis", KEY_VECTOR, NEEDED, VEC(wall, rotation_axis), .text = "direction, of any length"},
{"walls[].motion.rotation.rate", KEY_NUMBER, NEEDED, UNIT_ANGULAR_VELOCITY, .at = AT(wall, rotation_rate), .text = "right-handed about the axis"},
{"walls[].motion.oscillation", KEY_MAP, .text = "x = amplitude sin(2 pi frequency t + phase)"},
{"walls[].motion.oscillation.amplitude", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(wall, amplitude), .text = "direction and size"},
{"walls[].motion.oscillation.frequency", KEY_NUMBER, NEEDED, UNIT_FREQUENCY, .range = FROM_ZERO, .at = AT(wall, frequency),
    .text = "cycles per second"},
{"walls[].motion.oscillation.phase", KEY_NUMBER, OPTIONAL, UNIT_ANGLE, "0", .at = AT(wall, phase), .text = "phase at time 0"},
{"walls[].motion.appear_at", KEY_NUMBER, OPTIONAL, UNIT_TIME, "0", FROM_ZERO, .at = AT(wall, appear_at), .text = "the wall acts from then on"},
{"walls[].motion.remove_at", KEY_NUMBER, OPTIONAL, UNIT_TIME, "never", ABOVE_ZERO, .special = "never", .special_value = HUGE_VAL, .absent = HUGE_VAL,
    .at = AT(wall, remove_at), .text = "the wall acts until then"},

{"elements", KEY_LIST, NEEDED, .only = "particles", .at = AT(scene, group), .count_at = AT(scene, n_group), .size = sizeof(struct element_group),
    .label_at = AT(element_group, line), .text = "groups of elements"},
{"elements[].name", KEY_NAME, NEEDED, .at = AT(element_group, name), .text = "name, for messages"},
{"elements[].material", KEY_MATERIAL, NEEDED, .at = AT(element_group, material), .text = "their material"},
{"elements[].shape", KEY_MAP, NEEDED, .when = "fill", .text = "their shape, with fill"},
{"elements[].shape.sphere", KEY_MAP, ONE_OF, .text = "sphere"},
{"elements[].shape.sphere.diameter", KEY_SPAN, ONE_OF, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(element_group, diameter),
    .text = "one size, or uniform between two"},
{"elements[].shape.sphere.diameter.min", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(element_group, diameter[0]),
    .text = "smallest"},
{"elements[].shape.sphere.diameter.max", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(element_group, diameter[1]),
    .text = "largest"},
{"elements[].shape.sphere.radius", KEY_SPAN, ONE_OF, UNIT_LENGTH, .range = ABOVE_ZERO, .factor = 2, .at = AT(element_group, diameter),
    .text = "in place of diameter"},
{"elements[].shape.sphere.radius.min", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .factor = 2, .at = AT(element_group, diameter[0]),
    .text = "smallest"},
{"elements[].shape.sphere.radius.max", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .factor = 2, .at = AT(element_group, diameter[1]),
    .text = "largest"},
{"elements[].fill", KEY_MAP, ONE_OF, .text = "fill a region with them, on a lattice of spacing (1 + jitter) times the largest diameter"},
{"elements[].fill.region", KEY_MAP, NEEDED, .text = "where"},
BOX_KEYS("elements[].fill.region", element_group, region., ONE_OF),
CYLINDER_KEYS("elements[].fill.region", element_group, region., ONE_OF),
STL_KEYS("elements[].fill.region", element_group, region.),
{"elements[].fill.count", KEY_INTEGER, AT_MOST_ONE, .range = FROM_ONE, .at = AT(element_group, count),
    .text = "how many; it is an error if they do not fit"},
{"elements[].fill.packing", KEY_CHOICE, AT_MOST_ONE, .words = "full", .text = "full: as many as fit (as without count)"},
{"elements[].fill.jitter", KEY_NUMBER, .fallback = "0", .range = ZERO_TO_ONE, .at = AT(element_group, jitter),
    .text = "random displacement of up to jitter times half the diameter per axis"},
{"elements[].fill.seed", KEY_INTEGER, .fallback = "1", .range = FROM_ZERO, .at = AT(element_group, seed), .text = "of the random numbers"},
{"elements[].file", KEY_FILE, ONE_OF, .at = AT(element_group, file), .mark = HAS(element_group, from_file),
    .text = "CSV with the header x,y,z,radius[,vx,vy,vz,wx,wy,wz], in SI units"},
{"elements[].velocity", KEY_VECTOR, OPTIONAL, UNIT_VELOCITY, "[0, 0, 0]", VEC(element_group, velocity), .text = "velocity at time 0"},
{"elements[].angular_velocity", KEY_VECTOR, OPTIONAL, UNIT_ANGULAR_VELOCITY, "[0, 0, 0]", VEC(element_group, angular_velocity),
    .text = "angular velocity at time 0"},

{"bodies", KEY_LIST, NEEDED, .only = "lattice", .at = AT(scene, body), .count_at = AT(scene, n_body), .size = sizeof(struct body),
    .label_at = AT(body, line), .column_at = AT(body, column), .text = "solids; where they overlap on one grid, the later one has the cell"},
{"bodies[].name", KEY_NAME, NEEDED, .at = AT(body, name), .text = "name, for boundaries and messages"},
{"bodies[].material", KEY_MATERIAL, NEEDED, .at = AT(body, material), .text = "its material"},
{"bodies[].cell", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO, .at = AT(body, cell),
    .text = "edge of its cells, which stand on the low corner of its bounding box; bodies whose grids agree are joined"},
{"bodies[].shape", KEY_MAP, NEEDED, .text = "a cell is there if its centre is inside"},
BOX_KEYS("bodies[].shape", body, shape., ONE_OF),
CYLINDER_KEYS("bodies[].shape", body, shape., ONE_OF),
SPHERE_KEYS("bodies[].shape", body, shape., ONE_OF),
STL_KEYS("bodies[].shape", body, shape.),
{"bodies[].minus", KEY_LIST, .at = AT(body, minus), .count_at = AT(body, n_minus), .size = sizeof(struct region), .text = "holes"},
BOX_KEYS("bodies[].minus[]", region, , ONE_OF),
CYLINDER_KEYS("bodies[].minus[]", region, , ONE_OF),
SPHERE_KEYS("bodies[].minus[]", region, , ONE_OF),
STL_KEYS("bodies[].minus[]", region, ),
{"bodies[].cracks", KEY_LIST, .at = AT(body, crack), .count_at = AT(body, n_crack), .size = sizeof(struct region),
    .text = "it is cracked there: links whose middle lies inside, or on a flat box, are missing from the start"},
BOX_KEYS("bodies[].cracks[]", region, , ONE_OF),
CYLINDER_KEYS("bodies[].cracks[]", region, , ONE_OF),
SPHERE_KEYS("bodies[].cracks[]", region, , ONE_OF),
{"bodies[].velocity", KEY_VECTOR, OPTIONAL, UNIT_VELOCITY, "[0, 0, 0]", VEC(body, velocity), .text = "velocity at time 0"},
{"bodies[].angular_velocity", KEY_VECTOR, OPTIONAL, UNIT_ANGULAR_VELOCITY, "[0, 0, 0]", VEC(body, angular_velocity),
    .text = "rigid spin at time 0 about the middle of its cells"},

{"boundaries", KEY_LIST, .only = "lattice", .at = AT(scene, boundary), .count_at = AT(scene, n_boundary), .size = sizeof(struct boundary),
    .label_at = AT(boundary, line), .column_at = AT(boundary, column), .text = "what holds and drives the bodies; loads add up"},
{"boundaries[].where", KEY_MAP, NEEDED, .special = "all",
    .text = "a region, a body, both, or the word all: cells with their centre in it; for loads on faces, faces with their centre in it"},
BOX_KEYS("boundaries[].where", boundary, where., AT_MOST_ONE),
CYLINDER_KEYS("boundaries[].where", boundary, where., AT_MOST_ONE),
SPHERE_KEYS("boundaries[].where", boundary, where., AT_MOST_ONE),
{"boundaries[].where.body", KEY_BODY, .at = AT(boundary, body), .text = "only of this body"},
{"boundaries[].fix", KEY_AXES, ONE_OF, .words = "x|y|z|rx|ry|rz", .at = AT(boundary, fix), .mark = IS(boundary, kind, BOUNDARY_FIX),
    .text = "these motions are blocked; the clamp stands at the centres of the cells"},
{"boundaries[].force", KEY_VECTOR, ONE_OF, UNIT_FORCE, VEC(boundary, value), .mark = IS(boundary, kind, BOUNDARY_FORCE),
    .text = "in all: equal shares on the free faces in the region, on the centres of its cells if there are none"},
{"boundaries[].pressure", KEY_NUMBER, ONE_OF, UNIT_PRESSURE, .at = AT(boundary, pressure), .mark = IS(boundary, kind, BOUNDARY_PRESSURE),
    .text = "on the free faces in the region, against their normals, which turn with the body"},
{"boundaries[].acceleration", KEY_VECTOR, ONE_OF, UNIT_ACCELERATION, VEC(boundary, value), .mark = IS(boundary, kind, BOUNDARY_ACCELERATION),
    .text = "added to that from the forces"},
{"boundaries[].velocity", KEY_VECTOR, ONE_OF, UNIT_VELOCITY, VEC(boundary, value), .special = "free", .special_value = HUGE_VAL,
    .mark = IS(boundary, kind, BOUNDARY_VELOCITY), .text = "prescribed; free leaves a component to the forces"},
{"boundaries[].angular_velocity", KEY_VECTOR, ONE_OF, UNIT_ANGULAR_VELOCITY, VEC(boundary, value), .special = "free", .special_value = HUGE_VAL,
    .mark = IS(boundary, kind, BOUNDARY_ANGULAR_VELOCITY), .text = "the same for the turning of each cell"},
{"boundaries[].history", KEY_MAP, .fallback = "constant", .special = "constant", .text = "factor over time; without, 1 from the start"},
{"boundaries[].history.ramp", KEY_NUMBER, ONE_OF, UNIT_TIME, .range = ABOVE_ZERO, .at = AT(boundary, history.ramp),
    .mark = IS(boundary, history.kind, HISTORY_RAMP), .text = "grows from 0 to 1 over this time"},
{"boundaries[].history.sine", KEY_MAP, ONE_OF, .mark = IS(boundary, history.kind, HISTORY_SINE), .text = "sin(2 pi frequency t + phase)"},
{"boundaries[].history.sine.frequency", KEY_NUMBER, NEEDED, UNIT_FREQUENCY, .range = FROM_ZERO, .at = AT(boundary, history.frequency),
    .text = "cycles per second"},
{"boundaries[].history.sine.phase", KEY_NUMBER, OPTIONAL, UNIT_ANGLE, "0", .at = AT(boundary, history.phase), .text = "phase at time 0"},
{"boundaries[].history.table", KEY_TABLE, ONE_OF, UNIT_TIME, .at = AT(boundary, history.point), .count_at = AT(boundary, history.n_point),
    .mark = IS(boundary, history.kind, HISTORY_TABLE),
    .text = "[[time, factor], ...] or a CSV file of such lines; straight in between, level outside"},

{"lattice", KEY_MAP, .fallback = "{}", .only = "lattice", .text = "how cells are linked"},
{"lattice.law", KEY_CHOICE, .fallback = "isotropic", .words = "isotropic|seed", .at = AT(scene, lattice.law),
    .text = "isotropic: the elastic solid that is asked for; seed: constants of an earlier solver, for poisson: 0, too stiff in bending"},
{"lattice.rotation", KEY_CHOICE, .fallback = "finite", .words = "finite|small", .at = AT(scene, lattice.rotation),
    .text = "finite: cells may turn by any angle; small: linear, cheaper, wrong for a body that turns"},
{"lattice.stress", KEY_CHOICE, .fallback = "average", .words = "average|extrapolated", .at = AT(scene, lattice.stress),
    .text = "of a cell with a free face: true average (half at the surface), or from the faces that have links"},
{"lattice.relax", KEY_MAP, .mark = HAS(scene, lattice.relax), .text = "look for the state of rest under the loads of time.end, and stop there"},
{"lattice.relax.tolerance", KEY_NUMBER, .fallback = "1e-6", .range = BELOW_ONE, .at = AT(scene, lattice.tolerance),
    .text = "largest force that is left on a cell, as a share of the largest stress on its faces"},
{"lattice.relax.every", KEY_INTEGER, .fallback = "100", .range = FROM_TWO, .at = AT(scene, lattice.look_every),
    .text = "steps between two looks at it, which set the damping that leads there"},

{"domain", KEY_MAP, .only = "particles", .fallback = "{}", .text = "the space of the run"},
{"domain.periodic", KEY_AXES, .fallback = "[]", .words = "x|y|z", .at = AT(scene, domain.periodic), .text = "directions that repeat; they need box"},
{"domain.box", KEY_MAP, .mark = HAS(scene, domain.has_box), .text = "its extent; else around walls and elements"},
{"domain.box.min", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(scene, domain.min), .text = "lowest corner"},
{"domain.box.max", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(scene, domain.max), .text = "highest corner"},
{"domain.remove_outside", KEY_BOOL, .fallback = "false", .at = AT(scene, domain.remove_outside),
    .text = "elements that leave it leave the run; else the first to leave a given box stops it"},

{"partition", KEY_MAP, .fallback = "{}", .text = "which rank owns which elements"},
{"partition.method", KEY_CHOICE, .fallback = "geometric", .words = "geometric|interactions|graph", .at = AT(scene, partition.method),
    .text = "bisection of the longest side of all elements, or of all their interactions; or the graph of interactions, by METIS"},
{"partition.every", KEY_INTEGER, .fallback = "1000", .range = FROM_ZERO, .special = "auto", .special_value = PARTITION_AUTO,
    .at = AT(scene, partition.every), .text = "steps between re-cuts; 0: never; auto: when measured times say that it pays; a lattice is cut once"},
{"partition.threshold", KEY_NUMBER, .fallback = "0.1", .range = FROM_ZERO, .at = AT(scene, partition.threshold),
    .text = "imbalance (largest over mean, minus 1) above which a due re-cut is made, and that a cut shall stay below"},
{"partition.weights", KEY_CHOICE, .fallback = "interactions", .words = "interactions|measured", .at = AT(scene, partition.weights),
    .text = "each rank's share: equal interactions, or as many as its measured speed says"},
{"partition.boundary", KEY_CHOICE, .fallback = "both", .words = "both|assigned", .at = AT(scene, partition.boundary),
    .text = "a pair of elements of two ranks: computed on both, or assigned to one that sends the force back (particles only)"},

{"output", KEY_MAP, .fallback = "{}", .text = "frames"},
{"output.every", KEY_NUMBER, OPTIONAL, UNIT_TIME, "0", FROM_ZERO, .at = AT(scene, output.every),
    .text = "time between frames; 0: first and last only"},
{"output.fields", KEY_WORDS, .only = "particles", .fallback = "[velocity, radius]",
    .words = "velocity|angular_velocity|orientation|radius|mass|force|coordination|id|material|owner",
    .at = AT(scene, output.field), .count_at = AT(scene, output.n_field), .text = "what a frame shows of each element"},
{"output.fields", KEY_WORDS, .only = "lattice", .fallback = "[displacement, velocity]",
    .words = "displacement|rotation|velocity|angular_velocity|stress|von_mises|broken|id|body|material|owner",
    .at = AT(scene, output.field), .count_at = AT(scene, output.n_field), .text = "what a frame shows of each cell"},
{"output.checkpoint_every", KEY_NUMBER, OPTIONAL, UNIT_TIME, "0", FROM_ZERO, .at = AT(scene, output.checkpoint_every),
    .text = "time between further frames, for `democles resume`; 0: none"},

{"measure", KEY_LIST, .at = AT(scene, measure), .count_at = AT(scene, n_measure), .size = sizeof(struct measure), .label_at = AT(measure, line),
    .text = "time series, one CSV file each"},
{"measure[].name", KEY_NAME, NEEDED, .at = AT(measure, name), .text = "name of the file"},
{"measure[].every", KEY_NUMBER, NEEDED, UNIT_TIME, .range = ABOVE_ZERO, .at = AT(measure, every), .text = "time between lines"},
{"measure[].count", KEY_MAP, ONE_OF, .only = "particles", .mark = IS(measure, kind, MEASURE_COUNT), .text = "number of elements whose centre is ..."},
{"measure[].count.below", KEY_MAP, .fallback = "{}", .text = "below these coordinates"},
{"measure[].count.below.x", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "none", .special = "none", .special_value = HUGE_VAL, .at = AT(measure, below[0]),
    .text = "below this x"},
{"measure[].count.below.y", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "none", .special = "none", .special_value = HUGE_VAL, .at = AT(measure, below[1]),
    .text = "below this y"},
{"measure[].count.below.z", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "none", .special = "none", .special_value = HUGE_VAL, .at = AT(measure, below[2]),
    .text = "below this z"},
{"measure[].count.above", KEY_MAP, .fallback = "{}", .text = "above these coordinates"},
{"measure[].count.above.x", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "none", .special = "none", .special_value = -HUGE_VAL, .at = AT(measure, above[0]),
    .text = "above this x"},
{"measure[].count.above.y", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "none", .special = "none", .special_value = -HUGE_VAL, .at = AT(measure, above[1]),
    .text = "above this y"},
{"measure[].count.above.z", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "none", .special = "none", .special_value = -HUGE_VAL, .at = AT(measure, above[2]),
    .text = "above this z"},
{"measure[].energy", KEY_CHOICE, ONE_OF, .words = "all", .mark = IS(measure, kind, MEASURE_ENERGY), .text = "all terms of the energy budget"},
{"measure[].momentum", KEY_CHOICE, ONE_OF, .words = "all", .mark = IS(measure, kind, MEASURE_MOMENTUM), .text = "linear and angular momentum"},
{"measure[].wall_force", KEY_WALL, ONE_OF, .only = "particles", .at = AT(measure, wall), .mark = IS(measure, kind, MEASURE_WALL_FORCE),
    .text = "force and torque on this wall"},
{"measure[].probe", KEY_MAP, ONE_OF, .mark = IS(measure, kind, MEASURE_PROBE), .text = "state of one element, of one cell"},
{"measure[].probe.element", KEY_INTEGER, NEEDED, .only = "particles", .range = FROM_ZERO, .at = AT(measure, element),
    .text = "its number, from 0 in the order of the scene"},
{"measure[].probe.at", KEY_VECTOR, NEEDED, UNIT_LENGTH, .only = "lattice", VEC(measure, at), .text = "the cell whose centre is nearest at the start"},
{"measure[].probe.fields", KEY_WORDS, .only = "lattice", .fallback = "[displacement, velocity]",
    .words = "displacement|rotation|velocity|angular_velocity|stress|von_mises", .at = AT(measure, field), .count_at = AT(measure, n_field),
    .text = "what is written of it"},
{"measure[].stress_max", KEY_CHOICE, ONE_OF, .only = "lattice", .words = "von_mises", .mark = IS(measure, kind, MEASURE_STRESS_MAX),
    .text = "largest of all cells"},
{"measure[].broken", KEY_CHOICE, ONE_OF, .only = "lattice", .words = "all", .mark = IS(measure, kind, MEASURE_BROKEN),
    .text = "links broken so far, by mode"},
};
/* clang-format on */

const int scene_keys_n = sizeof scene_keys / sizeof *scene_keys;

const char *scene_key_name(const struct scene_key *key)
{
    const char *dot = strrchr(key->path, '.');
    return dot ? dot + 1 : key->path;
}

bool scene_key_is_child(const struct scene_key *key, const char *pattern)
{
    size_t n = strlen(pattern);
    if (n == 0) return !strchr(key->path, '.');
    return strncmp(key->path, pattern, n) == 0 && key->path[n] == '.' && !strchr(key->path + n + 1, '.');
}

bool scene_key_is_in_record(const struct scene_key *key, const char *pattern)
{
    size_t n = strlen(pattern);
    if (n > 0 && (strncmp(key->path, pattern, n) != 0 || key->path[n] != '.')) return false;
    return !strstr(key->path + n, "[]") && !strstr(key->path + n, ".NAME");
}

bool scene_key_belongs(const struct scene_key *key, enum method method)
{
    return !key->only || strcmp(key->only, method == METHOD_LATTICE ? "lattice" : "particles") == 0;
}

void *scene_key_place(const struct scene_key *key, void *record)
{
    return key->at ? (char *)record + (key->at - 1) : NULL;
}

void scene_key_range_text(const struct key_range *range, char *text, size_t size)
{
    if (!range->given) snprintf(text, size, "%s", "");
    else if (isinf(range->high)) snprintf(text, size, "must be %s %g", range->low_open ? ">" : ">=", range->low);
    else snprintf(text, size, "must be %s %g and %s %g", range->low_open ? ">" : ">=", range->low, range->high_open ? "<" : "<=", range->high);
}

bool scene_key_in_range(const struct key_range *range, double value)
{
    if (!range->given) return true;
    bool low = range->low_open ? value > range->low : value >= range->low;
    bool high = range->high_open ? value < range->high : value <= range->high;
    return low && high;
}
