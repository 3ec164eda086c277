#include "stl_file.h"

#include "base/files.h"
#include "comm/fail.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { HEADER = 84, RECORD = 50 }; /* bytes: 80 of text and a count; 12 floats and a short */

static double *soup_add(struct stl_soup *soup)
{
    if (soup->n == soup->room) {
        soup->room = soup->room ? 2 * soup->room : 256;
        soup->corner = fail_realloc(soup->corner, soup->room * 9 * sizeof(double));
    }
    return soup->corner + 9 * soup->n++;
}

static unsigned char *read_whole(const char *path, size_t *size, char **error)
{
    FILE *file = files_input(path);
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

/* Bytes of the record at p: with the attribute that follows it, or without. */
static size_t record_size(const unsigned char *p, bool has_payload)
{
    return RECORD + (has_payload ? (size_t)p[RECORD - 2] | (size_t)p[RECORD - 1] << 8 : 0);
}

/* Where n records end, or 0 where the file ends before. */
static size_t records_end(const unsigned char *data, size_t size, uint32_t n, bool has_payload)
{
    size_t at = HEADER;
    for (uint32_t t = 0; t < n; t++) {
        if (size - at < RECORD) return 0;
        at += record_size(data + at, has_payload);
        if (at > size) return 0;
    }
    return at;
}

static char *read_binary(
    const char *path, const unsigned char *data, bool has_payload, struct stl_soup *soup)
{
    uint32_t n = u32_at(data + HEADER - 4);
    const unsigned char *record = data + HEADER;
    for (uint32_t t = 0; t < n; t++, record += record_size(record, has_payload)) {
        double *corner = soup_add(soup);
        for (int k = 0; k < 9; k++) {
            uint32_t bits = u32_at(record + 12 + 4 * k); /* behind the normal */
            float value;
            memcpy(&value, &bits, sizeof value);
            if (!isfinite(value))
                return fail_format("%s: triangle %u: corner %d is not finite", path, t, k / 3 + 1);
            corner[k] = (double)value;
        }
    }
    return NULL;
}

/* A word of a text and the number of its line, from 1. */
struct word {
    const char *at;
    size_t length;
    int line;
};

/* The next word; false at the end. A line ends with LF, CR or both. */
static bool next_word(struct word *word)
{
    const char *p = word->at + word->length;
    for (; *p && strchr(" \t\v\f\r\n", *p); p++)
        if (*p == '\n' || (*p == '\r' && p[1] != '\n')) word->line++;
    word->at = p;
    word->length = strcspn(p, " \t\v\f\r\n");
    return word->length > 0;
}

static bool is_word(const struct word *word, const char *text)
{
    return strlen(text) == word->length && strncasecmp(word->at, text, word->length) == 0;
}

/* The word after this one, which stays. */
static bool is_followed_by(struct word word, const char *text)
{
    return next_word(&word) && is_word(&word, text);
}

/* To the last word of a name, which may hold any words but `facet normal`, on the same line. */
static void skip_name(struct word *word)
{
    struct word next = *word;
    while (next_word(&next) && next.line == word->line &&
           !(is_word(&next, "facet") && is_followed_by(next, "normal")))
        *word = next;
}

/* To the last word before those that a facet goes on with. */
static void skip_normal(struct word *word)
{
    static const char *const stops[] = {
        "outer", "loop", "vertex", "end", "endloop", "endfacet", "facet", "endsolid"};
    struct word next = *word;
    while (next_word(&next)) {
        for (size_t k = 0; k < sizeof stops / sizeof *stops; k++)
            if (is_word(&next, stops[k])) return;
        *word = next;
    }
}

/* A number, whose exponent may be written with D, as Fortran does. */
static bool read_number(const struct word *word, double *value)
{
    char text[64], *end, *d;
    if (word->length >= sizeof text) return false;
    memcpy(text, word->at, word->length);
    text[word->length] = 0;
    if ((d = strpbrk(text, "dD"))) *d = 'e';
    *value = strtod(text, &end);
    return !*end && isfinite(*value);
}

static char *read_vertex(const char *path, struct word *word, double corner[3])
{
    for (int k = 0; k < 3; k++) {
        if (!next_word(word))
            return fail_format("%s:%d: the file ends within a triangle", path, word->line);
        if (!read_number(word, &corner[k]))
            return fail_format("%s:%d: '%.*s' is not a finite number", path, word->line,
                (int)(word->length < 40 ? word->length : 40), word->at);
    }
    return NULL;
}

/* Only corners count: `vertex x y z`, three to each `endloop`. */
static char *read_ascii(const char *path, const char *text, struct stl_soup *soup)
{
    struct word word = {text, 0, 1};
    int n_corner = 0;
    bool ended = false;
    double corner[9];
    while (next_word(&word)) {
        /* `end loop` is `endloop` */
        bool end = is_word(&word, "end") && next_word(&word);
        if (is_word(&word, "vertex")) {
            if (n_corner == 3)
                return fail_format("%s:%d: more than three corners in a triangle", path, word.line);
            char *error = read_vertex(path, &word, corner + 3 * n_corner++);
            if (error) return error;
        } else if (is_word(&word, end ? "loop" : "endloop")) {
            if (n_corner != 3)
                return fail_format(
                    "%s:%d: a triangle has %d of its 3 corners", path, word.line, n_corner);
            memcpy(soup_add(soup), corner, sizeof corner);
            n_corner = 0;
        } else if (is_word(&word, "endsolid") || is_word(&word, "solid")) {
            ended = end || is_word(&word, "endsolid");
            skip_name(&word);
        } else if (is_word(&word, "facet") && !end) {
            ended = false;
            skip_normal(&word);
        } else if (!is_word(&word, "outer") && !is_word(&word, "loop") &&
                   !is_word(&word, end ? "facet" : "endfacet")) {
            return fail_format("%s:%d: '%.*s' is not a keyword of STL", path, word.line,
                (int)(word.length < 40 ? word.length : 40), word.at);
        }
    }
    return n_corner || !ended
               ? fail_format("%s:%d: the file is cut off: no 'endsolid'", path, word.line)
               : NULL;
}

/* Length of a text without NULs, control-Z and blanks after its end. */
static size_t text_size(const unsigned char *data, size_t size)
{
    while (size > 0 && memchr(" \t\v\f\r\n\x1a", data[size - 1], 8)) size--; /* 8: NUL, too */
    return size;
}

/* Where a text begins, behind a byte order mark and blanks. */
static const char *text_begin(const unsigned char *data)
{
    const char *text = (const char *)data;
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0) text += 3;
    return text + strspn(text, " \t\v\f\r\n");
}

/* Whether it holds nothing but text where a binary file has its count: of another format, or with
 * something before `solid`. */
static bool is_text(const unsigned char *data, size_t size)
{
    for (size_t k = 0; k < size && k < HEADER; k++)
        if (data[k] < 0x20 && !strchr("\t\r\n", data[k])) return false;
    return strnlen((const char *)data, HEADER) == (size < HEADER ? size : HEADER);
}

/* Where the text ends too early. */
static char *nul_in(const char *path, const char *text)
{
    const char *start = text, *p = text;
    int line = 1;
    for (; *p; p++)
        if (*p == '\n' || (*p == '\r' && p[1] != '\n')) {
            line++;
            start = p + 1;
        }
    return fail_format(
        "%s:%d:%d: NUL byte: this text is damaged", path, line, (int)(p - start) + 1);
}

/* Whether it is text up to a first facet, not a binary file whose header begins with `solid`. */
static bool has_facet(const char *text)
{
    for (; *text; text++)
        if (strncasecmp(text, "facet", 5) == 0) return true;
    return false;
}

static char *read_soup(const char *path, unsigned char *data, size_t size, struct stl_soup *soup)
{
    uint32_t n = size >= HEADER ? u32_at(data + HEADER - 4) : 0;
    if (size >= HEADER && size == HEADER + (size_t)n * RECORD)
        return read_binary(path, data, false, soup);
    if (size >= 2 && (memcmp(data, "\xff\xfe", 2) == 0 || memcmp(data, "\xfe\xff", 2) == 0))
        return fail_format("%s: UTF-16 text; save it as ASCII or UTF-8", path);
    size_t n_text = text_size(data, size);
    bool is_solid = strncasecmp(text_begin(data), "solid", 5) == 0;
    if (is_solid && !memchr(data, 0, n_text)) {
        data[n_text] = 0;
        return read_ascii(path, text_begin(data), soup);
    }
    if (is_solid && has_facet((const char *)data)) return nul_in(path, (const char *)data);
    if (size > 0 && is_text(data, size))
        return fail_format("%s: not an STL file: text that does not begin with 'solid'", path);
    if (size < HEADER)
        return fail_format("%s: neither ASCII nor binary STL: %zu bytes", path, size);
    /* to the last byte with attributes, or without them and with something behind the triangles */
    bool has_payload = records_end(data, size, n, true) == size;
    if (has_payload || records_end(data, size, n, false) > 0)
        return read_binary(path, data, has_payload, soup);
    return fail_format("%s: cut off: %u triangles need %zu bytes, the file has %zu", path, n,
        HEADER + (size_t)n * RECORD, size);
}

char *stl_file_read(const char *path, struct stl_soup *soup)
{
    char *error = NULL;
    size_t size;
    unsigned char *data = read_whole(path, &size, &error);
    if (data) error = read_soup(path, data, size, soup);
    free(data);
    return error;
}
