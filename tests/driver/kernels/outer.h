#ifndef TEST_OUTER_H
#define TEST_OUTER_H
#include "inner.h"
#define OUTER(x) (INNER(x) + 1)
#endif
