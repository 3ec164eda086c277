/* A launch: a kernel with its arguments bound by name, ready to be enqueued again and again.
 *
 * Names come from the kernel's own signature (clGetKernelArgInfo), so an argument that a feature
 * removes needs no placeholder and an order cannot be wrong. 1-D ranges only. The work-group size
 * is what the kernel declares with reqd_work_group_size(n,1,1), else LAUNCH_LOCAL. The range is
 * padded up to whole groups and coarsely beyond (see launch_padded), so a kernel takes the number
 * of items as an argument and begins `if (i >= n) return`. */
#ifndef DEMOCLES_LAUNCH_H
#define DEMOCLES_LAUNCH_H

#include "buffer.h"
#include "program.h"

enum { LAUNCH_LOCAL = 64 };

struct launch_arg {
    char *name, *type; /* as written in the kernel: "x", "double*" */
    bool is_global;    /* a __global or __constant pointer, else a value */
    bool bound;
    const struct buffer *buffer; /* followed when it grows; NULL: a plain cl_mem or a value */
    int64_t serial;              /* of the memory that is set in the kernel */
};

struct launch {
    const struct program *program; /* borrowed */
    cl_kernel kernel;
    char *name;
    int n_arg;
    struct launch_arg *arg; /* [n_arg] */
    size_t local;           /* work-items per group */
    size_t batch;           /* items per group: local, unless launch_set_batch says otherwise */
    size_t largest;         /* largest global size so far: a larger one may compile */
    int64_t n_run;
    void *profile;  /* events under way, only with dev->profile */
    double seconds; /* [s] device time so far, only with dev->profile: see launch_seconds */
};

struct launch *launch_create(const struct program *program, const char *kernel);
void launch_free(struct launch *launch); /* NULL is fine */

/* Says that each group does n_item items, whatever its size (kernels/common/batch.h). */
void launch_set_batch(struct launch *launch, size_t n_item);

/* Whether this build of the kernel has the argument. */
bool launch_has(const struct launch *launch, const char *arg);

/* Bind a pointer argument. launch_bind_buffer remembers the buffer (borrowed, must stay where it
 * is): when it grows, or when two buffers are swapped by value, the next run takes the new memory.
 * An unknown name, or a value argument, is our bug: message with the argument list, stop. The _if
 * forms are for arguments that features remove: false if there is none of that name. */
void launch_bind(struct launch *launch, const char *arg, cl_mem mem);
void launch_bind_buffer(struct launch *launch, const char *arg, const struct buffer *buffer);
bool launch_bind_if(struct launch *launch, const char *arg, cl_mem mem);
bool launch_bind_buffer_if(struct launch *launch, const char *arg, const struct buffer *buffer);

/* The same for all rows of a table, which ends with {0}; the _if form leaves out those that the
 * kernel does not have. */
struct launch_binding {
    const char *arg;
    const struct buffer *buffer;
};
void launch_bind_all(struct launch *launch, const struct launch_binding *all);
void launch_bind_all_if(struct launch *launch, const struct launch_binding *all);

/* Set a value argument. The size has to be that of the declared type where launch.c knows it
 * (scalars of OpenCL C, real, preal). The same rules. launch_set_real converts to what the kernel
 * declares: float, double, real or preal. launch_set_count sets an int to a count or an index of
 * the host; one that an int cannot hold ends the run. launch_set_vector sets three values: arg_x,
 * arg_y and arg_z. */
void launch_set(struct launch *launch, const char *arg, const void *value, size_t size);
void launch_set_int(struct launch *launch, const char *arg, int32_t value);
void launch_set_long(struct launch *launch, const char *arg, int64_t value);
void launch_set_count(struct launch *launch, const char *arg, int64_t value);
void launch_set_real(struct launch *launch, const char *arg, double value);
void launch_set_vector(struct launch *launch, const char *arg, const double value[3]);
bool launch_set_if(struct launch *launch, const char *arg, const void *value, size_t size);
bool launch_set_int_if(struct launch *launch, const char *arg, int32_t value);
bool launch_set_count_if(struct launch *launch, const char *arg, int64_t value);
bool launch_set_real_if(struct launch *launch, const char *arg, double value);
void launch_set_vector_if(struct launch *launch, const char *arg, const double value[3]);

/* Stops with the names of all arguments that are not bound. Once, after set-up; launch_run asserts
 * the same. */
void launch_check(const struct launch *launch);

/* Enqueues n_item work-items, padded, on the compute queue; none for n_item <= 0. Allocates
 * nothing. On pocl the first run, and one larger than all before, waits until it is done, because
 * pocl compiles then (kernel_cache.h). */
void launch_run(struct launch *launch, int64_t n_item);
/* The same on any queue, behind `after`, with an event that the caller releases; either may be
 * NULL. n_item <= 0 enqueues no kernel, but the queue still waits and the event is still given. */
void launch_run_on(struct launch *launch, cl_command_queue queue, int64_t n_item,
    const cl_event *after, cl_event *event);

/* Global size for n_item > 0: whole groups, above 64 groups rounded up to 64 steps per power of two
 * (at most 1.6 % of empty items), because pocl keeps a list of the sizes it has seen, and list
 * rebuilds change sizes all the time. */
size_t launch_padded(int64_t n_item, size_t local);

/* Device time of all runs so far [s]; 0 unless the device was opened with profiling. Waits for runs
 * under way. */
double launch_seconds(struct launch *launch);

#endif
