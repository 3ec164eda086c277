/* What a scene needs of the kernels, and nothing more: one list of features, each 0 or 1, from
 * which the build options follow.
 *
 * Knows the scene and its walls; no device. The same list goes into run.json. */
#ifndef DEMOCLES_FEATURES_H
#define DEMOCLES_FEATURES_H

#include "device/feature_table.h"
#include "generate.h"
#include "kernels/contact/all_features.h"
#include "scene/scene.h"
#include "shape/walls.h"

/* Parts of the contact laws, once for pairs of elements and once for elements at walls. */
#define LAW_FEATURE(member, flag, needed) bool member;
struct law_features {
    bool any;    /* there is such a contact at all */
    bool damped; /* and it has a dashpot along the normal */
    CONTACT_FEATURES(LAW_FEATURE)
};

struct features {
    bool real_is_float, position_is_float;
    bool spin;       /* angular velocities exist */
    bool sizes;      /* radii or masses differ between elements */
    bool materials;  /* more than one element material */
    bool wall_table; /* elements at walls: more than one pair of materials */
    bool energy;     /* losses of contacts are accounted for */
    bool kick;       /* some contact has a dashpot, which predicts velocities */
    bool spin_kick;  /* and angular velocities */
    bool orientation;
    bool periodic[3];
    bool walls, plane, rectangle, cylinder, triangle;
    bool joined; /* contacts of one element with walls decide about each other: wall_keep.cl */
    bool moving, timed; /* walls move; appear or go */
    bool remove_outside;
    struct law_features pair, wall;
    double bond_range; /* [m] how far beyond touching a contact may hold */
};

struct features features_of(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements);

/* Build options of the program of pairs (FEATURES_PAIR), of walls, of what moves elements, or of
 * lists and sums, which know no contact law; owned by the caller. Scenes that differ in what a
 * program does not ask for share it, compiled once. */
enum features_program {
    FEATURES_PAIR = 1,
    FEATURES_WALL = 2,
    FEATURES_BODY = 4,
    FEATURES_LISTS = 8
};
char *features_options(const struct features *features, enum features_program program);

extern const struct feature_row features_table[];

/* Device memory [byte] per element without pairs, and per listed pair; for one rank, so without
 * ghosts, and without walls. Arrays that have grown hold up to a quarter more, and never shrink:
 * what counts is the largest number of pairs so far. features_memory.c. */
double features_element_bytes(const struct features *features);
double features_pair_bytes(const struct features *features);

#endif
