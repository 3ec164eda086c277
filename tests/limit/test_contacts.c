/* The bound on the device, over the lists of a whole set-up, against the same law over all contacts
 * on the host. On any number of ranks. Spheres of two materials and many sizes, overlapping, bonded
 * or approaching, across a periodic boundary, at a plane, on the common edge of two triangles (one
 * contact, not two), at a rectangle in motion. */
#include "limit_test.h"

#include <string.h>
#include <unistd.h>

#include "particle/contact_table.h"
#include "comm/fail.h"
#include "kernels/contact/law_limit.h"
#include "particle/particle.h"

enum { N = 200 };

static const char scene_text[] =
    "method: particles\n"
    "precision: %s\n"
    "time: {end: 1e-6 s, step: 1e-8 s}\n"
    "materials:\n"
    "  a: {density: 2000, young: 1e6, poisson: 0.2}\n"
    "  b: {density: 5000, young: 2e6, poisson: 0.3}\n"
    "  floor: {density: 5000, young: 1e7, poisson: 0.3}\n"
    "contacts:\n"
    "  - between: [a, a]\n"
    "    normal: {law: linear, stiffness: 100, damping_ratio: 0.3}\n"
    "    tangential: {stiffness_ratio: 0.5, friction: 0.3, damping_ratio: 0.2}\n"
    "    binding: {force: 0.2}\n"
    "  - between: [a, b]\n"
    "    normal: {law: hertz, damping_ratio: 0.1}\n"
    "    tangential: {friction: 0.3}\n"
    "    rolling: {model: epsd, friction: 0.2, damping_ratio: 0.3}\n"
    "  - between: [b, b]\n"
    "    normal: {law: hertz, damping_ratio: 0.5}\n"
    "  - between: [a, floor]\n"
    "    normal: {law: linear, stiffness: 300, damping_ratio: 0.3}\n"
    "    tangential: {stiffness_ratio: 0.8, friction: 0}\n"
    "  - between: [b, floor]\n"
    "    normal: {law: hertz, damping_ratio: 0.1}\n"
    "    tangential: {friction: 0.3}\n"
    "elements:\n"
    "  - {name: a, material: a, file: a.csv}\n"
    "  - {name: b, material: b, file: b.csv}\n"
    "walls:\n"
    "  - {name: left, material: floor, surface: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}}\n"
    "  - {name: mesh, material: floor, surface: {stl: floor.stl}}\n"
    "  - name: lid\n"
    "    material: floor\n"
    "    surface: {rectangle: {center: [0.5, 0.5, 1], normal: [0, 0, 1], size: [4, 4]}}\n"
    "    motion: {velocity: [0, 0, -2]}\n"
    "domain: {periodic: [y], start_overlap: 9, box: {min: [0, 0, 0], max: [1, 1, 1]}}\n";

static struct comm *comm;
static char folder[] = "/tmp/democles_limit_XXXXXX";

static FILE *file_open(const char *name)
{
    char *path = fail_format("%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) fail_stop(EXIT_IO, "cannot write %s", path);
    free(path);
    return file;
}

/* Rank 0 writes the folder. */
static void write_files(const char *precision)
{
    FILE *scene = file_open("scene.yaml"), *csv[2] = {file_open("a.csv"), file_open("b.csv")},
         *stl = file_open("floor.stl");
    fprintf(scene, scene_text, precision);
    for (int k = 0; k < 2; k++) fprintf(csv[k], "x,y,z,radius,vx,vy,vz\n");
    limit_seed = 7;
    for (int i = 0; i < N; i++) {
        double r = 0.03 + 0.1 * uniform(0, 1) * uniform(0, 1),
               v[3] = {uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
        double x[3] = {uniform(0.6 * r, 1), uniform(0, 1), uniform(0.6 * r, 1 - 0.6 * r)};
        if (i % 8 == 0) { /* over the diagonal that the triangles share */
            x[2] = 0.9 * r;
            x[0] = fmax(x[1], 0.6 * r);
        }
        fprintf(csv[i % 2], "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", x[0], x[1], x[2], r,
            v[0], v[1], v[2]);
    }
    fprintf(stl, "solid floor\n");
    static const double corner[2][9] = {
        {-3, -3, 0, 3, -3, 0, 3, 3, 0}, {-3, -3, 0, 3, 3, 0, -3, 3, 0}};
    for (int t = 0; t < 2; t++) {
        fprintf(stl, "facet normal 0 0 1\nouter loop\n");
        for (int k = 0; k < 3; k++)
            fprintf(stl, "vertex %g %g %g\n", corner[t][3 * k], corner[t][3 * k + 1],
                corner[t][3 * k + 2]);
        fprintf(stl, "endloop\nendfacet\n");
    }
    fprintf(stl, "endsolid floor\n");
    fclose(stl);
    for (int k = 0; k < 2; k++) fclose(csv[k]);
    fclose(scene);
}

static struct contact_material material_of(const struct scene *scene, int a, int b)
{
    double row[MATERIAL_WIDTH];
    limit_material(scene, a, b, row);
    return material_load(row);
}

/* One contact, if it acts; D: from the centre to the partner, distance along it less than which
 * there is touch; v: relative velocity. */
static struct limit_sums add(struct limit_sums s, struct contact_material m, struct limit_ends ends,
    vec3 D, double touch, vec3 v, double dt, double share, int *count)
{
    double distance = sqrt(v3_dot(D, D)), delta = touch - distance;
    vec3 n = v3_scale(1 / distance, D);
    if (!normal_acts(m, limit_r_star(ends), delta)) return s;
    (*count)++;
    return limit_sums_add(s, limit_contact_of(m, ends, delta, v3_dot(v, n), dt), ends, n, share);
}

static vec3 row3(const double *a)
{
    return v3(a[0], a[1], a[2]);
}

static double element_bound(const struct sim *s, int e, double dt, double share, int *count)
{
    const struct elements_host *h = s->particle->first;
    struct limit_sums sums = limit_sums_zero();
    double *w = fail_alloc((size_t)h->n * sizeof *w);
    for (int64_t i = 0; i < h->n; i++)
        w[i] =
            1 / (s->scene->material[h->material[i]].density * 4 / 3 * M_PI * pow(h->radius[i], 3));
    vec3 x = row3(h->x + 3 * e), v = row3(h->v + 3 * e);
    for (int j = 0; j < h->n; j++) {
        vec3 D = v3_sub(row3(h->x + 3 * j), x);
        D.y -= rint(D.y);
        struct limit_ends ends = {w[e], w[j], h->radius[e], h->radius[j]};
        if (j != e)
            sums = add(sums, material_of(s->scene, h->material[e], h->material[j]), ends, D,
                ends.r_i + ends.r_j, v3_sub(v, row3(h->v + 3 * j)), dt, share, count);
    }
    struct limit_ends wall = {w[e], 0, h->radius[e], 0};
    struct contact_material m = material_of(s->scene, h->material[e], 2);
    sums = add(sums, m, wall, v3(-x.x, 0, 0), wall.r_i, v, dt, share, count);
    sums = add(sums, m, wall, v3(0, 0, -x.z), wall.r_i, v, dt, share, count);
    sums =
        add(sums, m, wall, v3(0, 0, 1 - x.z), wall.r_i, v3_sub(v, v3(0, 0, -2)), dt, share, count);
    free(w);
    return limit_of_sums(sums, LIMIT_NONE);
}

static void compare(const struct sim *s, struct limit_result found, double dt, double share,
    double tolerance, int contacts)
{
    double least = HUGE_VAL;
    int who = -1, count = 0;
    for (int e = 0; e < s->particle->first->n; e++) {
        double bound = element_bound(s, e, dt, share, &count);
        if (bound < least) {
            least = bound;
            who = e;
        }
    }
    assert_true(count >= contacts);
    assert_near(found.dt / least, 1, tolerance);
    assert_int_equal(found.gid, who);
}

/* Each pair of materials alone, so that every kind of contact sets the limit once. */
static void compare_each(struct sim *s, double tolerance)
{
    struct scene *whole = s->scene, part = *whole;
    part.n_contact = 1;
    s->scene = &part;
    for (int k = 0; k < whole->n_contact; k++) {
        part.contact = whole->contact + k;
        limit_free(s->particle->limit);
        s->particle->limit = limit_create(s);
        compare(s, limit_run(s, 1e-4, 0.8), 1e-4, 0.8, tolerance, 20);
    }
    s->scene = whole;
}

static void check(const char *precision, double tolerance)
{
    if (comm->rank == 0) write_files(precision);
    comm_barrier(comm);
    char *path = fail_format("%s/scene.yaml", folder),
         *dir = fail_format("%s/out_%s", folder, precision);
    struct scene_errors errors = {NULL, 0};
    struct scene *scene = scene_read(path, NULL, 0, &errors);
    for (int k = 0; k < errors.n; k++) fprintf(stderr, "%s\n", errors.text[k]);
    assert_non_null(scene);
    struct log *log = log_create(comm, true);
    struct sim_options options = {.dir = dir, .quiet = true, .n_step = -1, .max_time = HUGE_VAL};
    struct sim *s = sim_create(scene, comm, log, &particle_ops, NULL, &options);
    static const double dt[] = {0, 1e-4, 1e-2}, share[] = {1, 0.6, 0.9};
    for (int k = 0; k < 3; k++)
        compare(s, limit_run(s, dt[k], share[k]), dt[k], share[k], tolerance, 300);
    struct limit_result now = particle_limit(s); /* the step is tiny: one run */
    compare(s, now, 1e-8, limit_best_share(scene), tolerance, 300);
    s->dt = 1; /* too much: the best that can be proved */
    struct limit_result best = particle_limit(s);
    assert_true(best.dt >= now.dt && best.dt < 2 * now.dt);
    assert_true(limit_run(s, best.dt, limit_best_share(scene)).dt >= best.dt * (1 - 1e-3) ||
                limit_run(s, best.dt, 1).dt >= best.dt * (1 - 1e-3));
    compare_each(s, tolerance);
    sim_free(s);
    log_free(log);
    scene_free(scene);
    free(path);
    free(dir);
}

static void double_precision(void **state)
{
    (void)state;
    check("double", 1e-9);
}

static void single_precision(void **state)
{
    (void)state;
    check("single", 5e-3);
}

/* Argument: double, for this precision alone. */
int main(int argc, char **argv)
{
    comm = comm_create(&argc, &argv);
    if (comm->rank == 0 && !mkdtemp(folder)) fail_stop(EXIT_IO, "no temporary folder");
    comm_bcast(comm, folder, sizeof folder, 0);
    const struct CMUnitTest first[] = {cmocka_unit_test(double_precision)},
                            second[] = {cmocka_unit_test(single_precision)};
    int failed = cmocka_run_group_tests(first, NULL, NULL);
    bool all = argc < 2 || strcmp(argv[1], "double") != 0;
    if (all) failed += cmocka_run_group_tests(second, NULL, NULL);
    comm_barrier(comm);
    char *clean = fail_format("rm -rf %s", folder);
    if (comm->rank == 0 && system(clean) != 0) failed++;
    free(clean);
    comm_free(comm);
    return failed;
}
