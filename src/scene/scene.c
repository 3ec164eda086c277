#include "scene.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"

static void free_words(char **word, int n)
{
    for (int k = 0; k < n; k++) free(word[k]);
    free(word);
}

static void free_bodies(struct scene *scene)
{
    for (int k = 0; k < scene->n_body; k++) {
        struct body *body = &scene->body[k];
        for (int m = 0; m < body->n_minus; m++) free(body->minus[m].stl);
        free(body->minus);
        free(body->crack);
        free(body->shape.stl);
        free(body->name);
    }
    for (int k = 0; k < scene->n_boundary; k++) free(scene->boundary[k].history.point);
    free(scene->body);
    free(scene->boundary);
}

void scene_free(struct scene *scene)
{
    if (!scene) return;
    for (int k = 0; k < scene->n_material; k++) free(scene->material[k].name);
    for (int k = 0; k < scene->n_group; k++) {
        free(scene->group[k].name);
        free(scene->group[k].file);
        free(scene->group[k].region.stl);
    }
    for (int k = 0; k < scene->n_wall; k++) {
        free(scene->wall[k].name);
        free(scene->wall[k].stl);
    }
    for (int k = 0; k < scene->n_measure; k++) {
        free(scene->measure[k].name);
        free_words(scene->measure[k].field, scene->measure[k].n_field);
    }
    free_words(scene->output.field, scene->output.n_field);
    free_bodies(scene);
    free(scene->material);
    free(scene->contact);
    free(scene->group);
    free(scene->wall);
    free(scene->measure);
    free(scene->path);
    free(scene->name);
    free(scene->title);
    free(scene->given);
    free(scene->resolved);
    scene_errors_free(&scene->notes);
    free(scene);
}

double scene_mass(const struct scene *scene, int material, double radius)
{
    return scene->material[material].density * (4.0 / 3.0) * M_PI * radius * radius * radius;
}

void scene_errors_add(struct scene_errors *errors, const char *format, ...)
{
    va_list args;
    errors->text = fail_realloc(errors->text, (size_t)(errors->n + 1) * sizeof *errors->text);
    va_start(args, format);
    errors->text[errors->n++] = fail_vformat(format, args);
    va_end(args);
}

void scene_errors_free(struct scene_errors *errors)
{
    for (int k = 0; k < errors->n; k++) free(errors->text[k]);
    free(errors->text);
    *errors = (struct scene_errors){0};
}
