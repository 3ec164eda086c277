/* compile_force KERNEL PRECISION FEATURE...: builds a force kernel with these features and runs it
 * once on zeros, so that the driver compiles it and nothing else. What its compiler has to say goes
 * where the driver sends it. Leaves with 77 where the platform is not pocl or has no doubles. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernels/common/batch.h"
#include "comm/fail.h"
#include "particle/features.h"
#include "device/launch.h"

enum { N = 64, MOST = 32, BYTES = 1 << 16 };

static void set_feature(struct features *f, const char *name)
{
    const struct {
        const char *name;
        bool *value;
    } table[] = {{"spin", &f->spin}, {"sizes", &f->sizes}, {"materials", &f->materials},
        {"periodic", &f->periodic[0]}, {"plane", &f->plane}, {"rectangle", &f->rectangle},
        {"cylinder", &f->cylinder}, {"triangle", &f->triangle}, {"moving", &f->moving},
        {"linear", &f->pair.linear}, {"hertz", &f->pair.hertz}, {"tangential", &f->pair.tangential},
        {"damping", &f->pair.tangential_damping}, {"epsd", &f->pair.rolling_epsd},
        {"cdt", &f->pair.rolling_cdt}, {"binding", &f->pair.binding}, {"jkr", &f->pair.jkr}};
    for (size_t k = 0; k < sizeof table / sizeof *table; k++)
        if (!strcmp(table[k].name, name)) {
            *table[k].value = true;
            return;
        }
    fail_stop(EXIT_USAGE, "compile_force knows no feature %s", name);
}

/* Zeros wherever a pointer is wanted, 1 for numbers, N items. */
static void set_arguments(struct device *dev, struct launch *launch, struct buffer *zeros)
{
    for (int i = 0; i < launch->n_arg; i++) {
        const char *name = launch->arg[i].name;
        if (launch->arg[i].is_global) {
            buffer_init(&zeros[i], dev, "zeros");
            buffer_reserve(&zeros[i], BYTES);
            buffer_zero(&zeros[i]);
            launch_bind_buffer(launch, name, &zeros[i]);
        } else if (!strcmp(launch->arg[i].type, "int")) {
            launch_set_int(launch, name, !strcmp(name, "first") ? 0 : N);
        } else {
            launch_set_real(launch, name, 1);
        }
    }
}

int main(int argc, char **argv)
{
    if (argc < 3) return EXIT_USAGE;
    const char *sources[] = {
        !strcmp(argv[1], "pair_force") ? "pair_force.cl" : "wall_force.cl", NULL};
    struct features features = {.walls = true};
    static struct buffer zeros[MOST];
    bool is_pair = !strcmp(argv[1], "pair_force");
    features.real_is_float = strcmp(argv[2], "double");
    features.position_is_float = !strcmp(argv[2], "single");
    for (int i = 3; i < argc; i++) set_feature(&features, argv[i]);
    features.wall = features.pair;
    features.spin_kick =
        features.pair.tangential_damping || features.pair.rolling_cdt || features.pair.rolling_epsd;
    features.kick = features.spin_kick;
    struct device *dev = device_open(NULL, NULL, false, false);
    if (!dev->is_pocl || (!features.position_is_float && !dev->fp64)) {
        printf("%s on %s\n", dev->name, dev->platform_name);
        return 77;
    }
    char *options = features_options(&features, is_pair ? FEATURES_PAIR : FEATURES_WALL);
    struct program *program = program_build(dev, NULL, "vectorised", options, sources);
    struct launch *launch = launch_create(program, argv[1]);
    launch_set_batch(launch, BATCH);
    set_arguments(dev, launch, zeros);
    launch_run(launch, N);
    device_finish(dev);
    for (int i = 0; i < MOST; i++) buffer_free(&zeros[i]);
    launch_free(launch);
    program_free(program);
    free(options);
    device_free(dev);
    return 0;
}
