/* A CSV file of any bytes becomes elements that have finite places and a size, checked against each
 * other as those of a run are, or is refused with a message. */
#include "fuzz_values.h"
#include "particle/generate.h"

#include <math.h>

static void check(const struct elements_host *e)
{
    for (int64_t i = 0; i < 3 * e->n; i++)
        fuzz_expect(isfinite(e->x[i]) && isfinite(e->v[i]) && isfinite(e->w[i]), "numbers finite");
    for (int64_t i = 0; i < e->n; i++) fuzz_expect(e->radius[i] > 0, "elements have a size");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char name[] = "grains", path[64];
    snprintf(path, sizeof path, "%s", fuzz_file(data, size));
    struct element_group group = {.name = name, .from_file = true, .file = path, .line = 4};
    struct scene scene = {.path = name, .group = &group, .n_group = 1};
    scene.domain.start_overlap = size % 2 ? 0.5 : HUGE_VAL;
    struct scene_errors errors = {0};
    struct elements_host *elements = generate_elements(&scene, &errors);
    fuzz_expect((elements == NULL) == (errors.n > 0), "elements, or a message why there are none");
    if (elements) check(elements);
    generate_free(elements);
    scene_errors_free(&errors);
    return 0;
}
