/* What the tests of the two force kernels share: a device, a program with one kernel, contacts of
 * two materials, random numbers, and steps in both ways of going over a batch. */
#ifndef FORCE_FIXTURE_H
#define FORCE_FIXTURE_H

#include "contact_scene.h"
#include "record_reader.h"

enum { FORCE_BUFFERS = 15, FORCE_ROWS = N_MATERIAL * N_MATERIAL };

/* First member of what a test knows. */
struct force_run {
    struct device *dev;
    struct launch *launch;
    struct reader reader;
    struct contact_scene contacts;
    double row[FORCE_ROWS][TABLE_WIDTH]; /* parameters, for the host */
    real table[FORCE_ROWS][TABLE_WIDTH]; /* the same, for the device */
    struct buffer buffer[FORCE_BUFFERS];
    int n_touching, n_apart, n_ended, n_begun; /* contacts of all steps */
};

struct force_test {
    const char *source, *kernel;
    enum features_program program;
    size_t bytes;  /* of what the test knows */
    uint64_t seed; /* of force_any */
    /* State and arguments of the kernel; the contacts are there. */
    void (*set)(struct force_run *);
    /* One step, against the law. */
    void (*check)(struct force_run *);
    /* The way to the next step. */
    void (*move)(struct force_run *);
};

/* All steps, once by one work-item per batch and once by many; argument: one or many for one of
 * them. Returns how many of both failed. */
int force_main(const struct force_test *test, int argc, char **argv);

/* Random numbers of this run: in [-1, 1), in [low, high), and a rotation by rows. */
double force_any(void);
double force_between(double low, double high);
void force_rotation(double *r);

/* An element of one of the materials the flags have, of that radius, at rest at the origin. */
void force_element(const struct force_run *run, struct record *element, double radius);
/* Rows of all pairs of materials, and the arguments of the kernel that are the same for pairs and
 * walls. */
void force_parameters(struct force_run *run, bool wall, double radius, double mass);
/* Of i relative to j, which is NULL at a wall at rest. */
struct kinematics_motion force_motion(const struct record *i, const struct record *j);
/* Positions after a step, velocities changed a little. */
void force_move(struct record *element, int n);
/* A history such as a contact may have; a third begins without one. */
void force_history(int *state, real *history, size_t capacity, size_t at);

/* The device's ledger after a step against the host's, which takes the contact's share and `work`,
 * of a wall, 0 without one. */
void force_check_ledger(const double *device, double *host, size_t capacity, size_t at,
    struct contact_result r, double work);
void force_count(struct force_run *run, int before, int after);

#endif
