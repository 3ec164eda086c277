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

/* What a row of contact_table_material says of two elements, or one at a wall, of effective radius
 * r_star [m]: how far apart they still hold each other [m], and the force that it takes to part
 * them slowly [N]; 0 where nothing holds them. */
double contact_table_reach(const double *row, double r_star);
double contact_table_pull(const double *row, double r_star);

/* Sets the arguments k_n, gamma_n, ... law of a force kernel from a row of parameters. */
void contact_table_set(struct launch *launch, const double *row);

#endif
