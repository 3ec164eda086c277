/* What rows of the table of keys are made of: places, ranges, and the keys of shapes, which several
 * parts of a scene share. For scene_keys.c alone. */
#ifndef DEMOCLES_SCENE_KEYS_SHAPES_H
#define DEMOCLES_SCENE_KEYS_SHAPES_H

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

/* Shapes, for the struct region `member` of a record. `member` ends with a dot, or is empty where
 * the record is the region. */
#define BOX_KEYS(base, record, member, need)                                                       \
    {base ".box", KEY_MAP, need, .mark = IS(record, member kind, REGION_BOX),                      \
        .text = "box parallel to the axes"},                                                       \
    {base ".box.min", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member min),                    \
        .text = "lowest corner"},                                                                  \
    {base ".box.max", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member max),                    \
        .text = "highest corner"}
#define CYLINDER_KEYS(base, record, member, need)                                                  \
    {base ".cylinder", KEY_MAP, need, .mark = IS(record, member kind, REGION_CYLINDER),            \
        .text = "circular cylinder"},                                                              \
    {base ".cylinder.from", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member from),             \
        .text = "one end of the axis"},                                                            \
    {base ".cylinder.to", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member to),                 \
        .text = "other end of the axis"},                                                          \
    {base ".cylinder.radius", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO,                \
        .at = AT(record, member radius), .text = "radius"}
#define SPHERE_KEYS(base, record, member, need)                                                    \
    {base ".sphere", KEY_MAP, need, .mark = IS(record, member kind, REGION_SPHERE),                \
        .text = "sphere"},                                                                         \
    {base ".sphere.center", KEY_VECTOR, NEEDED, UNIT_LENGTH, VEC(record, member center),           \
        .text = "centre of the sphere"},                                                           \
    {base ".sphere.radius", KEY_NUMBER, NEEDED, UNIT_LENGTH, .range = ABOVE_ZERO,                  \
        .at = AT(record, member radius), .text = "radius"}
#define STL_KEYS(base, record, member)                                                             \
    {base ".stl", KEY_FILE, ONE_OF, .at = AT(record, member stl),                                  \
        .mark = IS(record, member kind, REGION_STL),                                               \
        .text = "inside of a closed triangle mesh of an STL file"},                                \
    {base ".scale", KEY_NUMBER, OPTIONAL, UNIT_LENGTH, "1", ABOVE_ZERO, .when = "stl",             \
        .absent = 1, .at = AT(record, member scale), .text = "metres per unit of the STL file"}
/* clang-format on */

#endif
