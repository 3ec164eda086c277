#include "partition.h"

#include <stdlib.h>

#include "comm/fail.h"

double partition_imbalance(const int64_t *work, const int64_t *share, int n)
{
    int64_t sum = 0, shares = 0;
    double most = 0;
    for (int r = 0; r < n; r++) {
        int64_t own = share ? share[r] : 1;
        double ratio = (double)work[r] / (double)own;
        sum += work[r];
        shares += own;
        most = ratio > most ? ratio : most;
    }
    return sum == 0 ? 0 : most * (double)shares / (double)sum - 1;
}

void partition_quality_add(struct partition_quality *quality, const struct comm *comm,
    const struct partition_part *mine, const int64_t *share)
{
    int n = comm->n_rank;
    struct partition_part *all = fail_alloc((size_t)n * sizeof *all);
    int64_t *work = fail_alloc((size_t)n * sizeof *work), cut = 0, neighbours = 0;
    comm_gather(comm, mine, all, sizeof *mine);
    for (int r = 0; r < n; r++) {
        work[r] = all[r].work;
        cut += all[r].cut;
        neighbours += all[r].neighbours;
        if (all[r].neighbours > quality->neighbours_max)
            quality->neighbours_max = all[r].neighbours;
    }
    quality->n++;
    quality->imbalance = partition_imbalance(work, share, n);
    quality->imbalance_sum += quality->imbalance;
    if (quality->imbalance > quality->imbalance_max) quality->imbalance_max = quality->imbalance;
    quality->cut = (double)cut;
    quality->cut_sum += quality->cut;
    quality->neighbours_sum += (double)neighbours / n;
    free(work);
    free(all);
}
