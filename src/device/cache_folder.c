#include "cache_folder.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "comm/fail.h"

extern char **environ;

static char *folder, *instead_of; /* for the life of the process */
static int trouble;               /* errno of the folder, 0: it can be written */

/* `export POCL_CACHE_DIR=$UNSET` in a job script: pocl 3.1 aborts on it, and takes an empty
 * POCL_DEVICES for no device. */
static void forget_empty(void)
{
    static const char *const other[] = {"XDG_CACHE_HOME", "HOME", "OCL_ICD_VENDORS"};
    char name[64];
    for (size_t k = 0; k < sizeof other / sizeof *other; k++)
        if (getenv(other[k]) && !getenv(other[k])[0]) unsetenv(other[k]);
    for (char **e = environ; *e;) {
        size_t n = strcspn(*e, "=");
        bool is_empty =
            n < sizeof name && !strncmp(*e, "POCL_", 5) && (*e)[n] == '=' && !(*e)[n + 1];
        if (is_empty) {
            memcpy(name, *e, n);
            name[n] = '\0';
            unsetenv(name); /* the others move up */
        } else e++;
    }
}

/* As pocl looks for it. */
static char *usual_folder(void)
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (cache) return fail_format("%s/pocl/kcache", cache);
    return home ? fail_format("%s/.cache/pocl/kcache", home) : NULL;
}

static int why_not(const char *path)
{
    struct stat status;
    if (stat(path, &status)) return errno;
    if (!S_ISDIR(status.st_mode)) return ENOTDIR;
    return access(path, W_OK | X_OK) ? errno : 0;
}

/* Makes a folder with its parents; returns errno where it cannot be written. */
static int make(char *path)
{
    for (char *c = path + 1;; c++) {
        if (*c != '/' && *c != '\0') continue;
        char kept = *c;
        *c = '\0';
        int number = mkdir(path, 0777) && errno != EEXIST ? errno : 0;
        *c = kept;
        if (kept == '\0') break;
        if (number && number != EACCES && number != EPERM && number != EROFS) return number;
    }
    return why_not(path);
}

/* In the temporary folder anybody may have made a folder of any name. */
static int make_own(const char *path)
{
    struct stat status;
    if (mkdir(path, 0700) && errno != EEXIST) return errno;
    if (lstat(path, &status)) return errno;
    return S_ISDIR(status.st_mode) && status.st_uid == geteuid() ? why_not(path) : EPERM;
}

void cache_folder_prepare(void)
{
    if (folder) return;
    forget_empty();
    const char *named = getenv("POCL_CACHE_DIR"), *tmp = getenv("TMPDIR");
    folder = named ? fail_strdup(named) : usual_folder();
    trouble = folder ? make(folder) : ENOENT;
    if (named || !trouble) {
        setenv("POCL_CACHE_DIR", folder, 1);
        return;
    }
    instead_of = folder ? folder : fail_strdup("$HOME/.cache");
    folder = fail_format("%s/democles-pocl-%d", tmp && tmp[0] ? tmp : "/tmp", (int)geteuid());
    trouble = make_own(folder);
    setenv("POCL_CACHE_DIR", folder, 1);
}

const char *cache_folder_path(void)
{
    return folder;
}

const char *cache_folder_instead_of(void)
{
    return instead_of;
}

bool cache_folder_works(void)
{
    return trouble == 0;
}

char *cache_folder_trouble(void)
{
    if (!trouble) return NULL;
    return fail_format("pocl cannot write its kernels into '%s' (%s); set "
                       "POCL_CACHE_DIR to a folder that can be written",
        folder, strerror(trouble));
}
