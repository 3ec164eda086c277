/* What `democles check` prints of a scene of either method. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "check_parts.h"
#include "scene/scene_keys.h"

void check_head(const struct scene *scene)
{
    char *precision = scene_key_word("precision", (int)scene->precision);
    const char *method = scene->method == METHOD_LATTICE ? "lattice" : "particles";
    printf("%s\n", scene->title && *scene->title ? scene->title : scene->name);
    printf(
        "    %s: %s in %s precision, hash %016lx\n", scene->path, method, precision, scene->hash);
    free(precision);
    printf(
        "    gravity (%g, %g, %g) m/s2", scene->gravity[0], scene->gravity[1], scene->gravity[2]);
    for (int a = 0; a < 3; a++)
        if (scene->domain.periodic[a])
            printf(", periodic in %c over %g m", "xyz"[a],
                scene -> domain.max[a] - scene->domain.min[a]);
    printf("%s\n",
        scene->domain.remove_outside ? ", particles that leave the domain are removed" : "");
}

void check_warnings(struct scene_errors *warnings)
{
    for (int k = 0; k < warnings->n; k++) printf("    warning: %s\n", warnings->text[k]);
    scene_errors_free(warnings);
}

void check_output(const struct scene *scene)
{
    double every[] = {scene->output.every, scene->output.checkpoint_every}, n = 0;
    printf("\noutput: frames at the start, at the end");
    for (int k = 0; k < 2; k++) {
        if (every[k] <= 0) continue;
        every[k] = fmax(every[k], scene->time.step); /* no more than one in a step */
        n += floor(scene->time.end / every[k] * (1 - 1e-9));
        printf(" and every %g s", every[k]);
    }
    printf(", %s%.10g in all\n", n > 0 && every[0] > 0 && every[1] > 0 ? "up to " : "", n + 2);
    for (int k = 0; k < scene->n_measure; k++)
        printf("    %s.csv every %g s\n", scene->measure[k].name, scene->measure[k].every);
}

void check_features(const struct feature_row *table, const void *features)
{
    for (int in = 1; in >= 0; in--) {
        int column = printf("%sfeatures %s:", in ? "\n" : "", in ? "in" : "out");
        for (const struct feature_row *row = table; feature_table_more(row); row++) {
            if (!row->name || feature_table_value(row, features) != in) continue;
            if (column > 100) column = printf("\n   ");
            column += printf(" %s", row->name);
        }
        printf("\n");
    }
}
