#include "tree_fixture.h"

double tree_random(double low, double high)
{
    static uint64_t seed = 77;
    return scratch_random(&seed, low, high);
}

void tree_upload(struct lists *lists, const struct crowd *c)
{
    struct particles *p = lists->particles;
    size_t n = (size_t)c->n_all;
    p->n_owned = c->n_owned;
    p->n_ghost = c->n_all - c->n_owned;
    particles_reserve(p, &lists->features, c->n_all, 0);
    buffer_write(&p->field[FIELD_STATE].now, 0, n * sizeof *c->element, c->element);
    buffer_write(&p->field[FIELD_GID].now, 0, n * sizeof *c->gid, c->gid);
    buffer_write(&p->reach, 0, n * sizeof *c->reach, c->reach);
}

struct crowd tree_crowd(int n, double beyond)
{
    struct crowd c = crowd_create(n, n);
    for (int e = 0; e < n; e++) {
        for (int a = 0; a < 3; a++) {
            c.element[e].x[a] = (preal)tree_random(-beyond, 1 + beyond);
            c.element[e].v[a] = (real)tree_random(-3, 3);
        }
        c.element[e].radius = (preal)tree_random(0.01, 0.02);
        c.reach[e] = (preal)tree_random(0.02, 0.05);
        c.gid[e] = 3 * n - 2 * e;
    }
    return c;
}

void tree_grow(struct tree *t, int n_leaf)
{
    int leaf = 1;
    memset(t, 0, sizeof *t);
    t->rcb = (struct rcb){
        .n_node = n_leaf - 1, .axis = t->axis, .cut = t->cut, .left = t->left, .right = t->right};
    for (int k = 0; k < n_leaf - 1; k++) {
        t->axis[k] = (int)tree_random(0, 3);
        t->cut[k] = (double)(preal)tree_random(0.2, 0.8);
        t->left[k] = -1; /* leaf 0 */
        t->right[k] = -1;
        if (k == 0) t->right[0] = -1 - leaf++;
        while (k > 0) { /* splits one of the leaves there are */
            int parent = (int)tree_random(0, k),
                *child = tree_random(0, 1) < 0.5 ? &t->left[parent] : &t->right[parent];
            if (*child >= 0) continue;
            t->left[k] = *child;
            t->right[k] = -1 - leaf++;
            *child = k;
            break;
        }
    }
}

void tree_bind(struct lists *lists, struct launch *k, const struct tree *t, struct buffer buffer[3])
{
    int node[3 * TREE_LEAVES] = {0};
    preal cut[TREE_LEAVES] = {0},
          domain[6] = {0, 0, 0, (preal)LISTS_PERIOD, (preal)LISTS_PERIOD, (preal)LISTS_PERIOD};
    for (int n = 0; n < t->rcb.n_node; n++) {
        node[3 * n] = t->axis[n];
        node[3 * n + 1] = t->left[n];
        node[3 * n + 2] = t->right[n];
        cut[n] = (preal)t->cut[n];
    }
    fixture_bind(lists->dev, k, &buffer[0], "node", sizeof node, node);
    fixture_bind(lists->dev, k, &buffer[1], "cut", sizeof cut, cut);
    fixture_bind(lists->dev, k, &buffer[2], "domain", sizeof domain, domain);
    launch_set_int(k, "n_node", t->rcb.n_node);
}
