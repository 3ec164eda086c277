/* A table of a factor over time of any bytes is read, and its values and means over any interval
 * are no less and no more than what stands in it; or it is refused with a message. */
#include "fuzz_values.h"
#include "scene/history.h"

#include <math.h>

static void check(const struct history *h)
{
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < h->n_point; k++) {
        fuzz_expect(k == 0 || h->point[k][0] > h->point[k - 1][0], "times increase");
        low = fmin(low, h->point[k][1]);
        high = fmax(high, h->point[k][1]);
    }
    /* rounding of the sum over the pieces, and overflow of differences of huge numbers */
    double room = 1e-12 * (double)h->n_point * fmax(fabs(low), fabs(high));
    if (!(fabs(low) < 1e150 && fabs(high) < 1e150)) return;
    const double begin = h->point[0][0], end = h->point[h->n_point - 1][0];
    const double t[] = {begin, end, 0.5 * begin + 0.5 * end, 0, -1, 1e-300, 1e30};
    enum { N = sizeof t / sizeof *t };
    for (int k = 0; k < N; k++) {
        double value = history_at(h, t[k]), mean = history_mean(h, t[k], t[(k + 1) % N]);
        fuzz_expect(value >= low - room && value <= high + room, "values are within the table");
        if (fabs(begin) < 1e150 && fabs(end) < 1e150)
            fuzz_expect(mean >= low - room && mean <= high + room, "means are within the table");
        history_rate(h, t[k]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct history history = {.kind = HISTORY_TABLE};
    char *problem = history_read(&history, fuzz_file(data, size));
    fuzz_expect(problem || history.n_point > 0, "a point, or a message why there is none");
    if (!problem) check(&history);
    free(problem);
    free(history.point);
    return 0;
}
