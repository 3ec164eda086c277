#include "units.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Exponents of metre, kilogram, second, radian. */
struct dimension {
    int m, kg, s, rad;
};

static const struct kind_row {
    const char *name, *si;
    struct dimension dim;
} KINDS[UNIT_KINDS] = {
    [UNIT_NONE] = {"plain number", "", {0, 0, 0, 0}},
    [UNIT_LENGTH] = {"length", "m", {1, 0, 0, 0}},
    [UNIT_TIME] = {"time", "s", {0, 0, 1, 0}},
    [UNIT_MASS] = {"mass", "kg", {0, 1, 0, 0}},
    [UNIT_FORCE] = {"force", "N", {1, 1, -2, 0}},
    [UNIT_STIFFNESS] = {"stiffness", "N/m", {0, 1, -2, 0}},
    [UNIT_PRESSURE] = {"pressure", "Pa", {-1, 1, -2, 0}},
    [UNIT_DENSITY] = {"density", "kg/m3", {-3, 1, 0, 0}},
    [UNIT_VELOCITY] = {"velocity", "m/s", {1, 0, -1, 0}},
    [UNIT_ACCELERATION] = {"acceleration", "m/s2", {1, 0, -2, 0}},
    [UNIT_ANGLE] = {"angle", "rad", {0, 0, 0, 1}},
    [UNIT_ANGULAR_VELOCITY] = {"angular velocity", "rad/s", {0, 0, -1, 1}},
    [UNIT_FREQUENCY] = {"frequency", "1/s", {0, 0, -1, 0}},
    [UNIT_ENERGY] = {"energy", "J", {2, 1, -2, 0}},
    [UNIT_AREA] = {"area", "m2", {2, 0, 0, 0}},
    [UNIT_VOLUME] = {"volume", "m3", {3, 0, 0, 0}},
    [UNIT_POWER] = {"power", "W", {2, 1, -3, 0}},
    [UNIT_DAMPING] = {"damping coefficient", "N s/m", {0, 1, -1, 0}},
    [UNIT_FRACTURE] = {"energy per area", "J/m2", {0, 1, -2, 0}},
};

/* A symbol is worth factor * 10^exponent of its SI unit. `prefixed`: k, m, u, ... may stand before
 * it. */
static const struct symbol_row {
    const char *symbol;
    double factor;
    int exponent;
    bool prefixed;
    struct dimension dim;
} SYMBOLS[] = {
    {"1", 1, 0, false, {0, 0, 0, 0}},
    {"%", 1, -2, false, {0, 0, 0, 0}},
    {"m", 1, 0, true, {1, 0, 0, 0}},
    {"g", 1, -3, true, {0, 1, 0, 0}},
    {"t", 1, 3, false, {0, 1, 0, 0}},
    {"s", 1, 0, true, {0, 0, 1, 0}},
    {"min", 60, 0, false, {0, 0, 1, 0}},
    {"h", 3600, 0, false, {0, 0, 1, 0}},
    {"N", 1, 0, true, {1, 1, -2, 0}},
    {"Pa", 1, 0, true, {-1, 1, -2, 0}},
    {"bar", 1, 5, true, {-1, 1, -2, 0}},
    {"J", 1, 0, true, {2, 1, -2, 0}},
    {"W", 1, 0, true, {2, 1, -3, 0}},
    {"Hz", 1, 0, true, {0, 0, -1, 0}},
    {"l", 1, -3, true, {3, 0, 0, 0}},
    {"L", 1, -3, true, {3, 0, 0, 0}},
    {"rad", 1, 0, true, {0, 0, 0, 1}},
    {"deg", 3.14159265358979323846 / 180, 0, false, {0, 0, 0, 1}},
    {"\xc2\xb0", 3.14159265358979323846 / 180, 0, false, {0, 0, 0, 1}}, /* degree sign */
    {"rpm", 3.14159265358979323846 / 30, 0, false, {0, 0, -1, 1}},
};

static const struct prefix_row {
    const char *prefix;
    int exponent;
} PREFIXES[] = {
    {"T", 12}, {"G", 9}, {"M", 6}, {"k", 3}, {"d", -1}, {"c", -2}, {"m", -3}, {"u", -6},
    {"\xc2\xb5", -6}, {"\xce\xbc", -6}, {"n", -9},
    {"p", -12}, /* micro: u, the sign U+00B5, the Greek letter U+03BC */
};

#define COUNT(array) (sizeof(array) / sizeof *(array))

struct unit {
    double factor;
    int exponent;
    struct dimension dim;
};

const char *units_name(enum unit_kind kind)
{
    return KINDS[kind].name;
}

const char *units_si(enum unit_kind kind)
{
    return KINDS[kind].si;
}

size_t units_number_length(const char *text)
{
    const char *p = text;
    if (*p == '+' || *p == '-') p++;
    size_t digits = 0;
    for (; isdigit((unsigned char)*p); p++) digits++;
    if (*p == '.') p++;
    for (; isdigit((unsigned char)*p); p++) digits++;
    if (digits == 0) return 0;
    if (*p == 'e' || *p == 'E') {
        const char *q = p + 1;
        if (*q == '+' || *q == '-') q++;
        if (isdigit((unsigned char)*q)) {
            while (isdigit((unsigned char)*q)) q++;
            p = q;
        }
    }
    return (size_t)(p - text);
}

/* The row of a bare or prefixed symbol of n bytes; *exponent is the prefix's. "min" is a minute
 * before it is a milli-inch of anything. */
static const struct symbol_row *find_symbol(const char *name, size_t n, int *exponent)
{
    *exponent = 0;
    for (size_t i = 0; i < COUNT(SYMBOLS); i++)
        if (strlen(SYMBOLS[i].symbol) == n && memcmp(SYMBOLS[i].symbol, name, n) == 0)
            return &SYMBOLS[i];
    for (size_t k = 0; k < COUNT(PREFIXES); k++) {
        size_t length = strlen(PREFIXES[k].prefix);
        if (length >= n || memcmp(PREFIXES[k].prefix, name, length) != 0) continue;
        for (size_t i = 0; i < COUNT(SYMBOLS); i++) {
            const struct symbol_row *row = &SYMBOLS[i];
            if (!row->prefixed || strlen(row->symbol) != n - length ||
                memcmp(row->symbol, name + length, n - length) != 0)
                continue;
            *exponent = PREFIXES[k].exponent;
            return row;
        }
    }
    return NULL;
}

/* One factor "cm3", "s^-2", "1" at *text, multiplied into `unit` (sign +1) or divided out of it
 * (-1). Moves *text behind it. */
static bool parse_factor(const char **text, int sign, struct unit *unit)
{
    const char *start = *text, *p = start;
    if (*p == '1') p++;
    else
        while (*p && !strchr(" */^+-0123456789", *p)) p++;
    int exponent;
    const struct symbol_row *row =
        p > start ? find_symbol(start, (size_t)(p - start), &exponent) : NULL;
    if (!row) return false;
    if (*start == '1' && *p && !strchr(" */", *p)) return false;
    int power = 1;
    if (*p == '^' || isdigit((unsigned char)*p) || (*p == '-' && isdigit((unsigned char)p[1]))) {
        if (*p == '^') p++;
        char *end;
        long value = strtol(p, &end, 10);
        if (end == p || value < -9 || value > 9 || value == 0) return false;
        power = (int)value;
        p = end;
    }
    power *= sign;
    for (int k = 0; k < abs(power); k++)
        unit->factor = power > 0 ? unit->factor * row->factor : unit->factor / row->factor;
    unit->exponent += power * (row->exponent + exponent);
    unit->dim.m += power * row->dim.m;
    unit->dim.kg += power * row->dim.kg;
    unit->dim.s += power * row->dim.s;
    unit->dim.rad += power * row->dim.rad;
    *text = p;
    return true;
}

/* factor {(" " | "*") factor} {"/" factor}. A product behind a slash ("J/kg K") would be ambiguous
 * and is refused. */
static bool parse_unit(const char *text, struct unit *unit)
{
    *unit = (struct unit){.factor = 1};
    int sign = 1;
    if (!parse_factor(&text, sign, unit)) return false;
    while (*text) {
        while (*text == ' ') text++;
        if (*text == '/') sign = -1, text++;
        else if (sign < 0) return false;
        else if (*text == '*') text++;
        while (*text == ' ') text++;
        if (!parse_factor(&text, sign, unit)) return false;
    }
    return true;
}

static bool same_dimension(struct dimension a, struct dimension b)
{
    return a.m == b.m && a.kg == b.kg && a.s == b.s && a.rad == b.rad;
}

/* "a time, as in '1 s'", or "a plain number" */
static const char *expected(enum unit_kind kind, char *text, size_t size)
{
    const char *name = KINDS[kind].name;
    const char *article = strchr("aeiou", name[0]) ? "an" : "a";
    if (kind == UNIT_NONE) snprintf(text, size, "a plain number, without unit");
    else if (KINDS[kind].si[0] == '1')
        snprintf(text, size, "%s %s, as in '1 %s'", article, name, "Hz");
    else snprintf(text, size, "%s %s, as in '1 %s'", article, name, KINDS[kind].si);
    return text;
}

static bool wrong_kind(
    const char *unit_text, struct dimension dim, enum unit_kind kind, char *problem, size_t size)
{
    char want[64];
    expected(kind, want, sizeof want);
    for (int k = 1; k < UNIT_KINDS; k++)
        if (same_dimension(KINDS[k].dim, dim)) {
            const char *article = strchr("aeiou", KINDS[k].name[0]) ? "an" : "a";
            snprintf(problem, size, "'%s' is the unit of %s %s; expected %s", unit_text, article,
                KINDS[k].name, want);
            return false;
        }
    snprintf(problem, size, "'%s' is the wrong unit; expected %s", unit_text, want);
    return false;
}

/* The number text (n bytes) times 10^exponent, rounded once. */
static double scaled_number(const char *text, size_t n, int exponent)
{
    char joined[400];
    const char *e = memchr(text, 'e', n);
    if (!e) e = memchr(text, 'E', n);
    size_t mantissa = e ? (size_t)(e - text) : n;
    long own = e ? strtol(e + 1, NULL, 10) : 0;
    /* absurdly long: an ulp does not matter */
    if (mantissa > 360) return strtod(text, NULL) * pow(10, exponent);
    if (own > 100000) own = 100000;
    if (own < -100000) own = -100000;
    snprintf(joined, sizeof joined, "%.*se%ld", (int)mantissa, text, own + exponent);
    return strtod(joined, NULL);
}

bool units_parse(const char *text, enum unit_kind kind, double *value, char *problem, size_t size)
{
    char want[64];
    while (*text == ' ') text++;
    size_t n = units_number_length(text);
    const char *rest = text + n;
    while (*rest == ' ') rest++;
    size_t gap = (size_t)(rest - text) - n;
    if (n == 0 || (gap == 0 && *rest && !isalpha((unsigned char)*rest) && *rest != '%' &&
                      (unsigned char)*rest < 0x80)) {
        snprintf(problem, size, "'%s' is not a number; expected %s", text,
            expected(kind, want, sizeof want));
        return false;
    }
    struct unit unit = {.factor = 1, .dim = KINDS[kind].dim};
    if (*rest) {
        if (!parse_unit(rest, &unit)) {
            snprintf(problem, size, "unknown unit '%s'; expected %s", rest,
                expected(kind, want, sizeof want));
            return false;
        }
        if (!same_dimension(unit.dim, KINDS[kind].dim))
            return wrong_kind(rest, unit.dim, kind, problem, size);
    }
    double number = scaled_number(text, n, unit.exponent);
    if (unit.factor != 1) number *= unit.factor;
    if (!isfinite(number)) {
        snprintf(problem, size, "'%s' is too large for a double", text);
        return false;
    }
    *value = number;
    return true;
}

void units_print(double value, char *text)
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, value);
        if (strtod(text, NULL) == value) return;
    }
}
