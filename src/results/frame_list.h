/* DIR/frames.hdf.series: the frames of output.every with their times, as ParaView reads a series of
 * files. */
#ifndef DEMOCLES_FRAME_LIST_H
#define DEMOCLES_FRAME_LIST_H

#include "comm/comm.h"

#define FRAME_LIST_NAME "frames.hdf.series"

struct frame_list;

/* Of a folder without frames, or (upto >= 0) of one whose run goes on from frame number `upto`:
 * what the file there says of frames up to it, as far as they are there. */
struct frame_list *frame_list_create(const struct comm *comm, const char *dir, int64_t upto);
void frame_list_free(struct frame_list *list);
/* Adds a frame, if it is not there yet, and writes the file as a whole: it is always complete.
 * time [s]. Collective; failure: all stop with EXIT_IO. */
void frame_list_add(struct frame_list *list, int64_t index, double time);
/* Whether the file is one that a run has written, or not there. */
bool frame_list_is_ours(const char *path);

#endif
