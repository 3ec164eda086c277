/* A table of columns while it is being put together, with the memory that its columns own. */
#ifndef DEMOCLES_SHEET_H
#define DEMOCLES_SHEET_H

#include "column.h"

#include <stdbool.h>

enum { SHEET_COLUMNS = 16 };

struct sheet {
    struct column column[SHEET_COLUMNS];
    int n;
    void *own[2 * SHEET_COLUMNS];
    int n_own;
};

/* Memory that sheet_free gives back; returns it. */
void *sheet_keep(struct sheet *sheet, void *memory);
void sheet_add(struct sheet *sheet, const char *name, const char *unit, const char *text,
    enum column_type type, int width, const void *data);
/* n rows of doubles; those that came from floats go back to floats: the state's own bits. */
void sheet_add_real(struct sheet *sheet, bool is_float, const char *name, const char *unit,
    const char *text, int width, const double *data, size_t n);
void sheet_free(struct sheet *sheet);

#endif
