/* Contact laws as a user reads them. m* and R* are those of two elements (or an element and a
 * wall), see law_parameters.h. */
#include "check_parts.h"

#include <math.h>
#include <stdio.h>

#include "laws/restitution.h"
#include "particle/contact_table.h"

/* Radii of the elements of one material. */
struct sizes {
    double smallest, largest; /* [m]; smallest infinite: there are no elements of it */
};

static struct sizes sizes_of(const struct elements_host *elements, int material)
{
    struct sizes s = {HUGE_VAL, 0};
    for (int64_t i = 0; i < elements->n; i++) {
        if (elements->material[i] != material) continue;
        s.smallest = fmin(s.smallest, elements->radius[i]);
        s.largest = fmax(s.largest, elements->radius[i]);
    }
    return s;
}

static bool is_wall(const struct scene *scene, int material)
{
    for (int w = 0; w < scene->n_wall; w++)
        if (scene->wall[w].material == material) return true;
    return false;
}

/* 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b [Pa] */
static double young_star(const struct material *a, const struct material *b)
{
    return 1 /
           ((1 - a->poisson * a->poisson) / a->young + (1 - b->poisson * b->poisson) / b->young);
}

/* Contact duration of the smallest particles. Linear: pi/(w sqrt(1 - z^2)), w^2 = k_n/m*, infinite
 * for z >= 1. Hertz: 2.94328 delta_max/v without damping, for v = 1 m/s, with
 * delta_max = (5 m* v^2/(4 K))^(2/5), K = (4/3) E* sqrt(R*). */
static void print_impact(const struct scene *scene, const struct contact *c, const char *who,
    double m_star, double r_star, double e_star)
{
    double row[MATERIAL_WIDTH];
    double z = c->damping_ratio;
    printf("        %s: m* %.4g kg, contact duration ", who, m_star);
    if (c->normal_law == NORMAL_HERTZ) {
        double k = 4.0 / 3.0 * e_star * sqrt(r_star);
        printf("%.4g s at 1 m/s, without damping\n", 2.94328 * pow(1.25 * m_star / k, 0.4));
    } else if (z < 1) {
        printf("%.4g s\n", M_PI / sqrt(c->stiffness / m_star * (1 - z) * (1 + z)));
    } else {
        printf("none: overdamped (no finite contact duration)\n");
    }
    contact_table_material(scene, c->between[0], c->between[1], row);
    double reach = contact_table_reach(row, r_star);
    if (reach > 0)
        printf("            pull-off force %.4g N, acts up to a gap of %.4g m\n",
            contact_table_pull(row, r_star), reach);
}

static void print_normal(const struct contact *c, double e_star)
{
    if (c->normal_law == NORMAL_LINEAR) printf("        linear: k_n %.4g N/m", c->stiffness);
    else printf("        hertz: E* %.4g Pa", e_star);
    double e = restitution_of_damping(c->damping_ratio, c->attraction);
    printf(", damping ratio %.4g (restitution %.4g%s)\n", c->damping_ratio, e,
        c->attraction ? "" : ", no-tension limit");
}

static void print_tangential(const struct contact *c)
{
    if (c->normal_law == NORMAL_LINEAR)
        printf("        tangential: k_t %.4g N/m", c->stiffness_ratio * c->stiffness);
    else if (c->stiffness_ratio >= 0)
        printf("        tangential: k_t/k_n %.4g", c->stiffness_ratio);
    else printf("        tangential: k_t after Mindlin");
    if (c->damping_factor >= 0) printf(", dashpot %.4g gamma_n", c->damping_factor);
    else printf(", damping ratio %.4g", c->tangential_damping);
    if (c->damping_mass == DAMPING_MASS_CENTRE) printf(" (of m*)");
    printf(", friction %.4g\n", c->friction);
    if (c->slip == SLIP_WHOLE) printf("            spring and dashpot slip together\n");
    if (c->slip == SLIP_UNDAMPED) printf("            no dashpot while the spring slips\n");
    if (c->lever == LEVER_RADIUS)
        printf("            lever arms are radii: angular momentum is not conserved\n");
    if (!c->rescale)
        printf("            the spring is not rescaled: cycles of loading can give energy\n");
    if (c->cap == CAP_MAGNITUDE) printf("            friction limit mu |F_n|\n");
}

static void print_rest(const struct contact *c)
{
    if (c->has_tangential) print_tangential(c);
    if (c->rolling == ROLLING_CDT)
        printf(
            "        rolling: constant directional torque, friction %.4g\n", c->rolling_friction);
    if (c->rolling == ROLLING_EPSD)
        printf("        rolling: elastic-plastic, friction %.4g, damping ratio %.4g\n",
            c->rolling_friction, c->rolling_damping);
}

void check_contacts(const struct scene *scene, const struct elements_host *elements)
{
    printf("\ncontacts\n");
    for (int k = 0; k < scene->n_contact; k++) {
        const struct contact *c = &scene->contact[k];
        int a = c->between[0], b = c->between[1];
        const struct material *material = scene->material;
        printf("    %s and %s\n", material[a].name, material[b].name);
        struct sizes of[2] = {sizes_of(elements, a), sizes_of(elements, b)};
        double r[2] = {of[0].smallest, of[1].smallest},
               m[2] = {scene_mass(scene, a, r[0]), scene_mass(scene, b, r[1])};
        bool both = isfinite(r[0]) && isfinite(r[1]),
             wall[2] = {isfinite(r[0]) && is_wall(scene, b), isfinite(r[1]) && is_wall(scene, a)};
        bool has_force = c->normal_law == NORMAL_HERTZ || c->stiffness > 0;
        if (!has_force || (!both && !wall[0] && !wall[1])) {
            printf(has_force ? "        never meet\n" : "        no force\n");
            continue;
        }
        double e_star = c->normal_law == NORMAL_HERTZ ? young_star(&material[a], &material[b]) : 0;
        print_normal(c, e_star);
        print_rest(c);
        if (both)
            print_impact(scene, c, "smallest particles", m[0] * m[1] / (m[0] + m[1]),
                r[0] * r[1] / (r[0] + r[1]), e_star);
        for (int side = 0; side < (a == b ? 1 : 2); side++)
            if (wall[side])
                print_impact(scene, c, "smallest particle at a wall", m[side], r[side], e_star);
    }
}
