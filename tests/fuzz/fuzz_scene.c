/* A scene of any bytes is read, or refused with a message; what is read goes back to text and is
 * read again (scene_read does that itself). */
#include "fuzz_values.h"
#include "scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char not_again[] = ": no run of this scene could be resumed";
    struct scene_errors errors = {0};
    const char *path = fuzz_file(data, size);
    struct scene *scene = scene_read(path, NULL, 0, &errors);
    fuzz_expect((scene == NULL) == (errors.n > 0), "a scene, or a message why there is none");
    for (int k = 0; k < errors.n; k++)
        fuzz_expect(strncmp(errors.text[k] + strlen(path), not_again, strlen(not_again)) != 0,
            "a scene that is read can be read back");
    scene_free(scene);
    scene_errors_free(&errors);
    return 0;
}
