/* Something with a name that a run writes: a field of a frame, a column of a time series. */
#ifndef DEMOCLES_SCENE_ITEM_H
#define DEMOCLES_SCENE_ITEM_H

struct scene_item {
    const char *name; /* NULL: end of a list */
    const char *unit; /* m/s; 1 for a pure number */
    const char *text; /* what it is */
};

#endif
