#include "scene_write.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "comm/fail.h"
#include "units.h"

void scene_write(struct scene_text *text, const char *format, ...)
{
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    size_t more = (size_t)vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (text->n + more + 1 > text->capacity) {
        text->capacity = 2 * (text->n + more + 1);
        text->bytes = fail_realloc(text->bytes, text->capacity);
    }
    vsnprintf(text->bytes + text->n, more + 1, format, again);
    va_end(again);
    text->n += more;
}

/* Words that no YAML reader takes for anything but text need no quotes. */
static bool is_plain(const char *value)
{
    if (!isalpha((unsigned char)value[0])) return false;
    static const char *const reserved[] = {"true", "false", "yes", "no", "on", "off", "null"};
    for (size_t k = 0; k < sizeof reserved / sizeof *reserved; k++)
        if (strcasecmp(value, reserved[k]) == 0) return false;
    for (const char *p = value; *p; p++)
        if (!isalnum((unsigned char)*p) && *p != '_' && *p != '-') return false;
    return true;
}

/* The code point of the UTF-8 character at *at, which moves behind it. */
static unsigned long next_character(const char **at)
{
    const unsigned char *p = (const unsigned char *)*at;
    int more = p[0] < 0x80 ? 0 : p[0] < 0xe0 ? 1 : p[0] < 0xf0 ? 2 : 3;
    unsigned long c = more == 0 ? p[0] : p[0] & (0x3fu >> more);
    for (int k = 1; k <= more && p[k]; k++) c = c << 6 | (p[k] & 0x3f);
    *at += more + 1;
    return c;
}

/* What YAML takes for a line break, or allows only as an escape: controls, NEL, the separators, the
 * byte order mark, what is no character. */
static bool is_unsafe(unsigned long c)
{
    return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x2028 || c == 0x2029 || c == 0xfeff ||
           c == 0xfffe || c == 0xffff;
}

static void write_quoted(struct scene_text *text, const char *value)
{
    scene_write(text, "\"");
    for (const char *p = value, *from = p; *p; from = p) {
        unsigned long c = next_character(&p);
        if (c == '"' || c == '\\') scene_write(text, "\\%c", (char)c);
        else if (is_unsafe(c)) scene_write(text, c < 0x100 ? "\\x%02lx" : "\\u%04lx", c);
        else scene_write(text, "%.*s", (int)(p - from), from);
    }
    scene_write(text, "\"");
}

bool scene_write_has_unsafe(const char *value)
{
    while (*value)
        if (is_unsafe(next_character(&value))) return true;
    return false;
}

void scene_write_string(struct scene_text *text, const char *value)
{
    if (is_plain(value)) scene_write(text, "%s", value);
    else write_quoted(text, value);
}

void scene_write_key(struct scene_text *text, int depth, const char *name)
{
    scene_write(text, "%*s%s", 2 * depth - (text->dash ? 2 : 0), "", text->dash ? "- " : "");
    text->dash = false;
    scene_write_string(text, name);
    scene_write(text, ":");
}

void scene_write_value(struct scene_text *text, const char *value)
{
    scene_write(text, " %s\n", value);
}

void scene_write_number(struct scene_text *text, double value)
{
    char number[32];
    units_print(value, number);
    scene_write(text, "%s", number);
}

void scene_write_end(struct scene_text *text)
{
    scene_write(text, "\n");
}

size_t scene_write_open(struct scene_text *text)
{
    scene_write_end(text);
    return text->n;
}

void scene_write_close(struct scene_text *text, size_t opened, const char *empty)
{
    if (text->n > opened) return;
    text->n--; /* the end of the key's line */
    scene_write(text, " %s\n", empty);
}
