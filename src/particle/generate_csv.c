/* Elements from a CSV file: a header that names the columns, in any order, then a line per element
 * in SI units. Spaces around a field and empty lines do not count. Each fault is reported with
 * file:line:column, up to ten per file. */
#include "base/files.h"
#include "comm/fail.h"
#include "generate_parts.h"
#include "base/nearest.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>

enum { N_COLUMN = 10, N_NEEDED = 4, RADIUS = 3, LINEAR = 4, ANGULAR = 7, MOST_FAULTS = 10 };
static const char *const column_name[N_COLUMN] = {
    "x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz"};

struct csv {
    const char *path;
    int line, n_fault;
    int n_field;
    int *column; /* [n_field] of column_name, by position in the file; -1: unknown */
    bool has[N_COLUMN];
    struct scene_errors *errors;
};

/* A stretch of a line without the spaces around it. */
struct field {
    const char *at;
    int length, column;
};

static void fault(struct csv *csv, int column, const char *text)
{
    if (csv->n_fault++ < MOST_FAULTS)
        scene_errors_add(csv->errors, "%s:%d:%d: %s", csv->path, csv->line, column, text);
}

/* The field that begins at *at; moves *at to behind its comma, or to NULL after the last one. */
static struct field next_field(const char *line, const char **at)
{
    const char *start = *at, *end = start + strcspn(start, ",");
    *at = *end ? end + 1 : NULL;
    while (start < end && isspace((unsigned char)*start)) start++;
    while (end > start && isspace((unsigned char)end[-1])) end--;
    return (struct field){start, (int)(end - start), (int)(start - line) + 1};
}

static bool is_blank(const char *line)
{
    return line[strspn(line, " \t\r\n")] == 0;
}

static void read_header(struct csv *csv, const char *line)
{
    for (const char *at = line; at;) {
        struct field field = next_field(line, &at);
        char *name = fail_format("%.*s", field.length, field.at), *text = NULL;
        csv->column = fail_realloc(csv->column, ((size_t)csv->n_field + 1) * sizeof(int));
        int column = N_COLUMN - 1;
        while (column >= 0 && strcmp(name, column_name[column]) != 0) column--;
        if (column < 0) {
            const char *near = nearest_name(name, column_name, N_COLUMN);
            text = near ? fail_format("unknown column '%s'; did you mean '%s'?", name, near)
                        : fail_format("unknown column '%s'; the first line names columns of "
                                      "x,y,z,radius,vx,vy,vz,wx,wy,wz",
                              name);
        } else if (csv->has[column]) {
            text = fail_format("column '%s' is there twice", name);
        } else {
            csv->has[column] = true;
        }
        if (text) fault(csv, field.column, text);
        csv->column[csv->n_field++] = column;
        free(name);
        free(text);
    }
    for (int c = 0; c < N_NEEDED; c++)
        if (!csv->has[c]) {
            char *text = fail_format("column '%s' is missing", column_name[c]);
            fault(csv, 1, text);
            free(text);
        }
}

/* One number of a row; a fault if it is not one, or not finite, or a radius that is not
 * positive. */
static double read_number(struct csv *csv, struct field field, int column)
{
    char *end, *text = NULL;
    double value = strtod(field.at, &end);
    const char *name = column_name[column];
    if (field.length == 0) text = fail_format("%s is empty", name);
    else if (end != field.at + field.length)
        text = fail_format("%s: '%.*s' is not a number", name, field.length, field.at);
    else if (!isfinite(value))
        text = fail_format("%s: '%.*s' is not finite", name, field.length, field.at);
    else if (column == RADIUS && !(value > 0))
        text = fail_format("radius: '%.*s' is not positive", field.length, field.at);
    if (text) fault(csv, field.column, text);
    free(text);
    return value;
}

/* Values by column into value [N_COLUMN]; false if the row has a fault. */
static bool read_row(struct csv *csv, const char *line, double *value)
{
    int before = csv->n_fault, n = 0;
    struct field field = {line, 0, 1};
    for (const char *at = line; at; n++) {
        field = next_field(line, &at);
        if (n < csv->n_field) value[csv->column[n]] = read_number(csv, field, csv->column[n]);
    }
    if (n != csv->n_field) {
        char *text = fail_format("%d columns, the header has %d", n, csv->n_field);
        fault(csv, field.column, text);
        free(text);
    }
    return csv->n_fault == before;
}

static void add_row(struct generate_list *list, const struct scene *scene, int group,
    const struct csv *csv, const double *value)
{
    int64_t i = generate_add(list, scene, group, value, value[RADIUS]);
    for (int a = 0; a < 3; a++) {
        if (csv->has[LINEAR + a]) list->elements->v[3 * i + a] = value[LINEAR + a];
        if (csv->has[ANGULAR + a]) list->elements->w[3 * i + a] = value[ANGULAR + a];
    }
}

static void read_lines(
    struct generate_list *list, const struct scene *scene, int group, struct csv *csv, FILE *file)
{
    char *line = NULL;
    size_t room = 0;
    double value[N_COLUMN] = {0};
    int64_t n_row = 0;
    bool has_header = false;
    errno = 0;
    for (ssize_t n; (n = getline(&line, &room, file)) >= 0;) {
        csv->line++;
        /* byte order mark of some spreadsheets */
        const char *start =
            csv->line == 1 && strncmp(line, "\xef\xbb\xbf", 3) == 0 ? line + 3 : line;
        const char *nul = memchr(start, 0, (size_t)(n - (start - line)));
        if (nul) fault(csv, (int)(nul - start) + 1, "NUL byte: this is no text, or damaged");
        if (nul || is_blank(start)) {
            if (nul && !has_header) break;
            continue;
        }
        if (!has_header) {
            read_header(csv, start);
            if (csv->n_fault) break; /* what follows cannot be understood */
            has_header = true;
        } else if (read_row(csv, start, value)) {
            add_row(list, scene, group, csv, value);
            n_row++;
        }
    }
    if (ferror(file))
        scene_errors_add(csv->errors, "%s: %s", csv->path, strerror(errno ? errno : EIO));
    else if (n_row == 0 && csv->n_fault == 0)
        scene_errors_add(csv->errors, "%s: no element", csv->path);
    free(line);
}

void generate_read_csv(
    struct generate_list *list, const struct scene *scene, int group, struct scene_errors *errors)
{
    const struct element_group *of = scene->group + group;
    struct csv csv = {.path = of->file, .errors = errors};
    FILE *file = files_input(of->file);
    if (!file) {
        scene_errors_add(errors, "%s:%d: elements '%s': %s: %s", scene->path, of->line, of->name,
            of->file, strerror(errno));
        return;
    }
    read_lines(list, scene, group, &csv, file);
    if (csv.n_fault > MOST_FAULTS)
        scene_errors_add(errors, "%s: and %d more", csv.path, csv.n_fault - MOST_FAULTS);
    free(csv.column);
    fclose(file);
}
