/* Requests to stop, from outside: SIGTERM, SIGINT and SIGUSR1 only leave a mark; the run looks at
 * it now and then, agrees with the other ranks, writes a frame and ends with exit code 75. Knows no
 * MPI: one rank alone may have been signalled. */
#ifndef DEMOCLES_SIGNALS_H
#define DEMOCLES_SIGNALS_H

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

/* At the start. A pipe that closes is an error of write from here on and kills nobody: SIGPIPE is
 * ignored.
 * SIGTERM waits from here on until signals_pass, and threads that begin in between never take it:
 * METIS has a handler of its own while it works, which only the thread that called it survives
 * (partition/graph.c). */
void signals_hold(void);
void signals_pass(void);

#endif
