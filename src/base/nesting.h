/* How deep the lists and mappings of a YAML text lie in each other. The parser's loader takes time
 * that grows with the square of the depth, and recursion after it the stack: who loads a text from
 * outside asks here first. */
#ifndef DEMOCLES_NESTING_H
#define DEMOCLES_NESTING_H

#include <stdbool.h>
#include <stddef.h>

/* Deeper than any file of democles. */
enum { NESTING_MOST = 64 };

/* Whether something in the text lies deeper than NESTING_MOST; where, counted from 1. What is not
 * YAML is looked at up to its first mistake. */
bool nesting_is_too_deep(const char *text, size_t length, int *line, int *column);

#endif
