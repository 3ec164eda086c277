#include "energy_terms.h"

#include <math.h>

double *energy_terms_at(const struct energy_term *term, void *account)
{
    return (double *)(void *)((char *)account + term->at);
}

double energy_terms_value(const struct energy_term *term, const void *account)
{
    return *(const double *)(const void *)((const char *)account + term->at);
}

/* Terms that count negative last: the order of additions is part of the result. */
static double sum(const struct energy_term *terms, const void *account)
{
    double total = energy_terms_value(&terms[0], account);
    for (const struct energy_term *t = terms + 1; t->name; t++)
        if (t->sign > 0) total += energy_terms_value(t, account);
    for (const struct energy_term *t = terms + 1; t->name; t++)
        if (t->sign < 0) total -= energy_terms_value(t, account);
    return total;
}

double energy_terms_balance(const struct energy_term *terms, const void *start, const void *now)
{
    return sum(terms, now) - sum(terms, start);
}

int energy_terms_columns(
    const struct energy_term *terms, const void *start, const void *now, double *value)
{
    int n = 0;
    for (; terms[n].name; n++) value[n] = energy_terms_value(&terms[n], now);
    value[n++] = energy_terms_balance(terms, start, now);
    return n;
}

void energy_terms_report(const struct energy_term *terms, struct report *r, const void *start,
    const void *now, bool measured, bool balanced)
{
    static const char *const name[] = {"start", "end"};
    report_begin(r, "energy");
    for (int k = 0; k < 2; k++) {
        report_begin(r, name[k]);
        for (const struct energy_term *t = terms; t->name; t++)
            if (measured || t->known == ENERGY_TERMS_ALWAYS)
                report_number(r, t->name, energy_terms_value(t, k ? now : start));
        report_end(r);
    }
    report_number(
        r, "balance_error", balanced ? energy_terms_balance(terms, start, now) : (double)NAN);
    report_end(r);
}
