#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/duration.h"

static void good(void **state)
{
    static const struct {
        const char *text;
        double seconds;
    } known[] = {{"1h30m", 5400}, {"90s", 90}, {"45m", 2700}, {"3600", 3600}, {"1.5h", 5400},
        {"2d1h1m1s", 176461}, {"0", 0}, {"0.25", 0.25}, {"1d30s", 86430}};
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        double seconds = -1;
        if (!duration_parse(known[i].text, &seconds) || seconds != known[i].seconds)
            fail_msg("%s gives %g", known[i].text, seconds);
    }
}

static void bad(void **state)
{
    static const char *const wrong[] = {"", " ", "1h 30m", "h", "1x", "1h30", "30m1h", "1h1h", "-5",
        "+5", "1e3", "1e3s", "0x10", "inf", "nan", "1.2.3s", ".", ".s", "1,5h", "1hm", "5s "};
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        double seconds = -1;
        if (duration_parse(wrong[i], &seconds) || seconds != -1)
            fail_msg("`%s` gives %g", wrong[i], seconds);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(good), cmocka_unit_test(bad)};
    return cmocka_run_group_tests_name("duration", tests, NULL, NULL);
}
