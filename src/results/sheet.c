#include "sheet.h"

#include <stdlib.h>

#include "comm/fail.h"

void *sheet_keep(struct sheet *sheet, void *memory)
{
    return sheet->own[sheet->n_own++] = memory;
}

void sheet_add(struct sheet *sheet, const char *name, const char *unit, const char *text,
    enum column_type type, int width, const void *data)
{
    sheet->column[sheet->n++] = (struct column){name, unit, text, type, width, data};
}

void sheet_add_real(struct sheet *sheet, bool is_float, const char *name, const char *unit,
    const char *text, int width, const double *data, size_t n)
{
    if (!is_float) {
        sheet_add(sheet, name, unit, text, COLUMN_F64, width, data);
        return;
    }
    float *small = sheet_keep(sheet, fail_alloc(n * (size_t)width * sizeof *small));
    for (size_t i = 0; i < n * (size_t)width; i++) small[i] = (float)data[i];
    sheet_add(sheet, name, unit, text, COLUMN_F32, width, small);
}

void sheet_free(struct sheet *sheet)
{
    for (int i = 0; i < sheet->n_own; i++) free(sheet->own[i]);
}
