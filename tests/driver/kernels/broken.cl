#include "inner.h"

__kernel void broken(__global real *x)
{
    x[0] = no_such_thing;
}
