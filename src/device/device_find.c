#include "device_find.h"

#include <CL/cl_ext.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cache_folder.h"
#include "comm/fail.h"

/* Device and platform text, without the blanks that some drivers put around it. */
static void trim(char *text)
{
    size_t lead = strspn(text, " \t\n");
    memmove(text, text + lead, strlen(text + lead) + 1);
    for (size_t n = strlen(text); n > 0 && isspace((unsigned char)text[n - 1]); n--)
        text[n - 1] = 0;
}

static void device_text(cl_device_id id, cl_device_info what, char text[DEVICE_TEXT])
{
    char all[4096] = "";
    if (clGetDeviceInfo(id, what, sizeof all, all, NULL) != CL_SUCCESS) all[0] = 0;
    trim(all);
    snprintf(text, DEVICE_TEXT, "%.*s", DEVICE_TEXT - 1, all);
}

static void platform_text(cl_platform_id id, cl_platform_info what, char text[DEVICE_TEXT])
{
    char all[4096] = "";
    if (clGetPlatformInfo(id, what, sizeof all, all, NULL) != CL_SUCCESS) all[0] = 0;
    trim(all);
    snprintf(text, DEVICE_TEXT, "%.*s", DEVICE_TEXT - 1, all);
}

static bool has_extension(cl_device_id id, const char *name)
{
    size_t bytes = 0;
    if (clGetDeviceInfo(id, CL_DEVICE_EXTENSIONS, 0, NULL, &bytes) != CL_SUCCESS) return false;
    char *all = fail_alloc(bytes + 1);
    bool has = clGetDeviceInfo(id, CL_DEVICE_EXTENSIONS, bytes, all, NULL) == CL_SUCCESS &&
               strstr(all, name);
    free(all);
    return has;
}

/* PCI address as text by the Khronos extension, else by NVIDIA's or AMD's own. */
static void bus_address(cl_device_id id, char *text, size_t n)
{
    cl_uint khr[4]; /* domain, bus, device, function */
    text[0] = 0;
    if (has_extension(id, "cl_khr_pci_bus_info") &&
        !clGetDeviceInfo(id, 0x410F /* CL_DEVICE_PCI_BUS_INFO_KHR */, sizeof khr, khr, NULL)) {
        snprintf(text, n, "%04x:%02x:%02x.%x", khr[0], khr[1], khr[2], khr[3]);
        return;
    }
    cl_uint bus, slot;
    if (has_extension(id, "cl_nv_device_attribute_query") &&
        !clGetDeviceInfo(id, 0x4008 /* CL_DEVICE_PCI_BUS_ID_NV */, sizeof bus, &bus, NULL) &&
        !clGetDeviceInfo(id, 0x4009 /* CL_DEVICE_PCI_SLOT_ID_NV: device << 3 | function */,
            sizeof slot, &slot, NULL)) {
        snprintf(text, n, "%04x:%02x:%02x.%x", 0u, bus, slot >> 3, slot & 7);
        return;
    }
    struct {
        cl_uint type; /* 1: PCI Express */
        unsigned char unused[17], bus, device, function;
    } amd;
    if (has_extension(id, "cl_amd_device_attribute_query") &&
        !clGetDeviceInfo(id, 0x4037 /* CL_DEVICE_TOPOLOGY_AMD */, sizeof amd, &amd, NULL) &&
        amd.type == 1)
        snprintf(text, n, "%04x:%02x:%02x.%x", 0u, (unsigned)amd.bus, (unsigned)amd.device,
            (unsigned)amd.function);
}

static void query(cl_platform_id platform, cl_device_id id, struct device_entry *entry)
{
    struct device *d = &entry->info;
    cl_bool available = CL_FALSE, compiler = CL_FALSE, unified = CL_FALSE;
    cl_device_fp_config fp32 = 0, fp64 = 0;

    d->platform = platform;
    d->id = id;
    platform_text(platform, CL_PLATFORM_NAME, d->platform_name);
    platform_text(platform, CL_PLATFORM_VERSION, d->platform_version);
    device_text(id, CL_DEVICE_NAME, d->name);
    device_text(id, CL_DEVICE_VENDOR, d->vendor);
    device_text(id, CL_DRIVER_VERSION, d->driver);
    device_text(id, CL_DEVICE_VERSION, d->version);
    device_text(id, CL_DEVICE_OPENCL_C_VERSION, d->opencl_c);
    /* What a driver does not know stays 0, which is never more than the truth. */
    clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof d->type, &d->type, NULL);
    clGetDeviceInfo(id, CL_DEVICE_AVAILABLE, sizeof available, &available, NULL);
    clGetDeviceInfo(id, CL_DEVICE_COMPILER_AVAILABLE, sizeof compiler, &compiler, NULL);
    clGetDeviceInfo(id, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof unified, &unified, NULL);
    clGetDeviceInfo(id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof fp32, &fp32, NULL);
    clGetDeviceInfo(id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof fp64, &fp64, NULL);
    clGetDeviceInfo(id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof d->global_mem, &d->global_mem, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof d->max_alloc, &d->max_alloc, NULL);
    clGetDeviceInfo(id, CL_DEVICE_LOCAL_MEM_SIZE, sizeof d->local_mem, &d->local_mem, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof d->max_group, &d->max_group, NULL);
    clGetDeviceInfo(
        id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof d->compute_units, &d->compute_units, NULL);
    d->fp64 = fp64 != 0 && has_extension(id, "cl_khr_fp64");
    d->fp32_correct_divide = fp32 & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
    d->unified = unified;
    d->is_pocl = strstr(d->platform_name, "Portable Computing Language");
    /* others vectorise over the work-items of a group */
    d->one_lane = d->is_pocl && (d->type & CL_DEVICE_TYPE_CPU);
    d->at_once = d->is_pocl && (!strncmp(d->name, "basic", strlen("basic")) ||
                                   !strncmp(d->name, "cpu-minimal", strlen("cpu-minimal")));
    bus_address(id, entry->bus, sizeof entry->bus);
    entry->unusable = d->type & CL_DEVICE_TYPE_CUSTOM       ? "not programmable"
                      : !available                          ? "not available"
                      : !compiler                           ? "no compiler"
                      : d->is_pocl && !cache_folder_works() ? "no folder for its kernels"
                                                            : NULL;
}

int device_find(struct device_entry **entry, cl_int *code)
{
    cl_uint n_platform = 0;
    int n = 0;
    *entry = NULL;
    cache_folder_prepare();
    *code = clGetPlatformIDs(0, NULL, &n_platform);
    if (*code != CL_SUCCESS || n_platform == 0) return 0;
    cl_platform_id *platform = fail_alloc(n_platform * sizeof *platform);
    *code = clGetPlatformIDs(n_platform, platform, NULL);
    for (cl_uint p = 0; p < n_platform && *code == CL_SUCCESS; p++) {
        cl_uint n_device = 0;
        /* A platform without devices says CL_DEVICE_NOT_FOUND; a broken one should not hide the
         * others. */
        if (clGetDeviceIDs(platform[p], CL_DEVICE_TYPE_ALL, 0, NULL, &n_device) != CL_SUCCESS ||
            n_device == 0)
            continue;
        cl_device_id *id = fail_alloc(n_device * sizeof *id);
        if (clGetDeviceIDs(platform[p], CL_DEVICE_TYPE_ALL, n_device, id, NULL) != CL_SUCCESS)
            n_device = 0;
        *entry = fail_realloc(*entry, (size_t)(n + (int)n_device) * sizeof **entry);
        for (cl_uint d = 0; d < n_device; d++, n++) {
            memset(&(*entry)[n], 0, sizeof **entry);
            query(platform[p], id[d], &(*entry)[n]);
            (*entry)[n].platform_index = (int)p;
            (*entry)[n].device_index = (int)d;
        }
        free(id);
    }
    free(platform);
    return n;
}

/* Part `want` [n] of a choice against an index and a name: empty matches all, a number the index,
 * else a part of the name in any case. */
static bool matches(const char *want, size_t n, int index, const char *name)
{
    if (n == 0) return true;
    if (strspn(want, "0123456789") >= n) return atoi(want) == index;
    for (; strlen(name) >= n; name++) {
        size_t k = 0;
        while (k < n && tolower((unsigned char)name[k]) == tolower((unsigned char)want[k])) k++;
        if (k == n) return true;
    }
    return false;
}

static bool chosen(const struct device_entry *e, const char *choice)
{
    if (e->unusable) return false;
    if (!choice) return true;
    const char *colon = strchr(choice, ':');
    size_t n = colon ? (size_t)(colon - choice) : strlen(choice);
    /* a device's name alone */
    if (!colon && strspn(choice, "0123456789") < n &&
        matches(choice, n, e->device_index, e->info.name))
        return true;
    /* pocl calls itself so in its version only. */
    if (!matches(choice, n, e->platform_index, e->info.platform_name) &&
        !matches(choice, n, e->platform_index, e->info.platform_version))
        return false;
    return !colon || matches(colon + 1, strlen(colon + 1), e->device_index, e->info.name);
}

/* 0: GPU, accelerator; 1: CPU and whatever else. */
static int rank_of_kind(const struct device *d)
{
    return d->type & (CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR) ? 0 : 1;
}

/* Order of dealing: address, then names, then as listed. */
static bool before(const struct device_entry *a, const struct device_entry *b)
{
    int c = strcmp(a->bus, b->bus);
    if (c == 0) c = strcmp(a->info.platform_name, b->info.platform_name);
    if (c == 0) c = strcmp(a->info.name, b->info.name);
    if (c == 0)
        c = a->platform_index != b->platform_index ? a->platform_index - b->platform_index
                                                   : a->device_index - b->device_index;
    return c < 0;
}

int device_deal(
    const struct device_entry *entry, int n_entry, const char *choice, bool need_fp64, int *order)
{
    int best = 2, n = 0;
    bool any_fp64 = false;
    for (int i = 0; i < n_entry; i++)
        if (chosen(&entry[i], choice) && rank_of_kind(&entry[i].info) < best)
            best = rank_of_kind(&entry[i].info);
    for (int i = 0; i < n_entry; i++)
        if (chosen(&entry[i], choice) && rank_of_kind(&entry[i].info) == best)
            any_fp64 |= entry[i].info.fp64;
    for (int i = 0; i < n_entry; i++) {
        const struct device_entry *e = &entry[i];
        if (!chosen(e, choice) || rank_of_kind(&e->info) != best ||
            (need_fp64 && any_fp64 && !e->info.fp64))
            continue;
        /* one GPU under two drivers; within one platform an address may stand for several
         * devices */
        bool again = false;
        for (int k = 0; k < n; k++) {
            const struct device_entry *o = &entry[order[k]];
            again |= e->bus[0] && !strcmp(o->bus, e->bus) && o->platform_index != e->platform_index;
        }
        if (again) continue;
        int k = n++;
        for (; k > 0 && before(e, &entry[order[k - 1]]); k--) order[k] = order[k - 1];
        order[k] = i;
    }
    return n;
}

const char *device_kind(const struct device *dev)
{
    return dev->type & CL_DEVICE_TYPE_GPU           ? "GPU"
           : dev->type & CL_DEVICE_TYPE_ACCELERATOR ? "accelerator"
           : dev->type & CL_DEVICE_TYPE_CPU         ? "CPU"
                                                    : "other";
}

void device_print_short(const struct device_entry *e, FILE *file)
{
    fprintf(file, "  %d:%d  %s: %s (%s, %s%s%s)\n", e->platform_index, e->device_index,
        e->info.platform_name, e->info.name, device_kind(&e->info),
        e->info.fp64 ? "fp64" : "no fp64", e->unusable ? ", " : "", e->unusable ? e->unusable : "");
}
