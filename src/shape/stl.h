/* Triangle surfaces from STL files, binary or ASCII, as a welded mesh. Knows no scene and no
 * wall. */
#ifndef DEMOCLES_STL_H
#define DEMOCLES_STL_H

#include <stdbool.h>

struct stl {
    int n_vertex, n_triangle, n_edge;
    double *vertex; /* [n_vertex][3] [m] */
    int *triangle;  /* [n_triangle][3] vertices, in the order of the file */
    /* [n_triangle][3] edge k joins corners k and (k + 1) % 3; numbered in order of appearance */
    int *edge;
    int n_dropped; /* triangles of the file without area */
    /* edges that are not run through as often one way as the other: 0 on a closed, consistently
     * oriented surface */
    int n_open;
};

/* Reads a file and multiplies by `scale` (metres per unit). Corners closer than 1e-6 of the largest
 * extent are one vertex; triangles that lose their area by that, or have none, are dropped. NULL
 * with a text in *error (the caller frees it; it names the file) where the file cannot be read, is
 * cut off, has no triangle, or a number that is none. */
struct stl *stl_read(const char *path, double scale, char **error);
void stl_free(struct stl *stl);
bool stl_is_closed(const struct stl *stl);

#endif
