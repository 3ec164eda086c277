/* PEFRL and VEFRL: Omelyan, Mryglod, Folk, Comput. Phys. Commun. 146 (2002) 188, optimised extended
 * Forest-Ruth like algorithms:
 *     PEFRL  D(xi) K((1-2 la)/2) D(ch) K(la) D(1-2(ch+xi)) K(la) D(ch) K((1-2 la)/2) D(xi)
 *     VEFRL  the same with K and D exchanged
 * RK4 is the classical scheme, RKN4 Nystrom's of fourth order with three stages for accelerations
 * without velocities:
 *     k1 = f(x), k2 = f(x + dt v/2 + dt^2 k1/8), k3 = f(x + dt v + dt^2 k2/2)
 *     x += dt v + dt^2 (k1 + 2 k2)/6,  v += dt (k1 + 4 k2 + k3)/6
 * whose dt v is added in three parts, so that a prescribed velocity is integrated by Simpson's
 * rule. */
#include "lattice_schemes.h"

#define P_XI 0.1786178958448091
#define P_LA -0.2123418310626054
#define P_CH -0.06626458266981849
#define V_XI 0.1644986515575760
#define V_LA -0.02094333910398989
#define V_CH 1.235692651138917

static const struct lattice_table table[] = {[LATTICE_LEAPFROG] = {.name = "leapfrog",
                                                 .ends_with_kick = true,
                                                 .n = 1,
                                                 .op = {{0.5, 0.5, 1}}},
    [LATTICE_RK4] = {.name = "rk4",
        .is_rk = true,
        .n = 4,
        .rk = {{.at = 0, .sum_v = 1.0 / 6, .sum_k = 1.0 / 6, .next_v = 0.5, .next_k = 0.5},
            {.at = 0.5, .sum_v = 1.0 / 3, .sum_k = 1.0 / 3, .next_v = 0.5, .next_k = 0.5},
            {.at = 0.5, .sum_v = 1.0 / 3, .sum_k = 1.0 / 3, .next_v = 1, .next_k = 1},
            {.at = 1, .sum_v = 1.0 / 6, .sum_k = 1.0 / 6}}},
    [LATTICE_RKN4] = {.name = "rkn4",
        .is_rk = true,
        .is_nystrom = true,
        .n = 3,
        .rk = {{.at = 0,
                   .sum_v = 1.0 / 6,
                   .sum_a = 1.0 / 6,
                   .sum_k = 1.0 / 6,
                   .next_v = 0.5,
                   .next_a = 0.125,
                   .next_turn = 0.5},
            {.at = 0.5,
                .sum_v = 2.0 / 3,
                .sum_a = 1.0 / 3,
                .sum_k = 2.0 / 3,
                .next_v = 1,
                .next_a = 0.5,
                .next_turn = 1,
                .sum_turn = 1,
                .before = 0.25,
                .own = 0.25},
            {.at = 1, .sum_v = 1.0 / 6, .sum_k = 1.0 / 6, .before = 1}}},
    [LATTICE_PEFRL] = {.name = "pefrl",
        .first = P_XI,
        .n = 4,
        .op = {{0, 0.5 - P_LA, P_CH}, {0, P_LA, 1 - 2 * (P_CH + P_XI)}, {0, P_LA, P_CH},
            {0, 0.5 - P_LA, P_XI}}},
    [LATTICE_VEFRL] = {.name = "vefrl",
        .ends_with_kick = true,
        .n = 4,
        .op = {{V_XI, V_XI, 0.5 - V_LA}, {0, V_CH, V_LA}, {0, 1 - 2 * (V_CH + V_XI), V_LA},
            {0, V_CH, 0.5 - V_LA}}}};

const struct lattice_table *lattice_schemes_table(enum lattice_scheme scheme)
{
    return &table[scheme];
}
