#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "check_parts.h"
#include "comm/fail.h"
#include "particle/limit.h"
#include "scene/scene_report.h"
#include "shape/walls.h"

/* Neighbour pairs per particle of a dense packing with the usual skin: half of 8 to 10
 * neighbours. */
static const double dense_pairs = 4.5;

static void print_overlaps(const struct elements_host *elements)
{
    struct generate_overlaps all = elements->overlaps;
    if (all.n == 0) return;
    printf("    %spairs that overlap at the start: %lld, elements %lld and %lld by %.4g m, %.3g of "
           "the smaller radius\n",
        all.share > GENERATE_DEEP ? "warning: " : "", (long long)all.n, (long long)all.element[0],
        (long long)all.element[1], all.depth, all.share);
}

static void print_elements(const struct scene *scene, const struct elements_host *elements)
{
    printf("\nparticles: %lld\n", (long long)elements->n);
    for (int g = 0; g < scene->n_group; g++) {
        const struct element_group *group = &scene->group[g];
        double smallest = HUGE_VAL, largest = 0, mass = 0;
        int64_t n = 0;
        for (int64_t i = 0; i < elements->n; i++) {
            double r = elements->radius[i];
            if (elements->group[i] != g) continue;
            n++;
            smallest = fmin(smallest, r);
            largest = fmax(largest, r);
            mass += scene_mass(scene, group->material, r);
        }
        printf("    %s: %lld of %s, ", group->name, (long long)n,
            scene->material[group->material].name);
        if (smallest < largest) printf("diameter %.4g to %.4g m, ", 2 * smallest, 2 * largest);
        else if (n > 0) printf("diameter %.4g m, ", 2 * smallest);
        printf("%.4g kg in all\n", mass);
    }
    print_overlaps(elements);
}

static void print_walls(const struct scene *scene, const struct walls *walls)
{
    static const char *const kind[] = {[SURFACE_PLANE] = "plane",
        [SURFACE_RECTANGLE] = "rectangle",
        [SURFACE_BOX] = "box",
        [SURFACE_CYLINDER] = "cylinder"};
    printf("\nwalls: %d, of %d facet%s\n", walls->n_wall, walls->n_primitive,
        walls->n_primitive == 1 ? "" : "s");
    for (int w = 0; w < walls->n_wall; w++) {
        const struct wall *wall = &scene->wall[w];
        printf("    %s: %s, ", wall->name, scene->material[wall->material].name);
        int n = walls->first[w + 1] - walls->first[w];
        if (wall->kind == SURFACE_STL) printf("%d triangle%s", n, n == 1 ? "" : "s");
        else printf("%s", kind[wall->kind]);
        printf("%s", walls->moves[w] ? ", moves" : "");
        if (wall->appear_at > 0) printf(", from %g s", wall->appear_at);
        if (isfinite(wall->remove_at)) printf(", until %g s", wall->remove_at);
        printf("\n");
    }
    if (walls->n_dropped > 0)
        printf("    triangles of zero area, left out: %d\n", walls->n_dropped);
}

/* The same limit, step and number of steps as sim_create has them. */
static void print_time(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements)
{
    const struct scene_time *time = &scene->time;
    double speed = limit_speed(scene, walls, elements), limit = limit_dense(scene, elements, speed);
    double dt = time->step > 0 ? time->step : time->safety * limit;
    if (!(dt > 0 && isfinite(dt))) {
        printf("\ntime: %g s; `step: auto`: %s, so give a value\n", time->end,
            limit_missing(scene, elements));
        return;
    }
    if (!(time->end / dt <= SCENE_STEPS_MOST)) {
        printf(
            "\ntime: %g s; `step: auto` is %.3g s, too many steps: give a value\n", time->end, dt);
        return;
    }
    printf("\ntime: %g s in %.0f steps of %.6g s, ", time->end, ceil(time->end / dt * (1 - 1e-12)),
        dt);
    if (time->step > 0) printf("as given\n");
    else printf("%g of the critical time step\n", time->safety);
    printf("    critical time step %.4g s, for the densest packing of these particles and relative "
           "speeds of up to %.3g m/s\n",
        limit, speed);
    if (time->step > limit)
        printf("    the time step exceeds it: a run %s\n",
            time->allow_unstable ? "continues, as time.allow_unstable asks"
                                 : "stops when its contacts are as stiff as that");
    struct scene_errors warnings = {0};
    limit_warnings(scene, walls, elements, speed, dt, &warnings);
    check_warnings(&warnings);
}

/* What each feature that the scene leaves out would cost by itself. */
static void print_left_out(const struct features *features)
{
    double element = features_element_bytes(features), pair = features_pair_bytes(features);
    int n = 0, column = printf("    left out, with the bytes per particle and per pair of each:");
    for (const struct feature_row *row = features_table; feature_table_more(row); row++) {
        struct features more = *features;
        if (!row->name || feature_table_value(row, features)) continue;
        *((bool *)(void *)&more + row->at) = true;
        double add[] = {features_element_bytes(&more) - element, features_pair_bytes(&more) - pair};
        if (!(add[0] > 0) && !(add[1] > 0)) continue;
        if (n++ > 0) column += printf(";");
        if (column > 80) column = printf("\n       ");
        column += printf(" %s %g + %g", row->name, add[0], add[1]);
    }
    printf("\n");
}

static void print_all(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements)
{
    struct features features = features_of(scene, walls, elements);
    check_head(scene);
    print_elements(scene, elements);
    print_walls(scene, walls);
    check_contacts(scene, elements);
    print_time(scene, walls, elements);
    check_output(scene);
    check_features(features_table, &features);
    double per_element = features_element_bytes(&features),
           per_pair = features_pair_bytes(&features);
    printf("\nmemory on the devices: %.0f bytes per particle and %.0f per neighbour pair; %.1f MiB "
           "with "
           "%.2g pairs per particle, as in a dense packing\n",
        per_element, per_pair,
        (per_element + dense_pairs * per_pair) * (double)elements->n / 1048576, dense_pairs);
    print_left_out(&features);
}

int check_scene(const struct comm *comm, const struct scene *scene, bool resolved)
{
    if (scene->method == METHOD_LATTICE) return check_lattice(comm, scene, resolved);
    struct scene_errors errors = {0};
    struct walls *walls = NULL;
    struct elements_host *elements = NULL;
    if (comm->rank == 0) {
        walls = walls_create(scene, &errors);
        elements = generate_elements(scene, &errors);
        if (walls && elements) generate_check_walls(scene, walls, elements, &errors);
    }
    scene_report_errors(comm, &errors);
    if (comm->rank == 0 && resolved) fputs(scene->resolved, stdout);
    else if (comm->rank == 0) print_all(scene, walls, elements);
    walls_free(walls);
    generate_free(elements);
    return EXIT_DONE;
}
