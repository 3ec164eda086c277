/* Tables of the terms of an account of energy, whatever the method: where each is in the method's
 * own struct of doubles, and how measures, balance and record go over them. Made of the lists of
 * scene/measure_columns.h. */
#ifndef DEMOCLES_ENERGY_TERMS_H
#define DEMOCLES_ENERGY_TERMS_H

#include <stdbool.h>
#include <stddef.h>

#include "results/report.h"

enum energy_terms_known {
    ENERGY_TERMS_ALWAYS,
    ENERGY_TERMS_MEASURED /* only where a measure of energy asks for it */
};

struct energy_term {
    const char *name; /* NULL: end of the table */
    size_t at;        /* offset of the double [J] */
    double sign;      /* in the balance: 1, -1 */
    enum energy_terms_known known;
    int source; /* which of the method's sums it is */
};

/* A row of a table, for the lists of scene/measure_columns.h, where `STRUCT` is the method's. */
#define ENERGY_TERM(STRUCT, name, sign, known, source)                                             \
    {                                                                                              \
#name, offsetof(STRUCT, name), sign, ENERGY_TERMS_##known, source                          \
    }

double *energy_terms_at(const struct energy_term *term, void *account);
double energy_terms_value(const struct energy_term *term, const void *account);
/* The terms, then now minus start of their sum [J], into value; returns how many numbers. */
int energy_terms_columns(
    const struct energy_term *terms, const void *start, const void *now, double *value);
/* Sum of the terms with their signs, now minus start [J]. */
double energy_terms_balance(const struct energy_term *terms, const void *start, const void *now);
/* The entry "energy": terms at the start and now, those that are known, and the balance; NaN unless
 * `balanced`. */
void energy_terms_report(const struct energy_term *terms, struct report *r, const void *start,
    const void *now, bool measured, bool balanced);

#endif
