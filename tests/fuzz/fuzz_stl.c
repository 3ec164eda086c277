/* A surface of any bytes, ASCII or binary, becomes a mesh whose indices are in their ranges, or is
 * refused with a message. The scale is the last byte's. */
#include "fuzz_values.h"
#include "shape/stl.h"

#include <math.h>

static void check(const struct stl *stl)
{
    fuzz_expect(stl->n_triangle > 0, "a mesh has a triangle");
    for (int k = 0; k < 3 * stl->n_triangle; k++) {
        fuzz_expect(stl->triangle[k] >= 0 && stl->triangle[k] < stl->n_vertex, "corners are there");
        fuzz_expect(stl->edge[k] >= 0 && stl->edge[k] < stl->n_edge, "edges are there");
    }
    for (int k = 0; k < 3 * stl->n_vertex; k++)
        fuzz_expect(isfinite(stl->vertex[k]), "vertices are finite");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double scale[] = {1, 1e-3, 1e300, 1e-300};
    char *error = NULL;
    struct stl *stl =
        stl_read(fuzz_file(data, size), size > 0 ? scale[data[size - 1] % 4] : 1, &error);
    fuzz_expect((stl == NULL) == (error != NULL), "a mesh, or a message why there is none");
    if (stl) check(stl);
    stl_free(stl);
    free(error);
    return 0;
}
