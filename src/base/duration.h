/* Durations as people and batch systems write them: `1h30m`, `90s`, `2d`, `1.5h`, `3600`
 * (seconds). */
#ifndef DEMOCLES_DURATION_H
#define DEMOCLES_DURATION_H

#include <stdbool.h>

/* Parts are decimal numbers with a unit of d, h, m, s, the largest unit first and each at most
 * once; one number without a unit is seconds. Nothing else, no blanks, no sign. False, and
 * `seconds` unchanged, if the text is not that. */
bool duration_parse(const char *text, double *seconds);

#endif
