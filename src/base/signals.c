#include "signals.h"

#include <signal.h>
#include <string.h>

#include "comm/fail.h"

static volatile sig_atomic_t seen;

static void note(int number)
{
    seen = number;
}

void signals_keep(void)
{
    static const int wanted[] = {SIGTERM, SIGINT, SIGUSR1};
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = note;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (sigaction(wanted[i], &action, NULL) != 0)
            fail_stop(EXIT_IO, "sigaction(%d) fails", wanted[i]);
}

static void mask_term(int how)
{
    sigset_t term;
    sigemptyset(&term);
    sigaddset(&term, SIGTERM);
    if (sigprocmask(how, &term, NULL) != 0) fail_stop(EXIT_IO, "sigprocmask fails");
}

void signals_hold(void)
{
    signal(SIGPIPE, SIG_IGN);
    mask_term(SIG_BLOCK);
}

void signals_pass(void)
{
    mask_term(SIG_UNBLOCK);
}

void signals_install(void)
{
    seen = 0;
    signals_keep();
}

int signals_seen(void)
{
    return seen;
}
