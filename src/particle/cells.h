/* Cell lists: elements sorted into grids of several levels, so that the neighbours of an element
 * are found whatever the mix of sizes. kernels/particle/grid.h and cells.cl describe the grids. */
#ifndef DEMOCLES_CELLS_H
#define DEMOCLES_CELLS_H

#include "particles.h"
#include "device/scan.h"

enum { CELLS_LEVELS = 10 };

/* Bounds of a set of elements: box of centres, smallest and largest listing reach [m], largest
 * speed [m/s]. */
struct cells_bounds {
    double low[3], high[3], reach_min, reach_max, speed;
    bool has_nan;
};

struct cells {
    const struct features *features;
    double period[3]; /* [m], 0 where not periodic */
    double domain[6]; /* low, high [m]: periodic grids span it */
    int n_level;
    int64_t n_cell;                    /* of all levels */
    struct buffer grid_real, grid_int; /* [n_level][GRID_REALS], [GRID_INTS], see grid.h */
    struct buffer key;                 /* int [n] cell of each element */
    struct buffer begin, cursor;       /* int [n_cell + 1] first member of each cell; work space */
    struct buffer member;              /* int [n] elements, cell by cell */
    struct buffer partial;             /* preal: bounds of each group of elements */
    struct launch *bounds, *count, *fill, *order, *copy;
};

struct cells *cells_create(struct device *dev, const struct features *features,
    const struct program *lists, const double period[3], const double domain[6]);
void cells_free(struct cells *cells);

/* Bounds of the first n elements; reach as it stands. Blocking. low > high for n = 0. */
struct cells_bounds cells_bounds(struct cells *cells, const struct particles *p, int64_t n);

/* Sorts the first n elements by cell; levels and sizes follow from the bounds. */
void cells_sort(struct cells *cells, struct scan *scan, const struct particles *p, int64_t n,
    const struct cells_bounds *bounds);

/* Storage order: cells->member gets the elements with keep[i] != 0 cell by cell, the others
 * last. */
void cells_order(struct cells *cells, struct scan *scan, const struct particles *p, int64_t n,
    const struct cells_bounds *bounds, const struct buffer *keep);

#endif
