/* The fields of cells in frames: the rows of scene/output_fields.h with where their numbers are. */
#ifndef DEMOCLES_LATTICE_FIELDS_H
#define DEMOCLES_LATTICE_FIELDS_H

#include "lattice_method.h"
#include "results/frame_table.h"
#include "results/sheet.h"

/* Adds what the scene shows of each cell besides what its corners have: the fields of
 * output.fields, in that order. Cells of `state` in ascending id; it outlives the sheet. */
void lattice_fields_show(
    const struct sim *s, struct sheet *sheet, const struct lattice_state *state);
/* Adds what the next step depends on. */
void lattice_fields_state(
    const struct sim *s, struct sheet *sheet, const struct lattice_state *state);

/* The other way: adds the columns of the state to a table of the frame s->from ... */
void lattice_fields_read(const struct sim *s, struct frame_table *table);
/* ... and says where in the table they are; NULL: the run does not have it. Borrowed. */
struct lattice_state lattice_fields_rows(const struct sim *s, const struct frame_table *table);

/* Whether one of the fields needs the stress of the cells. */
bool lattice_fields_need_stress(char *const *field, int n);

#endif
