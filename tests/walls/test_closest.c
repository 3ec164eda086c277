/* The closest point of each kind of wall: it lies on the wall, and of many sampled points of the
 * wall none is nearer. */
#include "scratch.h"

#include "kernels/contact/law_wall.h"

enum { N_WALL = 40, N_POINT = 20, N_SAMPLE = 60 };

static pvec3 random_point(uint64_t *state, double size)
{
    double x = scratch_random(state, -size, size), y = scratch_random(state, -size, size),
           z = scratch_random(state, -size, size);
    return p3(x, y, z);
}

static double length_of(pvec3 a)
{
    return sqrt(p3_dot(a, a));
}

static pvec3 unit(pvec3 a)
{
    return p3_scale(1 / length_of(a), a);
}

/* A point of the wall's surface for s, t in [0, 1]. */
static pvec3 surface_point(struct wall_primitive w, double s, double t)
{
    if (w.kind == WALL_TRIANGLE) {
        double u = s + t > 1 ? 1 - s : s, v = s + t > 1 ? 1 - t : t;
        return p3_fma(u, p3_sub(w.b, w.a), p3_fma(v, p3_sub(w.c, w.a), w.a));
    }
    if (w.kind == WALL_RECTANGLE)
        return p3_fma((2 * s - 1) * w.r, w.b, p3_fma((2 * t - 1) * w.s, w.c, w.a));
    double angle = 2 * 3.14159265358979 * s;
    pvec3 across = p3_cross(w.b, w.c), e = p3_fma(cos(angle), w.c, p3_scale(sin(angle), across));
    if (w.kind == WALL_ROD && t < 0.4) /* the two ends, then the side */
        return p3_fma(fmod(t, 0.2) / 0.2 * w.r, e, p3_fma(t < 0.2 ? 0 : w.s, w.b, w.a));
    return p3_fma(w.r, e, p3_fma((w.kind == WALL_ROD ? (t - 0.4) / 0.6 : t) * w.s, w.b, w.a));
}

static bool is_on_surface(struct wall_primitive w, pvec3 p)
{
    pvec3 q = p3_sub(p, w.a);
    const double eps = 1e-12;
    if (w.kind == WALL_TRIANGLE) { /* the three parts fill the whole area */
        pvec3 ab = p3_sub(w.b, w.a), ac = p3_sub(w.c, w.a), bp = p3_sub(p, w.b);
        double parts = length_of(p3_cross(ab, q)) + length_of(p3_cross(q, ac)) +
                       length_of(p3_cross(p3_sub(w.c, w.b), bp));
        return fabs(parts - length_of(p3_cross(ab, ac))) < eps;
    }
    if (w.kind == WALL_RECTANGLE) {
        return fabs(p3_dot(q, w.b)) < w.r + eps && fabs(p3_dot(q, w.c)) < w.s + eps &&
               fabs(p3_dot(q, p3_cross(w.b, w.c))) < eps;
    }
    double z = p3_dot(q, w.b), rho = length_of(p3_fma(-z, w.b, q));
    bool on_side = fabs(rho - w.r) < eps && z > -eps && z < w.s + eps;
    return on_side ||
           (w.kind == WALL_ROD && rho < w.r + eps && (fabs(z) < eps || fabs(z - w.s) < eps));
}

static struct wall_primitive random_wall(uint64_t *state, int kind)
{
    pvec3 a = random_point(state, 1), b = random_point(state, 1), c = random_point(state, 1);
    double r = scratch_random(state, 0.1, 1), s = scratch_random(state, 0.1, 2);
    if (kind == WALL_TRIANGLE) return wall_primitive(a, b, c, 0, 0, kind);
    b = unit(b);
    c = unit(p3_cross(b, c));
    return wall_primitive(a, b, c, r, s, kind);
}

/* The wall's largest gap between neighbouring samples is below 0.2, so some sample is within that
 * of the closest point. */
static void check_kind(int kind)
{
    uint64_t state = 77 + (uint64_t)kind;
    for (int k = 0; k < N_WALL * N_POINT; k++) {
        struct wall_primitive w = random_wall(&state, kind);
        pvec3 x = random_point(&state, 1.5);
        struct wall_closest closest = wall_closest(w, x);
        double nearest = HUGE_VAL, distance = fabs(closest.distance);
        assert_true(is_on_surface(w, p3_add(x, closest.D)));
        assert_true(length_of(p3_sub(p3_scale(closest.distance, closest.n), closest.D)) < 1e-14);
        assert_true(fabs(length_of(closest.n) - 1) < 1e-14);
        for (int s = 0; s <= N_SAMPLE; s++)
            for (int t = 0; t <= N_SAMPLE; t++)
                nearest = fmin(nearest,
                    length_of(
                        p3_sub(surface_point(w, (double)s / N_SAMPLE, (double)t / N_SAMPLE), x)));
        assert_true(distance <= nearest + 1e-14);
        assert_true(distance > nearest - 0.2);
    }
}

static void test_triangle(void **unused)
{
    (void)unused;
    check_kind(WALL_TRIANGLE);
}

static void test_rectangle(void **unused)
{
    (void)unused;
    check_kind(WALL_RECTANGLE);
}

static void test_pipe(void **unused)
{
    (void)unused;
    check_kind(WALL_PIPE);
}

static void test_rod(void **unused)
{
    (void)unused;
    check_kind(WALL_ROD);
}

/* Features of a triangle by hand: points straight over face, edges, corners. */
static void test_features(void **unused)
{
    (void)unused;
    struct wall_primitive t =
        wall_primitive(p3(0, 0, 0), p3(2, 0, 0), p3(0, 2, 0), 0, 0, WALL_TRIANGLE);
    const double point[7][3] = {
        {0.5, 0.5, 1}, {1, -1, 0.5}, {2, 2, 0}, {-1, 1, 0.5}, {-1, -1, 0}, {4, -1, 1}, {-1, 4, 1}};
    for (int f = 0; f < 7; f++)
        assert_int_equal(wall_closest(t, p3(point[f][0], point[f][1], point[f][2])).feature, f);
    assert_true(wall_closest(t, p3(0.5, 0.5, 1)).distance == 1);
    assert_true(wall_closest(t, p3(2, 2, 0)).distance == sqrt(2));
}

/* A plane pushes back from any depth: n stays the same, the distance turns negative. */
static void test_plane(void **unused)
{
    (void)unused;
    struct wall_primitive w =
        wall_primitive(p3(1, 2, 3), p3(0, 0, 1), p3(0, 0, 0), 0, 0, WALL_PLANE);
    for (int k = -3; k <= 3; k++) {
        struct wall_closest closest = wall_closest(w, p3(9, 9, 3 + k));
        assert_true(
            closest.distance == k && closest.D.z == -k && closest.n.z == -1 && closest.n.x == 0);
    }
}

/* In a rod the distance is negative and n points inwards, so that the push is outwards; a pipe
 * pushes away from its shell on both sides. */
static void test_sides(void **unused)
{
    (void)unused;
    struct wall_primitive w =
        wall_primitive(p3(0, 0, 0), p3(0, 0, 1), p3(1, 0, 0), 1, 10, WALL_ROD);
    assert_true(wall_closest(w, p3(0.75, 0, 5)).distance == -0.25 &&
                wall_closest(w, p3(0.75, 0, 5)).n.x == -1);
    assert_true(wall_closest(w, p3(1.25, 0, 5)).distance == 0.25 &&
                wall_closest(w, p3(1.25, 0, 5)).n.x == -1);
    /* on the axis: still a direction */
    assert_true(
        wall_closest(w, p3(0, 0, 5)).distance == -1 && wall_closest(w, p3(0, 0, 5)).n.x == -1);
    assert_true(wall_closest(w, p3(0.25, 0, 9.75)).distance == -0.25 &&
                wall_closest(w, p3(0.25, 0, 9.75)).n.z == -1);
    assert_true(wall_closest(w, p3(0.25, 0, -0.5)).distance == 0.5 &&
                wall_closest(w, p3(0.25, 0, -0.5)).n.z == 1);
    w.kind = WALL_PIPE;
    assert_true(wall_closest(w, p3(0.75, 0, 5)).distance == 0.25 &&
                wall_closest(w, p3(0.75, 0, 5)).n.x == 1);
    assert_true(wall_closest(w, p3(1.25, 0, 5)).distance == 0.25 &&
                wall_closest(w, p3(1.25, 0, 5)).n.x == -1);
    /* open end: the rim is nearest */
    assert_true(fabs(wall_closest(w, p3(0.25, 0, -1)).distance - 1.25) < 1e-15);
}

/* A centre on the surface has distance 0 and still a unit normal. */
static void test_on_the_surface(void **unused)
{
    (void)unused;
    struct wall_primitive w[3] = {
        wall_primitive(p3(0, 0, 0), p3(2, 0, 0), p3(0, 2, 0), 0, 0, WALL_TRIANGLE),
        wall_primitive(p3(0, 0, 0), p3(1, 0, 0), p3(0, 1, 0), 1, 1, WALL_RECTANGLE),
        wall_primitive(p3(0, 0, 0), p3(0, 0, 1), p3(1, 0, 0), 0.5, 1, WALL_PIPE)};
    for (int k = 0; k < 3; k++) {
        struct wall_closest closest =
            wall_closest(w[k], k == 2 ? p3(0.5, 0, 0.5) : p3(0.5, 0.5, 0));
        assert_true(closest.distance == 0);
        assert_true(length_of(closest.n) == 1);
    }
}

/* There and back through a frame, and the closest point seen from outside. */
static void test_frame(void **unused)
{
    (void)unused;
    uint64_t state = 5;
    for (int k = 0; k < 100; k++) {
        double r[9];
        scratch_rotation(&state, r);
        struct wall_frame frame = {p3(r[0], r[1], r[2]), p3(r[3], r[4], r[5]), p3(r[6], r[7], r[8]),
            random_point(&state, 2)};
        struct wall_primitive w = random_wall(&state, WALL_TRIANGLE);
        pvec3 q = random_point(&state, 2), p = wall_to_world(frame, q);
        struct wall_closest inner = wall_closest(w, q), outer = wall_closest_moved(w, frame, p);
        assert_true(length_of(p3_sub(wall_to_reference(frame, p), q)) < 1e-14);
        assert_true(
            fabs(inner.distance - outer.distance) < 1e-14 && inner.feature == outer.feature);
        assert_true(length_of(p3_sub(wall_turn(frame, inner.D), outer.D)) < 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_triangle),
        cmocka_unit_test(test_rectangle), cmocka_unit_test(test_pipe), cmocka_unit_test(test_rod),
        cmocka_unit_test(test_features), cmocka_unit_test(test_plane), cmocka_unit_test(test_sides),
        cmocka_unit_test(test_on_the_surface), cmocka_unit_test(test_frame)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
