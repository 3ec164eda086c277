/* Prints what the tables of commands and keys say, without MPI: help of each command, help of the
 * program, the scene language, each before a form feed. The build makes man pages and completion
 * from it (scripts/manual.py). */
#include "options.h"
#include "scene/scene.h"

int main(void)
{
    for (int c = 0; c <= OPTIONS_NONE; c++) {
        options_help((enum options_command)c, stdout);
        putchar('\f');
    }
    return scene_explain(NULL) ? 0 : 1;
}
