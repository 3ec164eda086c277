/* Generates the initial elements: the order of the work. The list of elements, filling, CSV files
 * and the checks are in generate_*.c. */
#include "generate.h"

#include "comm/fail.h"
#include "generate_parts.h"

struct elements_host *generate_elements(const struct scene *scene, struct scene_errors *errors)
{
    int n_error = errors->n;
    struct generate_list list = {.elements = fail_alloc(sizeof *list.elements)};
    for (int g = 0; g < scene->n_group; g++) {
        if (scene->group[g].from_file) generate_read_csv(&list, scene, g, errors);
        else generate_fill(&list, scene, g, errors);
    }
    if (errors->n == n_error) generate_check(scene, list.elements, errors);
    if (errors->n == n_error) return list.elements;
    generate_free(list.elements);
    return NULL;
}
