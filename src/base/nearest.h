/* The known name that a mistyped one most likely meant. */
#ifndef DEMOCLES_NEAREST_H
#define DEMOCLES_NEAREST_H

/* Number of single-character insertions, deletions, substitutions and swaps of neighbours that turn
 * a into b (optimal string alignment distance; bytes, letter case ignored). */
int nearest_distance(const char *a, const char *b);

/* The nearest of names[n] to `name`, the first of several; NULL if none is near enough (a third of
 * the longer one's length, at least 1). */
const char *nearest_name(const char *name, const char *const *names, int n);

#endif
