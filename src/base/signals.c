#include "signals.h"

#include <signal.h>
#include <string.h>

#include "comm/fail.h"

static volatile sig_atomic_t seen;
static bool installed;
static int n_hold; /* calls of signals_hold that signals_pass has not ended */

static void note(int number)
{
    seen = number;
}

static const int wanted[] = {SIGTERM, SIGINT, SIGUSR1};
enum { N_WANTED = sizeof wanted / sizeof *wanted };

void signals_keep(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = note;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < N_WANTED; i++)
        if (sigaction(wanted[i], &action, NULL) != 0)
            fail_stop(EXIT_IO, "sigaction(%d) fails", wanted[i]);
}

static void mask_wanted(int how)
{
    sigset_t set;
    sigemptyset(&set);
    for (int i = 0; i < N_WANTED; i++) sigaddset(&set, wanted[i]);
    if (sigprocmask(how, &set, NULL) != 0) fail_stop(EXIT_IO, "sigprocmask fails");
}

void signals_hold(void)
{
    signal(SIGPIPE, SIG_IGN);
    if (n_hold++ == 0) mask_wanted(SIG_BLOCK);
}

void signals_pass(void)
{
    if (--n_hold > 0) return;
    if (installed) signals_keep();
    mask_wanted(SIG_UNBLOCK);
}

bool signals_wait(void)
{
    sigset_t set;
    sigemptyset(&set);
    if (sigpending(&set) != 0) return false;
    bool any = false;
    for (int i = 0; i < N_WANTED; i++) any |= sigismember(&set, wanted[i]) == 1;
    return any;
}

void signals_obey(void)
{
    sigset_t waiting, one;
    if (sigpending(&waiting) != 0) sigemptyset(&waiting);
    for (int i = 0; i < N_WANTED; i++) {
        if (wanted[i] != seen && sigismember(&waiting, wanted[i]) != 1) continue;
        signal(wanted[i], SIG_DFL);
        raise(wanted[i]);
        sigemptyset(&one);
        sigaddset(&one, wanted[i]);
        sigprocmask(SIG_UNBLOCK, &one, NULL);
    }
}

void signals_install(void)
{
    seen = 0;
    installed = true;
    signals_keep();
}

int signals_seen(void)
{
    return seen;
}
