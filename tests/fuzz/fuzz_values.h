/* How libFuzzer changes a text of values: half of the time one value by another, so that a scene
 * stays a scene and rows stay rows. Bytes changed at random hardly ever give an input that is right
 * but for one value. */
#ifndef FUZZ_VALUES_H
#define FUZZ_VALUES_H

#include "fuzz_input.h"

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed);

static inline int values_end(uint8_t byte)
{
    return byte && strchr(",:[]{} \t\r\n", byte) != NULL;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed)
{
    static const char *const values[] = {"-1", "0", "-0", "1", "2", "0.5", "1e-3", "-1e-3", "1e15",
        "1e308", "-1e308", "1e-308", "inf", "nan", "0x1p3", "9223372036854775808", "2147483648",
        "-2147483649", "", "x", "1 km^99999999999", "1 s^-2", "*a", "[]", "{}", "null",
        /* as long as a buffer for a number */
        "0000000000000000000000000000000000000000000000000000000000000001"};
    enum { N = sizeof values / sizeof *values };
    if (size == 0 || seed % 2) return LLVMFuzzerMutate(data, size, max_size);
    const char *value = values[seed / 2 % N];
    size_t begin = seed / (2 * N) % size, end = begin, length = strlen(value);
    while (begin > 0 && !values_end(data[begin - 1])) begin--;
    while (end < size && !values_end(data[end])) end++;
    if (size - (end - begin) + length > max_size) return LLVMFuzzerMutate(data, size, max_size);
    memmove(data + begin + length, data + end, size - end);
    memcpy(data + begin, value, length);
    return size - (end - begin) + length;
}

#endif
