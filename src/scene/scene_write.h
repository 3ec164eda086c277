/* YAML text that grows line by line: block mappings and lists, flow lists for vectors. For the
 * resolved scene. */
#ifndef DEMOCLES_SCENE_WRITE_H
#define DEMOCLES_SCENE_WRITE_H

#include <stdbool.h>
#include <stddef.h>

struct scene_text {
    char *bytes; /* terminated; NULL while empty */
    size_t n, capacity;
    bool dash; /* the next key opens an entry of a list */
};

void scene_write(struct scene_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* "  name:", indented by two blanks per depth; the value follows with scene_write_value ("
 * value\n"), or scene_write_end ends the line. */
void scene_write_key(struct scene_text *text, int depth, const char *name);
void scene_write_value(struct scene_text *text, const char *value);
/* Text as a YAML scalar, quoted where it must be. */
void scene_write_string(struct scene_text *text, const char *value);
/* Whether a text (UTF-8) has characters that stand as escapes in YAML: controls, line breaks. */
bool scene_write_has_unsafe(const char *value);
void scene_write_number(struct scene_text *text, double value);
void scene_write_end(struct scene_text *text);
/* Ends the line of a key whose entries follow; scene_write_close gives what scene_write_open
 * returned, and "{}" or "[]" if none did. */
size_t scene_write_open(struct scene_text *text);
void scene_write_close(struct scene_text *text, size_t opened, const char *empty);

#endif
