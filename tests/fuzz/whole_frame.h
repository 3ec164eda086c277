/* A frame for the fuzz targets to change, and the reading of it as a run that goes on reads one. */
#ifndef WHOLE_FRAME_H
#define WHOLE_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Where it lies; one for all calls. */
const char *whole_frame_path(void);
/* Writes it anew. Returns its size. */
size_t whole_frame_put(void);

/* Reads attributes, texts and tables, and checks them, as a resumed run does. Returns whether all
 * that could be used; where it could not, a message was given and the exit code was EXIT_IO. */
bool whole_frame_read(void);
/* The same of a frame that is said to be undamaged: its numbers have to be those that were
 * written. */
void whole_frame_expect(void);

#endif
