/* Where pocl keeps the kernels that it has compiled. Without a folder that it can write pocl has no
 * device at all, and says nothing. */
#ifndef DEMOCLES_CACHE_FOLDER_H
#define DEMOCLES_CACHE_FOLDER_H

#include <stdbool.h>

/* Before the first OpenCL call: sets POCL_CACHE_DIR to the folder that pocl would take, or, where
 * that cannot be written and nobody has named it, to one of this user in the temporary folder. Also
 * forgets empty variables of pocl, which it takes for names. Later calls do nothing. */
void cache_folder_prepare(void);
/* That folder, and whether it can be written. */
const char *cache_folder_path(void);
bool cache_folder_works(void);
/* The folder whose place the temporary one has taken, or NULL. */
const char *cache_folder_instead_of(void);
/* Why the folder cannot be written and what to do, in fresh memory owned by the caller; NULL: it
 * can. */
char *cache_folder_trouble(void);

#endif
