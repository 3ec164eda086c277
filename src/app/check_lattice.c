/* `democles check` of a scene of method lattice. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "check_parts.h"
#include "comm/fail.h"
#include "lattice/lattice_input.h"
#include "lattice/lattice_frequency.h"
#include "lattice/lattice_loads.h"
#include "laws/lattice_schemes.h"
#include "scene/scene_report.h"

static int64_t count_links(const struct lattice_cells *cells, int body)
{
    int64_t n = 0;
    for (int64_t i = 0; i < cells->n; i++)
        for (int a = 0; a < 3 && (body < 0 || cells->body[i] == body); a++)
            n += cells->bits[i] >> (2 * a + 1) & 1;
    return n;
}

static void print_material(const struct material *m)
{
    printf("    %s: density %g kg/m3, E %g Pa, nu %g", m->name, m->density, m->young, m->poisson);
    if (m->mass_damping > 0) printf(", mass-proportional damping %.4g 1/s", m->mass_damping);
    if (m->link_damping > 0) printf(", stiffness-proportional damping %.4g s", m->link_damping);
    if (m->has_strength && m->energy > 0) printf(", fracture energy %.4g J/m2", m->energy);
    else if (m->has_strength && isfinite(m->tension))
        printf(", tensile strength %.4g Pa", m->tension);
    if (m->has_strength && isfinite(m->shear)) printf(", shear strength %.4g Pa", m->shear);
    if (m->has_strength && m->criterion == CRITERION_PRINCIPAL)
        printf(", by the largest principal stress of a cell");
    printf("\n");
}

/* In whole cells. */
static double mass_of_body(const struct lattice_cells *cells, int body)
{
    double all = 0;
    for (int64_t i = 0; i < cells->n; i++)
        all += cells->body[i] == body ? lattice_cells_share(cells, i)->mass : 0;
    return all;
}

static void print_shares(const struct lattice_cells *cells)
{
    double least = 1;
    int64_t n = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        double volume = lattice_cells_share(cells, i)->volume;
        n += volume < 1;
        least = fmin(least, volume);
    }
    if (cells->share)
        printf("    %lld cells that curved surfaces cut, the smallest with %.3g of its volume\n",
            (long long)n, least);
}

/* Of round bodies and of meshes: how much of the shape the cells hold, and how fine they are. */
static void print_fit(const struct scene *scene, const struct lattice_cells *cells, int b)
{
    struct lattice_fit fit = cells->fit[b];
    double h = scene->body[b].cell, least = fmin(fit.shape[0], fmin(fit.shape[1], fit.shape[2]));
    if (fit.is_box && isinf(fit.radius)) return;
    printf("        %.4g of the volume of its shape; %.3g cells along its smallest extent",
        fit.volume, least / h);
    if (!isinf(fit.radius)) printf(", %.3g along its smallest radius", fit.radius / h);
    printf("\n");
}

static void print_cells(const struct scene *scene, const struct lattice_cells *cells)
{
    printf("\ncells: %lld, links: %lld\n", (long long)cells->n, (long long)count_links(cells, -1));
    for (int b = 0; b < scene->n_body; b++) {
        const struct body *body = &scene->body[b];
        const struct material *m = &scene->material[body->material];
        double mass =
            link_constants_mass(lattice_frequency_material(m), body->cell) * mass_of_body(cells, b);
        printf("    %s: %lld cells of %g m, %s, %.4g kg, %lld links within and upwards from it\n",
            body->name, (long long)cells->n_of_body[b], body->cell, m->name, mass,
            (long long)count_links(cells, b));
        print_fit(scene, cells, b);
    }
    print_shares(cells);
    if (cells->n_grid > 1)
        printf("    %d grids: bodies on different grids are not joined\n", cells->n_grid);
    printf("\nmaterials\n");
    for (int k = 0; k < scene->n_material; k++) print_material(&scene->material[k]);
}

static void print_boundaries(const struct scene *scene, const struct lattice_cells *cells)
{
    int64_t n_held = 0, n_loaded = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        n_held += (cells->bits[i] & CELL_FIXED) != 0;
        n_loaded += cells->row[i] > 0;
    }
    printf("\nboundaries: %d; cells that are constrained or prescribed: %lld; cells that are "
           "loaded or prescribed: %lld, with distinct sets of loads: %d\n",
        scene->n_boundary, (long long)n_held, (long long)n_loaded, cells->loads->n_row - 1);
}

static bool may_break(const struct scene *scene)
{
    for (int k = 0; k < scene->n_material; k++)
        if (scene->material[k].has_strength) return true;
    return false;
}

static void print_time(const struct scene *scene, const struct lattice_cells *cells)
{
    const struct scene_time *time = &scene->time;
    double largest = lattice_frequency_largest(scene, cells),
           zeta = lattice_frequency_damping(scene, cells, largest);
    double factor = lattice_limit_factor((enum lattice_scheme)time->scheme, zeta);
    double free = lattice_limit_factor((enum lattice_scheme)time->scheme, 0),
           limit = factor / largest;
    double dt = time->step > 0 ? time->step : time->safety * limit;
    printf("\ntime: %g s in %.0f steps of %.6g s, ", time->end, ceil(time->end / dt * (1 - 1e-12)),
        dt);
    if (time->step > 0) printf("as given");
    else printf("%g of the critical time step", time->safety);
    printf(", by %s", lattice_schemes_table((enum lattice_scheme)time->scheme)->name);
    if (scene->lattice.relax)
        printf(", or until the residual force is below %g (static equilibrium)",
            scene->lattice.tolerance);
    printf("\n    critical time step %.4g s, from the highest natural frequency, %.4g Hz\n", limit,
        largest / (2 * M_PI));
    if (may_break(scene)) printf("    breakage of links does not raise that frequency\n");
    if (zeta > 0)
        printf("    stiffness-proportional damping is %.4g of critical there%s", zeta,
            factor < free ? "" : " and does not reduce the critical time step\n");
    if (zeta > 0 && factor < free)
        printf(
            ", and makes the critical time step %.3g times smaller than without\n", free / factor);
    if (dt > limit)
        printf("    the time step exceeds it: a run %s\n",
            time->allow_unstable ? "continues, as time.allow_unstable asks" : "is refused");
}

/* Bodies with one layer of cells along an axis have no Poisson effect in bending. */
static void print_thin(const struct scene *scene, const struct lattice_cells *cells)
{
    for (int b = 0; b < scene->n_body; b++)
        for (int a = 0; a < 3; a++) {
            int32_t low = INT32_MAX, high = INT32_MIN;
            for (int64_t i = 0; i < cells->n; i++) {
                if (cells->body[i] != b) continue;
                low = cells->at[i][a] < low ? cells->at[i][a] : low;
                high = cells->at[i][a] > high ? cells->at[i][a] : high;
            }
            if (low == high && (scene->material[scene->body[b].material].poisson < 0 ||
                                   scene->material[scene->body[b].material].poisson > 0))
                printf("    warning: '%s' is one cell thick in %c: Poisson's ratio has no effect "
                       "in "
                       "bending\n",
                    scene->body[b].name, "xyz"[a]);
        }
}

int check_lattice(const struct comm *comm, const struct scene *scene, bool resolved)
{
    struct scene_errors errors = {0};
    struct lattice_cells *cells = comm->rank == 0 ? lattice_cells_create(scene, &errors) : NULL;
    scene_report_errors(comm, &errors);
    if (comm->rank == 0 && resolved) fputs(scene->resolved, stdout);
    else if (comm->rank == 0) {
        struct lattice_input *input = lattice_input_create(scene, cells, 0);
        struct lattice_features features = lattice_features_of(cells, &input->options);
        lattice_input_free(input);
        check_head(scene);
        print_cells(scene, cells);
        print_thin(scene, cells);
        struct scene_errors warnings = {0};
        lattice_fit_warnings(scene, cells, &warnings);
        check_warnings(&warnings);
        print_boundaries(scene, cells);
        print_time(scene, cells);
        check_output(scene);
        check_features(lattice_features_table, &features);
    }
    lattice_cells_free(cells);
    return EXIT_DONE;
}
