/* Which device a node's ranks take, on machines that we do not have. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "device/device_find.h"

static struct device_entry entry(int platform, int index, const char *platform_name,
    const char *name, cl_device_type type, bool fp64, const char *bus)
{
    struct device_entry e = {
        .platform_index = platform, .device_index = index, .info = {.type = type, .fp64 = fp64}};
    strcpy(e.info.platform_name, platform_name);
    strcpy(e.info.name, name);
    strcpy(e.bus, bus);
    return e;
}

/* A node with pocl, an integrated GPU without fp64, and two GPUs of which one shows under a second
 * driver. Not in the order of their addresses. */
enum { POCL, INTEGRATED, TESLA_2, TESLA_1, TESLA_2_AGAIN, N_ENTRY };

static void machine(struct device_entry e[N_ENTRY])
{
    e[POCL] =
        entry(0, 0, "Portable Computing Language", "pthread-znver", CL_DEVICE_TYPE_CPU, true, "");
    strcpy(e[POCL].info.platform_version, "OpenCL 3.0 PoCL 3.1");
    e[INTEGRATED] = entry(
        1, 0, "Intel(R) OpenCL Graphics", "Iris Xe", CL_DEVICE_TYPE_GPU, false, "0000:00:02.0");
    e[TESLA_2] = entry(2, 0, "NVIDIA CUDA", "Tesla T4", CL_DEVICE_TYPE_GPU, true, "0000:82:00.0");
    e[TESLA_1] = entry(2, 1, "NVIDIA CUDA", "Tesla T4", CL_DEVICE_TYPE_GPU, true, "0000:17:00.0");
    e[TESLA_2_AGAIN] = entry(3, 0, "rusticl", "NV164", CL_DEVICE_TYPE_GPU, true, "0000:82:00.0");
}

static void expect(const char *choice, bool need_fp64, int n, const int *want)
{
    struct device_entry e[N_ENTRY];
    int order[N_ENTRY];
    machine(e);
    assert_int_equal(device_deal(e, N_ENTRY, choice, need_fp64, order), n);
    for (int i = 0; i < n; i++) assert_int_equal(order[i], want[i]);
}

static void by_itself(void **state)
{
    (void)state;
    /* by address; the integrated one cannot, pocl is never taken beside GPUs */
    expect(NULL, true, 2, (int[]){TESLA_1, TESLA_2});
    expect(NULL, false, 3, (int[]){INTEGRATED, TESLA_1, TESLA_2});
}

static void named(void **state)
{
    (void)state;
    expect("pocl", true, 1, (int[]){POCL}); /* by the platform's version */
    expect("portable", true, 1, (int[]){POCL});
    expect("0:0", true, 1, (int[]){POCL});
    expect("0", true, 1, (int[]){POCL});
    expect(":t4", true, 2, (int[]){TESLA_1, TESLA_2});
    expect("nvidia:1", true, 1, (int[]){TESLA_1});
    expect("2:T4", true, 2, (int[]){TESLA_1, TESLA_2});
    expect("rusticl:", true, 1, (int[]){TESLA_2_AGAIN});
    /* no fp64 there: device_open refuses it, it is not exchanged for another */
    expect("intel:xe", true, 1, (int[]){INTEGRATED});
    expect("nvidia:2", true, 0, NULL);
    expect("nvidia:Tesla K80", true, 0, NULL);
    expect("7", true, 0, NULL);
}

static void unusable(void **state)
{
    struct device_entry e[N_ENTRY];
    int order[N_ENTRY];
    (void)state;
    machine(e);
    e[TESLA_1].unusable = "not available";
    assert_int_equal(device_deal(e, N_ENTRY, NULL, true, order), 1);
    assert_int_equal(order[0], TESLA_2);
    assert_int_equal(device_deal(e, N_ENTRY, "2:1", true, order), 0);
    assert_int_equal(device_deal(e, 0, NULL, true, order), 0);
    assert_int_equal(device_deal(e, 1, NULL, true, order), 1); /* pocl alone: then the CPU */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_itself), cmocka_unit_test(named), cmocka_unit_test(unusable)};
    return cmocka_run_group_tests_name("device_deal", tests, NULL, NULL);
}
