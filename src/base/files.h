/* Small files as a whole: read, and replaced so that a reader sees the old or the new one, never
 * half of it. Serial; errors come back as text. */
#ifndef DEMOCLES_FILES_H
#define DEMOCLES_FILES_H

#include <stdbool.h>
#include <stddef.h>

enum { FILES_ERROR_SIZE = 512 };

/* The whole file, NUL-terminated (not counted in `n`), in fresh memory owned by the caller; NULL
 * and `error` on failure. */
char *files_read(const char *path, size_t *n, char error[FILES_ERROR_SIZE]);
/* Writes PATH.tmp, syncs, renames. On failure nothing is left over; returns false and `error`. */
bool files_replace(const char *path, const void *data, size_t n, char error[FILES_ERROR_SIZE]);
/* The last steps of that: rename `tmp` (written and synced) to `path`, sync the folder. Removes
 * `tmp` on failure. */
bool files_commit(const char *tmp, const char *path, char error[FILES_ERROR_SIZE]);

#endif
