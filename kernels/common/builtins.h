/* The functions of OpenCL C that kernels call, declared here for a compiler that does not declare
 * them itself: pocl reads a header of 18,000 lines with all that there are, with each program of
 * each process, also where the program has been compiled before. Told not to (program.c), a start
 * takes half of the processor's time, 0.3 s less (pocl 3.1, AMD Zen 5), and the code of all kernels
 * is the same to the instruction. Who calls another function adds it; scripts/lint_kernels knows
 * these alone. */
#ifndef DEMOCLES_BUILTINS_H
#define DEMOCLES_BUILTINS_H
#ifdef DECLARE_BUILTINS

#ifdef cl_khr_fp64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
#define BUILTIN __attribute__((overloadable))
#define BUILTIN_CONST __attribute__((overloadable, const))
#define BUILTIN_PURE __attribute__((overloadable, pure))

size_t BUILTIN_CONST get_global_id(uint);
size_t BUILTIN_CONST get_group_id(uint);
size_t BUILTIN_CONST get_local_id(uint);
void BUILTIN __attribute__((convergent)) barrier(cl_mem_fence_flags);
int BUILTIN atomic_inc(volatile __global int *);
int BUILTIN_CONST min(int, int);
int BUILTIN_CONST max(int, int);

#define BUILTIN_REAL(type)                                                                         \
    type BUILTIN_CONST fabs(type);                                                                 \
    type BUILTIN_CONST floor(type);                                                                \
    type BUILTIN_CONST fma(type, type, type);                                                      \
    type BUILTIN_CONST rint(type);                                                                 \
    type BUILTIN_CONST sqrt(type);                                                                 \
    type##4 BUILTIN_CONST fma(type##4, type##4, type##4);                                          \
    type##4 BUILTIN_PURE vload4(size_t, const __global type *);                                    \
    void BUILTIN vstore4(type##4, size_t, __global type *);
BUILTIN_REAL(float)
float4 BUILTIN_CONST convert_float4(float4);
#ifdef cl_khr_fp64
BUILTIN_REAL(double)
double4 BUILTIN_CONST convert_double4(double4);
double4 BUILTIN_CONST convert_double4(float4);
float4 BUILTIN_CONST convert_float4(double4);
#endif

#undef BUILTIN
#undef BUILTIN_CONST
#undef BUILTIN_PURE
#undef BUILTIN_REAL
#endif
#endif
