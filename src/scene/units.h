/* Numbers with units, turned into SI: "5 mm", "2e-6 s", "210 GPa", "7.85 g/cm3", "30 deg", "10
 * rpm", "2 %". A bare number is in SI already.
 *
 * Powers of ten are moved into the number's own exponent before it is converted, so "5 mm" has the
 * same bits as "0.005". Angle counts as a dimension: "10 Hz" is no angular velocity, since it could
 * mean 10 or 20 pi rad/s. This knows no key and no file: what is wrong comes back as a phrase. */
#ifndef DEMOCLES_UNITS_H
#define DEMOCLES_UNITS_H

#include <stdbool.h>
#include <stddef.h>

enum unit_kind {
    UNIT_NONE, /* a plain number [1] */
    UNIT_LENGTH,
    UNIT_TIME,
    UNIT_MASS,
    UNIT_FORCE,
    UNIT_STIFFNESS,
    UNIT_PRESSURE,
    UNIT_DENSITY,
    UNIT_VELOCITY,
    UNIT_ACCELERATION,
    UNIT_ANGLE,
    UNIT_ANGULAR_VELOCITY,
    UNIT_FREQUENCY,
    UNIT_ENERGY,
    UNIT_AREA,
    UNIT_VOLUME,
    UNIT_POWER,
    UNIT_DAMPING,
    UNIT_FRACTURE,
    UNIT_KINDS
};

/* "length", and its SI unit "m"; the plain number has the unit "". */
const char *units_name(enum unit_kind kind);
const char *units_si(enum unit_kind kind);

/* Reads `text` as a quantity of `kind` into *value (SI). False where it is none; then `problem` (at
 * most `size` bytes, always terminated) says why: not a number, unknown unit, another kind of unit,
 * not finite. */
bool units_parse(const char *text, enum unit_kind kind, double *value, char *problem, size_t size);

/* Length in bytes of the number that `text` begins with (after no blanks):
 * [+-]digits[.digits][e[+-]digits]; 0 if there is none. */
size_t units_number_length(const char *text);

/* Writes decimal text of 15 to 17 digits, as few as read back to the same double. `text` holds at
 * least 32 bytes. */
void units_print(double value, char *text);

#endif
