/* Small files as a whole: read, and replaced so that a reader sees the old or the new one, never
 * half of it. Serial; errors come back as text. */
#ifndef DEMOCLES_FILES_H
#define DEMOCLES_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { FILES_ERROR_SIZE = 512 };

/* The whole file, NUL-terminated (not counted in `n`), in fresh memory owned by the caller; NULL
 * and `error` on failure, or where it is a pipe or a device: for files that a run has written. */
char *files_read(const char *path, size_t *n, char error[FILES_ERROR_SIZE]);

/* Whether to open it neither waits, as for a pipe that nobody writes into, nor does anything else,
 * as a device may: an ordinary file, a folder (reading of which is an error), or nothing. */
bool files_is_ordinary(const char *path);

/* Opens a file for reading; NULL and errno. Reading from a pipe or a terminal waits for whoever
 * writes into it, and a request to stop ends the program meanwhile (signals_obey). What never ends,
 * such as /dev/zero, is not opened. */
FILE *files_input(const char *path);

/* Whether an ordinary file, not a link, is there and begins with `text`. */
bool files_begins(const char *path, const char *text);

/* Opens /dev/null where the standard input, output or error is closed. Else the next file or pipe
 * that a library opens would have their number, and get what is printed. First of all in main. */
void files_hold_standard(void);

/* Whether nobody reads any more what is written to the standard output: a pipe whose other end is
 * closed, as by `| head -1`, or a terminal that has gone. */
bool files_reader_is_gone(void);

/* A name beside `path` for what is not whole yet, PATH.PID.tmp: no two runs, and no user, have the
 * same. In fresh memory owned by the caller. */
char *files_tmp(const char *path);
/* The PATH of such a name, in fresh memory owned by the caller; NULL: it is not of that form. */
char *files_tmp_of(const char *name);
/* Opens a file that this call makes: whatever has the name already, be it a link to nowhere, is an
 * error. Returns the descriptor, or -1 and `error`. */
int files_create(const char *path, char error[FILES_ERROR_SIZE]);
/* Opens a file for reading and for writing at its end, and makes it where there is none. A link is
 * not followed, and what is no file is not opened. Returns the descriptor, or -1 and `error`. */
int files_append(const char *path, char error[FILES_ERROR_SIZE]);
/* Writes PATH.PID.tmp, syncs, renames: a link at `path` is replaced, not followed. On failure
 * nothing is left over; returns false and `error`. */
bool files_replace(const char *path, const void *data, size_t n, char error[FILES_ERROR_SIZE]);
/* The last steps of that: rename `tmp` (written and synced) to `path`, sync the folder. Removes
 * `tmp` on failure. */
bool files_commit(const char *tmp, const char *path, char error[FILES_ERROR_SIZE]);

#endif
