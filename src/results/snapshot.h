/* Frames: VTKHDF 1.0 files that ParaView opens, with the whole state beside the picture, so that a
 * run continues from any of them.
 *
 * frame_000123.hdf holds
 *   /VTKHDF         unstructured grid of one vertex, or hexahedron, per element: Points,
 *                   PointData/NAME, CellData/NAME, FieldData/TimeValue; one part per rank, rank
 *                   after rank
 *   /democles       attributes format_version, step, time, index, n_element, n_dataset (in the
 *                   whole file) and the caller's; dataset resolved (the scene as YAML)
 *   /democles/TABLE/COLUMN        every table of the state, rank after rank
 *   /democles/rows/TABLE          [n_rank] how many rows each rank had
 * Every dataset carries the attributes name, unit, description and checksum (see h5_check.h). A
 * column of the state that is a point or cell column too (same name, memory, type, width) is a hard
 * link to it, not a copy. A frame appears by rename, complete and on disk, or not at all. Knows no
 * element, no device: it writes the tables that it is given. */
#ifndef DEMOCLES_SNAPSHOT_H
#define DEMOCLES_SNAPSHOT_H

#include "comm/comm.h"
#include "column.h"

enum { SNAPSHOT_FORMAT_VERSION = 2 };

/* A number that belongs to the frame as a whole, the same on every rank: an attribute of
 * /democles. */
struct frame_scalar {
    const char *name;
    enum column_type type; /* COLUMN_F64 or COLUMN_I64 */
    double f64;
    int64_t i64;
};

struct frame {
    int64_t step;
    double time;   /* [s] */
    int64_t index; /* number in the file's name */
    /* column 0: position [n][3] F64 or F32 [m]; the others become PointData */
    struct table points;
    /* each eight points that follow each other are the corners of a cell, in VTK's order; else each
     * point is a cell */
    bool hexahedra;
    struct table cells;        /* CellData, a row per cell */
    const struct table *state; /* [n_state] the whole state, below /democles */
    int n_state;
    const char *resolved;              /* the resolved scene as YAML text, same on every rank */
    const struct frame_scalar *scalar; /* [n_scalar] */
    int n_scalar;
};

/* Writes DIR/frame_INDEX.hdf. Collective. On failure: no half file is left, one message, all ranks
 * stop with EXIT_IO. */
void snapshot_write(const struct comm *comm, const char *dir, const struct frame *frame);

/* Whether positions and the first table of the state, what moves, are finite on all ranks: a frame
 * from which a run can go on. Collective. */
bool snapshot_is_finite(const struct comm *comm, const struct frame *frame);

/* `DIR/frame_000123.hdf` in fresh memory, owned by the caller. */
char *snapshot_path(const char *dir, int64_t index);
/* The number of a frame by its name in DIR, as snapshot_path writes it and in no other way
 * (frame_7.hdf and frame_000007_kept.hdf are somebody else's); -1: no frame. */
int64_t snapshot_index(const char *name);

/* Compares the frame's version and number of datasets, reads every dataset, each rank its share,
 * and compares its checksum: in a child process, the program itself, which survives what HDF5 does
 * with a damaged file. Returns NULL if the frame is whole, else what is wrong with it, in
 * fresh memory owned by the caller, the same on every rank. Collective; `comm` NULL: alone. */
char *snapshot_check(const struct comm *comm, const char *path);

/* Every program that calls snapshot_check calls this first in main, before MPI: it serves as that
 * child, and then does not return. */
void snapshot_serve(int argc, char **argv);

#endif
