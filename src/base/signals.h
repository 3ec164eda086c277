/* Requests to stop, from outside: SIGTERM, SIGINT and SIGUSR1 only leave a mark; the run looks at
 * it now and then, agrees with the other ranks, writes a frame and ends with exit code 75. Knows no
 * MPI: one rank alone may have been signalled. */
#ifndef DEMOCLES_SIGNALS_H
#define DEMOCLES_SIGNALS_H

#include <stdbool.h>

/* Installs the handlers, for good and for every thread. Interrupted system calls are restarted
 * (SA_RESTART), so that file and MPI calls of code which does not expect EINTR go on; nothing but
 * sleeps returns early. Call it after MPI_Init, which has handlers of its own. */
void signals_install(void);

/* Installs them anew where somebody else has taken the signals since; what has come in stays.
 * pocl's compiler does: LLVM takes SIGUSR1 for itself, and answers it with nothing, with the first
 * kernel that it compiles or loads. */
void signals_keep(void);

/* The last of the three signals that has come in since signals_install, or 0. */
int signals_seen(void);

/* The three signals wait from here on until signals_pass, and threads that begin in between never
 * take them; calls may be nested. The set-up is held as a whole, so that a request to stop means
 * the same whenever it comes: a frame after the first step, and exit code 75. So are compilers:
 * LLVM's handlers would give up a build that is under way (SIGINT, SIGTERM) or swallow the signal
 * (SIGUSR1); where ours have been installed signals_pass installs them anew. METIS has handlers of
 * its own as well (partition/graph.c). A pipe that closes is an error of write from here on and
 * kills nobody: SIGPIPE is ignored for good. */
void signals_hold(void);
void signals_pass(void);
/* Whether one of them waits. */
bool signals_wait(void);
/* Ends the program by the signal that waits or has been seen, if there is one, as if nobody had
 * ever taken it: for waits without end before anything is written. */
void signals_obey(void);

#endif
