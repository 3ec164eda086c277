/* Vectors in planes of memory: number k of item i lies at k * plane + i. A vector's components are
 * the three numbers from k on. */
#ifndef DEMOCLES_PLANES_H
#define DEMOCLES_PLANES_H

#include "vec.h"

LAW vec3 v3_load(__global const real *memory, size_t plane, int k, size_t i)
{
    return v3(memory[(size_t)k * plane + i], memory[(size_t)(k + 1) * plane + i],
        memory[(size_t)(k + 2) * plane + i]);
}
LAW void v3_store(__global real *memory, size_t plane, int k, size_t i, vec3 a)
{
    memory[(size_t)k * plane + i] = a.x;
    memory[(size_t)(k + 1) * plane + i] = a.y;
    memory[(size_t)(k + 2) * plane + i] = a.z;
}

LAW pvec3 p3_load(__global const preal *memory, size_t plane, int k, size_t i)
{
    return p3(memory[(size_t)k * plane + i], memory[(size_t)(k + 1) * plane + i],
        memory[(size_t)(k + 2) * plane + i]);
}
LAW void p3_store(__global preal *memory, size_t plane, int k, size_t i, pvec3 a)
{
    memory[(size_t)k * plane + i] = a.x;
    memory[(size_t)(k + 1) * plane + i] = a.y;
    memory[(size_t)(k + 2) * plane + i] = a.z;
}

#endif
