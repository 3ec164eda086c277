/* What the files that make cells share. Private to
 * lattice_{cells_create,cover,cracks,cut,fit,floating,rows,shares}.c. */
#ifndef DEMOCLES_LATTICE_PARTS_H
#define DEMOCLES_LATTICE_PARTS_H

#include "lattice_cells.h"
#include "shape/region.h"

/* Cells of a body: how many, first and last along each axis. */
struct lattice_span {
    int64_t n;
    int32_t low[3], high[3];
};

/* A body on its way to cells. */
struct lattice_cut {
    const struct body *body;
    int index; /* of the body */
    struct region_shape shape, *minus;
    int size[3]; /* cells of the bounding box */
    int grid;
    int64_t shift[3];         /* of its first cell on the grid */
    struct lattice_span span; /* of the cells it has cut, before others took some */
    bool is_curved;           /* its cells have shares */
    double covered;           /* volume of its cells, in whole ones; of a curved one alone */
    int64_t n_sliver;         /* cells left out, since they hang on slivers alone */
};

/* One cell: place packed as z, y, x of 21 bits each, so that keys sort as cells do. */
struct lattice_cell {
    uint64_t key;
    int16_t body;
    bool has_centre; /* the centre is inside the body */
    int32_t share;   /* of the list; 0: whole */
};
enum { LATTICE_BITS = 21, LATTICE_MOST = (1 << LATTICE_BITS) - 1 };

struct lattice_list {
    struct lattice_cell *cell;
    size_t n, room;
    struct lattice_share *share; /* first that of a whole cell; NULL: none has shares */
    int n_share;
};

/* Opens shape and holes and counts cells along each axis; false with messages where that fails. */
bool lattice_cut_open(
    struct lattice_cut *cut, const struct scene *scene, int body, struct scene_errors *errors);
void lattice_cut_close(struct lattice_cut *cut);
/* Deals the bodies to grids; sets grid and shift of each, n and grid of cells. False with messages
 * where a grid is too large. */
bool lattice_cut_place(struct lattice_cut *cut, const struct scene *scene,
    struct lattice_cells *cells, struct scene_errors *errors);
/* Appends the body's cells, by ascending key; `share` NULL: whole. */
void lattice_cut_append(struct lattice_cut *cut, struct lattice_list *list);
void lattice_cut_add(struct lattice_cut *cut, struct lattice_list *list, const int at[3],
    bool has_centre, const struct lattice_share *share);
/* There or not, for points from the first centre on, or the first corner, one cell apart, of all
 * cells or corners of the bounding box: [z][y][x]. The caller frees. */
uint8_t *lattice_cut_fill(const struct lattice_cut *cut, bool corners);
/* The same of a body with curved surfaces, body b of n. */
void lattice_cover_append(struct lattice_cut *cut, int n, int b, struct lattice_list *list);

/* Cells have places and measured shares, no links: takes out what hangs on nothing. */
void lattice_shares_prune(struct lattice_cells *cells, struct lattice_cut *cut);
/* Links are known: one share for both ends of each, masses. */
void lattice_shares_settle(struct lattice_cells *cells);

/* Of a body that has been cut. The shape's volume is counted at the middles of 48^3 equal parts of
 * its bounding box: exact for a box, to some 0.1 % for round ones. */
struct lattice_fit lattice_fit_of(const struct lattice_cut *cut);

/* scene.yaml:LINE:COLUMN: text */
void lattice_fault(const struct scene *scene, struct scene_errors *errors, int line, int column,
    const char *format, ...) __attribute__((format(printf, 5, 6)));

/* Links are known: takes out those in the bodies' cracks. */
void lattice_cracks_cut(
    const struct scene *scene, struct lattice_cells *cells, struct scene_errors *errors);

/* Fixed DOF and rows of loads into `cells`, whose links are known. */
void lattice_loads_create(
    const struct scene *scene, struct lattice_cells *cells, struct scene_errors *errors);
void lattice_loads_free(struct lattice_loads *loads);

/* Before a relaxation: a message for each part of the joined cells that is not held and whose loads
 * at the end do not balance. Parts that are free and balanced begin at rest: nothing but the
 * damping of masses would end their flight. */
void lattice_floating_settle(
    const struct scene *scene, struct lattice_cells *cells, struct scene_errors *errors);

#endif
