/* The text of every file in kernels/, put into the executable by scripts/embed.py at build time. */
#ifndef DEMOCLES_KERNEL_SOURCE_H
#define DEMOCLES_KERNEL_SOURCE_H

struct kernel_source {
    const char *name;   /* "pair_force.cl", no other kernel file has this name */
    const char *folder; /* "particle": the folder of kernels/ that holds it */
    const char *text;
};

/* Ascending by name; an entry with name NULL ends it. */
extern const struct kernel_source kernel_source_table[];

#endif
