/* What stands in an STL file: triangles, as they come. */
#ifndef SHAPE_STL_FILE_H
#define SHAPE_STL_FILE_H

#include <stddef.h>

/* Corners of triangles [n][3][3] in the file's unit of length; the caller frees `corner`. */
struct stl_soup {
    double *corner;
    size_t n, room;
};

/* Appends the triangles of a file, ASCII or binary, told apart by what they hold and how long they
 * are: many binary files begin with `solid` too. Taken as they are:
 *   ASCII: blanks or a byte order mark before `solid`; NULs, control-Z or blanks after the end; any
 *     ends of lines; a facet, or all, on one line; `end loop` for `endloop`; exponents with D;
 *   binary: bytes after the last triangle; triangles with attributes of the length that they name.
 * Stored normals may be wrong and are not read. Returns NULL, or the error, which the caller
 * frees. */
char *stl_file_read(const char *path, struct stl_soup *soup);

#endif
