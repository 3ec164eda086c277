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

static void write_quoted(struct scene_text *text, const char *value)
{
    scene_write(text, "\"");
    for (const char *p = value; *p; p++) {
        if (*p == '"' || *p == '\\') scene_write(text, "\\%c", *p);
        else if ((unsigned char)*p < 0x20 || *p == 0x7f) scene_write(text, "\\x%02x", *p);
        else scene_write(text, "%c", *p);
    }
    scene_write(text, "\"");
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
