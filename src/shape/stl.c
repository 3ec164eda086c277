/* Reading goes in two passes: file -> list of corners (triangle soup), then soup -> welded mesh.
 * Binary files are told from ASCII by their size, since many binary ones begin with `solid` too. */
#include "stl.h"

#include "comm/fail.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { HEADER = 84, RECORD = 50 }; /* bytes: 80 of text and a count; 12 floats and a short */

/* Corners as they come: [n][3][3]. */
struct soup {
    double *corner;
    size_t n, room;
};

static double *soup_add(struct soup *soup)
{
    if (soup->n == soup->room) {
        soup->room = soup->room ? 2 * soup->room : 256;
        soup->corner = fail_realloc(soup->corner, soup->room * 9 * sizeof(double));
    }
    return soup->corner + 9 * soup->n++;
}

static unsigned char *read_whole(const char *path, size_t *size, char **error)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        *error = fail_format("%s: %s", path, strerror(errno));
        return NULL;
    }
    unsigned char *data = NULL;
    size_t room = 1 << 16, got;
    *size = 0;
    errno = 0;
    do {
        room *= 2;
        data = fail_realloc(data, room + 1);
        got = fread(data + *size, 1, room - *size, file);
        *size += got;
    } while (*size == room);
    data[*size] = 0;
    if (ferror(file)) {
        *error = fail_format("%s: %s", path, strerror(errno ? errno : EIO));
        free(data);
        data = NULL;
    }
    fclose(file);
    return data;
}

/* Little-endian by the format, whatever the host is. */
static uint32_t u32_at(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static char *read_binary(const char *path, const unsigned char *data, struct soup *soup)
{
    uint32_t n = u32_at(data + 80);
    for (uint32_t t = 0; t < n; t++) {
        /* behind the normal */
        const unsigned char *record = data + HEADER + (size_t)t * RECORD + 12;
        double *corner = soup_add(soup);
        for (int k = 0; k < 9; k++) {
            uint32_t bits = u32_at(record + 4 * k);
            float value;
            memcpy(&value, &bits, sizeof value);
            if (!isfinite(value))
                return fail_format("%s: triangle %u: corner %d is not finite", path, t, k / 3 + 1);
            corner[k] = (double)value;
        }
    }
    return NULL;
}

/* Next word in [*at, *at + *length), counting lines; false at the end. */
static bool next_word(const char **at, size_t *length, int *line)
{
    const char *p = *at + *length;
    for (; *p && strchr(" \t\r\n", *p); p++)
        if (*p == '\n') ++*line;
    *at = p;
    *length = strcspn(p, " \t\r\n");
    return *length > 0;
}

static bool is_word(const char *at, size_t length, const char *word)
{
    return strlen(word) == length && strncasecmp(at, word, length) == 0;
}

/* Only corners count: `vertex x y z`, three to each `endloop`. Stored normals may be wrong and are
 * not read. */
static char *read_ascii(const char *path, const char *text, struct soup *soup)
{
    const char *at = text;
    size_t length = 0;
    int line = 1, n_corner = 0;
    bool ended = false;
    double corner[9];
    while (next_word(&at, &length, &line)) {
        if (is_word(at, length, "vertex")) {
            if (n_corner == 3)
                return fail_format("%s:%d: more than three corners in a triangle", path, line);
            for (int k = 0; k < 3; k++) {
                if (!next_word(&at, &length, &line))
                    return fail_format("%s:%d: the file ends within a triangle", path, line);
                char *end;
                double value = strtod(at, &end);
                if (end != at + length || !isfinite(value))
                    return fail_format(
                        "%s:%d: '%.*s' is not a finite number", path, line, (int)length, at);
                corner[3 * n_corner + k] = value;
            }
            n_corner++;
        } else if (is_word(at, length, "endloop")) {
            if (n_corner != 3)
                return fail_format(
                    "%s:%d: a triangle has %d of its 3 corners", path, line, n_corner);
            memcpy(soup_add(soup), corner, sizeof corner);
            n_corner = 0;
        } else if (is_word(at, length, "endsolid") || is_word(at, length, "solid")) {
            ended = is_word(at, length, "endsolid");
            length += strcspn(at + length, "\n"); /* a name may hold any word */
        } else if (is_word(at, length, "facet")) {
            length += strcspn(at + length, "\n");
        } else if (!is_word(at, length, "outer") && !is_word(at, length, "loop") &&
                   !is_word(at, length, "endfacet")) {
            return fail_format("%s:%d: '%.*s' is not a keyword of STL", path, line,
                (int)(length < 40 ? length : 40), at);
        }
    }
    return n_corner || !ended ? fail_format("%s:%d: the file is cut off: no 'endsolid'", path, line)
                              : NULL;
}

/* Whether it holds nothing but text where a binary file has its count: of another format, or with
 * something before `solid`. */
static bool is_text(const unsigned char *data, size_t size)
{
    for (size_t k = 0; k < size && k < HEADER; k++)
        if (data[k] < 0x20 && !strchr("\t\r\n", data[k])) return false;
    return strnlen((const char *)data, HEADER) == (size < HEADER ? size : HEADER);
}

/* Of a text with a NUL byte in it; NULL if there is none. */
static char *find_nul(const char *path, const char *text, size_t size)
{
    const char *nul = memchr(text, 0, size), *start = text;
    int line = 1;
    for (const char *p = text; nul && p < nul; p++)
        if (*p == '\n') {
            line++;
            start = p + 1;
        }
    return nul ? fail_format(
                     "%s:%d:%d: NUL byte: this text is damaged", path, line, (int)(nul - start) + 1)
               : NULL;
}

/* Whether it is text up to a first facet, not a binary file whose header begins with `solid`. */
static bool has_facet(const char *text, size_t size)
{
    static const char word[] = "facet";
    for (size_t k = 0; k + strlen(word) <= size && text[k]; k++)
        if (!strncasecmp(text + k, word, strlen(word))) return true;
    return false;
}

static char *read_soup(const char *path, const unsigned char *data, size_t size, struct soup *soup)
{
    if (size >= HEADER && size == HEADER + (size_t)u32_at(data + 80) * RECORD)
        return read_binary(path, data, soup);
    if (size >= 5 && strncasecmp((const char *)data, "solid", 5) == 0) {
        const char *text = (const char *)data;
        char *damaged = find_nul(path, text, size);
        if (!damaged) return read_ascii(path, text, soup);
        if (has_facet(text, size)) return damaged;
        free(damaged);
    }
    if (size > 0 && is_text(data, size) && strncasecmp((const char *)data, "solid", 5) != 0)
        return fail_format("%s: not an STL file: text that does not begin with 'solid'", path);
    if (size < HEADER)
        return fail_format("%s: neither ASCII nor binary STL: %zu bytes", path, size);
    size_t needed = HEADER + (size_t)u32_at(data + 80) * RECORD;
    return fail_format("%s: %s: %u triangles need %zu bytes, the file has %zu", path,
        size < needed ? "cut off" : "not an STL file", u32_at(data + 80), needed, size);
}

/* Vertices in cells of a hash table: two corners within `near` of each other in each coordinate are
 * one. */
struct weld {
    double near;
    size_t mask;
    int *head, *next; /* by hash; by vertex */
};

static size_t weld_hash(const struct weld *weld, int64_t i, int64_t j, int64_t k)
{
    uint64_t h = (uint64_t)i * 0x9e3779b97f4a7c15u ^ (uint64_t)j * 0xbf58476d1ce4e5b9u ^
                 (uint64_t)k * 0x94d049bb133111ebu;
    return (size_t)(h ^ h >> 31) & weld->mask;
}

/* Cells are 4 near wide, so most corners have but one cell within reach. */
static int weld_vertex(struct weld *weld, struct stl *stl, const double x[3])
{
    int64_t from[3], to[3];
    for (int a = 0; a < 3; a++) {
        from[a] = (int64_t)floor((x[a] - weld->near) / (4 * weld->near));
        to[a] = (int64_t)floor((x[a] + weld->near) / (4 * weld->near));
    }
    for (int64_t i = from[0]; i <= to[0]; i++)
        for (int64_t j = from[1]; j <= to[1]; j++)
            for (int64_t k = from[2]; k <= to[2]; k++)
                for (int v = weld->head[weld_hash(weld, i, j, k)]; v >= 0; v = weld->next[v]) {
                    const double *y = stl->vertex + 3 * v;
                    if (fabs(x[0] - y[0]) <= weld->near && fabs(x[1] - y[1]) <= weld->near &&
                        fabs(x[2] - y[2]) <= weld->near)
                        return v;
                }
    int v = stl->n_vertex++;
    int64_t cell[3];
    for (int a = 0; a < 3; a++) {
        stl->vertex[3 * v + a] = x[a];
        cell[a] = (int64_t)floor(x[a] / (4 * weld->near));
    }
    size_t h = weld_hash(weld, cell[0], cell[1], cell[2]);
    weld->next[v] = weld->head[h];
    weld->head[h] = v;
    return v;
}

/* No area: two corners in one, or a height below `near`. */
static bool is_flat(const struct stl *stl, const int v[3], double near)
{
    double longest = 0, ab[3], ac[3];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return true;
    for (int k = 0; k < 3; k++) {
        const double *p = stl->vertex + 3 * v[k], *q = stl->vertex + 3 * v[(k + 1) % 3];
        longest = fmax(longest, hypot(hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]));
    }
    for (int a = 0; a < 3; a++) {
        ab[a] = stl->vertex[3 * v[1] + a] - stl->vertex[3 * v[0] + a];
        ac[a] = stl->vertex[3 * v[2] + a] - stl->vertex[3 * v[0] + a];
    }
    double twice_area = hypot(hypot(ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2]),
        ab[0] * ac[1] - ab[1] * ac[0]);
    return twice_area < near * longest;
}

static void weld_soup(struct stl *stl, const struct soup *soup)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
           extent = 0, far = 1e-30;
    for (size_t k = 0; k < 9 * soup->n; k++) {
        low[k % 3] = fmin(low[k % 3], soup->corner[k]);
        high[k % 3] = fmax(high[k % 3], soup->corner[k]);
        far = fmax(far, fabs(soup->corner[k]));
    }
    for (int a = 0; a < 3; a++) extent = fmax(extent, high[a] - low[a]);
    /* the latter keeps cell numbers within 64 bits */
    struct weld weld = {.near = fmax(1e-6 * extent, 1e-15 * far), .mask = 1};
    while (weld.mask < 3 * soup->n) weld.mask *= 2;
    weld.head = fail_alloc(weld.mask * sizeof *weld.head);
    weld.next = fail_alloc(3 * soup->n * sizeof *weld.next);
    for (size_t h = 0; h < weld.mask; h++) weld.head[h] = -1;
    weld.mask--;
    stl->vertex = fail_alloc(9 * soup->n * sizeof(double));
    stl->triangle = fail_alloc(3 * soup->n * sizeof(int));
    for (size_t t = 0; t < soup->n; t++) {
        int *v = stl->triangle + 3 * stl->n_triangle;
        for (int k = 0; k < 3; k++) v[k] = weld_vertex(&weld, stl, soup->corner + 9 * t + 3 * k);
        if (is_flat(stl, v, weld.near)) stl->n_dropped++;
        else stl->n_triangle++;
    }
    free(weld.head);
    free(weld.next);
}

/* Edge with its two vertices in ascending order; `way` is +1 where the triangle runs from the lower
 * to the higher. */
struct use {
    int low, high, at, way;
};

static int compare_uses(const void *a, const void *b)
{
    const struct use *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->at > q->at) - (p->at < q->at);
}

/* Equal edges are neighbours after sorting. First edge[k] is the place of the edge's first use,
 * then (ascending, so that this one has its number already) that one's number. */
static void number_edges(struct stl *stl)
{
    int n = 3 * stl->n_triangle;
    struct use *use = fail_alloc((size_t)n * sizeof *use);
    stl->edge = fail_alloc((size_t)n * sizeof *stl->edge);
    for (int k = 0; k < n; k++) {
        int p = stl->triangle[k], q = stl->triangle[k - k % 3 + (k % 3 + 1) % 3];
        use[k] = (struct use){
            .low = p < q ? p : q, .high = p < q ? q : p, .at = k, .way = p < q ? 1 : -1};
    }
    qsort(use, (size_t)n, sizeof *use, compare_uses);
    for (int k = 0, end; k < n; k = end) {
        int sum = 0;
        for (end = k; end < n && use[end].low == use[k].low && use[end].high == use[k].high;
             end++) {
            sum += use[end].way;
            stl->edge[use[end].at] = use[k].at;
        }
        stl->n_open += sum != 0;
    }
    for (int k = 0; k < n; k++)
        stl->edge[k] = stl->edge[k] == k ? stl->n_edge++ : stl->edge[stl->edge[k]];
    free(use);
}

struct stl *stl_read(const char *path, double scale, char **error)
{
    struct soup soup = {0};
    size_t size;
    unsigned char *data = read_whole(path, &size, error);
    if (!data) return NULL;
    *error = read_soup(path, data, size, &soup);
    free(data);
    if (!*error && soup.n == 0) *error = fail_format("%s: no triangle", path);
    if (!*error && soup.n > INT32_MAX / 9)
        *error = fail_format("%s: %zu triangles are more than one surface can hold", path, soup.n);
    if (*error) {
        free(soup.corner);
        return NULL;
    }
    struct stl *stl = fail_alloc(sizeof *stl);
    weld_soup(stl, &soup);
    free(soup.corner);
    for (int k = 0; k < 3 * stl->n_vertex; k++) stl->vertex[k] *= scale;
    if (stl->n_triangle == 0) {
        *error = fail_format("%s: all triangles have zero area (%d)", path, stl->n_dropped);
        stl_free(stl);
        return NULL;
    }
    number_edges(stl);
    return stl;
}

void stl_free(struct stl *stl)
{
    if (!stl) return;
    free(stl->vertex);
    free(stl->triangle);
    free(stl->edge);
    free(stl);
}

bool stl_is_closed(const struct stl *stl)
{
    return stl->n_open == 0;
}
