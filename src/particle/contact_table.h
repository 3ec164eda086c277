/* Parameters of contacts by pair of materials, computed once on the host in double and handed to
 * the kernels as numbers.
 *
 * Rows as kernels/contact/law_parameters.h has them. With one size the rows are complete
 * (contact_parameters); with several they hold what the materials say (contact_material) and the
 * kernel adds the sizes. */
#ifndef DEMOCLES_CONTACT_TABLE_H
#define DEMOCLES_CONTACT_TABLE_H

#include "device/launch.h"
#include "kernels/contact/all_features.h"
#include "kernels/contact/law_parameters.h"
#include "scene/scene.h"

/* row [MATERIAL_WIDTH]; zeros where the scene has no such contact. */
void contact_table_material(const struct scene *scene, int a, int b, double *row);

/* row [PARAMETER_WIDTH] for two spheres of radius [m] and mass [kg], or one at a wall. */
void contact_table_parameters(const struct scene *scene, int a, int b, bool wall, double radius,
    double mass, double dt, double *row);

/* Sets the arguments k_n, gamma_n, ... law of a force kernel from a row of parameters. */
void contact_table_set(struct launch *launch, const double *row);

#endif
