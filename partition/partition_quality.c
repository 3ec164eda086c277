#include "partition.h"

double partition_imbalance(const struct comm *comm, int64_t weight)
{
    int64_t sum = weight, most = weight;
    comm_sum_i64(comm, &sum, 1);
    comm_max_i64(comm, &most, 1);
    /* W_mean = sum/n, so U = (n W_max - sum)/sum, exact up to the division. */
    return sum == 0 ? 0 : (double)(most * comm->n_rank - sum) / (double)sum;
}
