#ifndef TEST_INNER_H
#define TEST_INNER_H
#if REAL_IS_FLOAT
typedef float real;
#else
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
#endif
#define INNER(x) (2 * (x))
#endif
