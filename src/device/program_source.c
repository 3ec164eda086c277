/* Joins kernel files into one text: #include "x.h" is replaced by the header the first time and by
 * nothing later, so the headers need no guard against that (they have one for the host) and must
 * not be included under an #if. #line marks let the compiler's messages name the file and line of
 * kernels/. */
#include "program.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "kernel_source.h"

enum { MAX_FILES = 64 };

struct join {
    FILE *out;
    int n_done;
    char *done[MAX_FILES]; /* headers that are in */
};

static const struct kernel_source *embedded(const char *name)
{
    const struct kernel_source *known = kernel_source_table;
    while (known->name && strcmp(known->name, name) != 0) known++;
    return known;
}

/* Text of a kernel file, freed by the caller. */
static char *kernel_text(const char *name)
{
    const char *folder = getenv("DEMOCLES_KERNELS");
    const struct kernel_source *known = embedded(name);
    if (!folder || !folder[0]) {
        if (!known->name) fail_stop(EXIT_DEVICE, "kernel file %s is not in this executable", name);
        return fail_strdup(known->text);
    }
    /* The folder is laid out as kernels/, or is flat. */
    char *path = fail_format("%s/%s/%s", folder, known->name ? known->folder : ".", name),
         *text = NULL;
    size_t bytes = 0;
    FILE *file = fopen(path, "r"), *copy = open_memstream(&text, &bytes);
    if (!file) {
        free(path);
        path = fail_format("%s/%s", folder, name);
        file = fopen(path, "r");
    }
    if (!file || !copy)
        fail_stop(EXIT_DEVICE, "DEMOCLES_KERNELS: cannot read %s: %s", path, strerror(errno));
    for (int c; (c = getc(file)) != EOF;) putc(c, copy);
    if (ferror(file))
        fail_stop(EXIT_DEVICE, "DEMOCLES_KERNELS: cannot read %s: %s", path, strerror(errno));
    fclose(copy);
    fclose(file);
    free(path);
    return text;
}

/* If the line is #include "name": the name without folders, in fresh memory. */
static char *included(const char *line, size_t n)
{
    char *copy = fail_alloc(n + 1), *name = NULL;
    memcpy(copy, line, n);
    char *at = copy + strspn(copy, " \t");
    if (*at == '#') {
        at += 1 + strspn(at + 1, " \t");
        if (strncmp(at, "include", 7) == 0) {
            char *open = strchr(at, '"'), *close = open ? strchr(open + 1, '"') : NULL;
            if (close) {
                *close = 0;
                char *slash = strrchr(open + 1, '/');
                name = fail_strdup(slash ? slash + 1 : open + 1);
            }
        }
    }
    free(copy);
    return name;
}

static bool first_time(struct join *join, const char *name)
{
    for (int i = 0; i < join->n_done; i++)
        if (strcmp(join->done[i], name) == 0) return false;
    if (join->n_done == MAX_FILES)
        fail_stop(EXIT_DEVICE, "more than %d kernel headers in one program", MAX_FILES);
    join->done[join->n_done++] = fail_strdup(name);
    return true;
}

static void append(struct join *join, const char *name)
{
    char *text = kernel_text(name);
    int number = 1;
    fprintf(join->out, "#line 1 \"%s\"\n", name);
    for (const char *line = text; *line; number++) {
        size_t n = strcspn(line, "\n");
        char *header = included(line, n);
        if (!header) fprintf(join->out, "%.*s\n", (int)n, line);
        else {
            if (first_time(join, header)) append(join, header);
            fprintf(join->out, "#line %d \"%s\"\n", number + 1, name);
        }
        free(header);
        line += n + (line[n] == '\n');
    }
    free(text);
}

char *program_source(const char *const *sources)
{
    char *text = NULL;
    size_t bytes = 0;
    struct join join = {.out = open_memstream(&text, &bytes)};
    if (!join.out) fail_stop(EXIT_IO, "out of memory");
    /* what the program needs whatever the kernels are: from the executable, not from a folder */
    fprintf(join.out, "#line 1 \"builtins.h\"\n%s", embedded("builtins.h")->text);
    for (; *sources; sources++) append(&join, *sources);
    fclose(join.out);
    for (int i = 0; i < join.n_done; i++) free(join.done[i]);
    return text;
}
