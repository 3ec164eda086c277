/* The one table of the scene's keys. Parser, errors, defaults, `explain` and `check --resolved` all
 * follow it: a new key is a new row.
 *
 * Paths are patterns: "contacts[].normal.law" is a key of every entry of a list,
 * "materials.NAME.density" of every named entry. An entry of a list or a named entry is a record: a
 * struct of its own; the keys below it are stored at offsets into that struct, all others into
 * struct scene. A key that means one thing to particles and another to the lattice has a row for
 * each. Rules that tie several keys together beyond ONE_OF and `when` are in scene_check*.c. */
#ifndef DEMOCLES_SCENE_KEYS_H
#define DEMOCLES_SCENE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "scene.h"
#include "scene_item.h"
#include "units.h"

enum key_type {
    KEY_MAP,      /* mapping with keys of its own, stored in the same record */
    KEY_LIST,     /* list of mappings, each a record */
    KEY_NAMED,    /* mapping from names to mappings, each a record */
    KEY_NUMBER,   /* double */
    KEY_SPAN,     /* double[2]: a number, or {min, max} */
    KEY_VECTOR,   /* double[width] */
    KEY_INTEGER,  /* long */
    KEY_BOOL,     /* bool */
    KEY_CHOICE,   /* int: index into words */
    KEY_TEXT,     /* char * */
    KEY_NAME,     /* char *, unique in its list */
    KEY_FILE,     /* char *, existing file, relative to the scene */
    KEY_MATERIAL, /* int: index of a material given by name */
    KEY_WALL,     /* int: index of a wall */
    KEY_BODY,     /* int: index of a body */
    KEY_PAIR,     /* int[2]: two materials */
    KEY_AXES,     /* bool[]: a list out of words, such as x, y, z */
    KEY_WORDS,    /* char *[], int: a list out of words */
    KEY_TABLE     /* double (*)[2], int: a list of pairs of time and factor, or a file of them */
};

enum key_need {
    OPTIONAL,
    NEEDED,
    ONE_OF,     /* exactly one of the keys so marked in a mapping */
    AT_MOST_ONE /* at most one of them */
};

/* Allowed numbers; `given` false: all. Applies to each component of a vector. */
struct key_range {
    bool given, low_open, high_open;
    double low, high;
};

/* What else a key's presence sets in its record: an int or a bool. */
struct key_mark {
    size_t at; /* 1 + offset; 0: nothing */
    bool is_bool;
    int value;
};

struct scene_key {
    const char *path;
    enum key_type type;
    enum key_need need;
    enum unit_kind unit;
    const char *fallback; /* default as YAML text; NULL: none */
    struct key_range range;
    /* KEY_CHOICE, KEY_WORDS: "linear|hertz", in the order of the enum, an empty one cannot be
     * chosen */
    const char *words;
    /* what `explain` adds: the words of KEY_WORDS one by one, or the columns that a measure has */
    const struct scene_item *items;
    /* KEY_CHOICE: "old|new": a word of the release before that still stands for one of `words` */
    const char *renamed;
    /* KEY_NUMBER, KEY_INTEGER, KEY_VECTOR, KEY_MAP: a word in place of a number, of the mapping
     * ... */
    const char *special;
    double special_value; /* ... and what is stored for it */
    double absent;        /* number stored where the key is neither given nor has a default */
    double factor;        /* stored value = factor * given value; 0: 1 */
    /* "particles", "lattice": the key, and what is below it, belongs to that method; NULL: to
     * both */
    const char *only;
    /* "law: linear", "stl": allowed (and needed) only beside this sibling value, this sibling;
     * "normal.law: hertz": beside this value in a sibling mapping */
    const char *when;
    size_t at; /* 1 + offset into the record; 0: not stored */
    /* KEY_LIST, KEY_NAMED, KEY_WORDS, KEY_TABLE: 1 + offset of the number (int) */
    size_t count_at;
    size_t size; /* KEY_LIST, KEY_NAMED: bytes of a record */
    /* KEY_LIST: 1 + offset of the line (int), or 0; KEY_NAMED: of the name (char *) */
    size_t label_at;
    size_t column_at; /* KEY_LIST: 1 + offset of the column (int), or 0 */
    int width;        /* KEY_VECTOR */
    struct key_mark mark;
    const char *text; /* one sentence */
};

extern const struct scene_key scene_keys[];
extern const int scene_keys_n;

/* The key's own word: "law" of "contacts[].normal.law". */
const char *scene_key_name(const struct scene_key *key);
/* The word of a KEY_CHOICE for a stored value, the default for one that cannot be chosen; owned by
 * the caller. */
char *scene_key_word(const char *path, int value);
/* Whether the key stands directly below the pattern ("" is the root, "contacts[]" an entry). */
bool scene_key_is_child(const struct scene_key *key, const char *pattern);
/* Whether it is stored in the record that `pattern` opens: below it at any depth, but not in a list
 * further down. */
bool scene_key_is_in_record(const struct scene_key *key, const char *pattern);
/* Whether scenes of that method have the key. */
bool scene_key_belongs(const struct scene_key *key, enum method method);
/* Where it is stored, or NULL. */
void *scene_key_place(const struct scene_key *key, void *record);

/* "must be > 0", "must be from 0 to 1", "" for no range. */
void scene_key_range_text(const struct key_range *range, char *text, size_t size);
bool scene_key_in_range(const struct key_range *range, double value);

#endif
