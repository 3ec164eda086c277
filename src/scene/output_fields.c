#include "output_fields.h"

#include <stddef.h>

/* Rows that output.fields cannot name stay out of the list. */
#define ITEM_STATE(...)
#define ITEM_ALWAYS(...)
#define ITEM_SHOWN(...) {__VA_ARGS__},
#define ITEM_BOTH ITEM_SHOWN
#define ITEM_AGAIN ITEM_SHOWN
#define ITEM_CORNERS ITEM_SHOWN
#define ITEM(name, unit, width, number, use, when, source, text) ITEM_##use(#name, unit, text)

const struct scene_item output_fields_particles[] = {
    OUTPUT_FIELDS_PARTICLES(ITEM){NULL, NULL, NULL}};
const struct scene_item output_fields_lattice[] = {OUTPUT_FIELDS_LATTICE(ITEM){NULL, NULL, NULL}};
