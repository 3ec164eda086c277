/* What limit_*.c share: the bound in double with all features, and elements in classes of like
 * size. Private to limit_*.c. */
#ifndef DEMOCLES_LIMIT_PARTS_H
#define DEMOCLES_LIMIT_PARTS_H

#include "kernels/contact/all_features.h"
#include "kernels/contact/law_limit.h"
#include "limit.h"

struct limit_class {
    int material;
    /* elements of the class; the smallest and the largest of a class have the same n */
    int64_t n;
    double r, w; /* [m], 1/mass [1/kg] */
};

/* Owned by the caller. */
struct limit_class *limit_classes(
    const struct scene *scene, const struct elements_host *elements, int *n_class);
struct contact_material limit_material_of(const struct scene *scene, int a, int b);
/* Contact of c with p (NULL: a wall), as deep as `speed` [m/s] makes it; dt [s] for its
 * dashpots. */
struct limit_contact limit_deepest(const struct scene *scene, const struct limit_class *c,
    const struct limit_class *p, struct contact_material m, double speed, double dt);
/* How deep contacts get at `speed` [m/s], gravity included [m]; how far bonds reach [m]. */
double limit_depth(
    const struct scene *scene, struct contact_material m, struct limit_ends ends, double speed);
double limit_range(struct contact_material m, struct limit_ends ends);
/* Part of limit_warnings. */
void limit_precision_warnings(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, double speed, double dt, struct scene_errors *warnings);

#endif
