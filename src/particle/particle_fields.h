/* The fields of elements in frames: the rows of scene/output_fields.h with where their numbers
 * are. */
#ifndef DEMOCLES_PARTICLE_FIELDS_H
#define DEMOCLES_PARTICLE_FIELDS_H

#include "particle.h"
#include "results/frame_table.h"
#include "results/sheet.h"

/* Adds what the scene shows of each element: its position and the fields of output.fields, in that
 * order. host: the owned elements, which outlive the sheet. Collective. */
void particle_fields_show(struct sim *s, struct sheet *sheet, const struct particles_host *host);
/* Adds what the next step depends on. */
void particle_fields_state(struct sim *s, struct sheet *sheet, const struct particles_host *host);

/* The other way: adds the columns of the state to a table of the frame s->from ... */
void particle_fields_read(struct sim *s, struct frame_table *table);
/* ... makes elements of its rows; the caller frees them ... */
struct particles_host *particle_fields_host(struct sim *s, const struct frame_table *table);
/* ... and puts its rows into the device's buffers: those that belong to the last list build, or all
 * others. */
void particle_fields_restore(struct sim *s, const struct frame_table *table, bool of_lists);

#endif
