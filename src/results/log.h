/* What the run says: to stdout and DIR/log.txt, from rank 0 alone, and the progress line. Errors
 * and warnings go to stderr through fail.h. One log per process. Not collective; calls on other
 * ranks do nothing. */
#ifndef DEMOCLES_LOG_H
#define DEMOCLES_LOG_H

#include "comm/comm.h"

struct log;

/* What log.txt begins with: a version follows. */
#define LOG_FIRST_LINE "democles "
/* Whether DIR/log.txt is the log of a run, not a link and not somebody else's file. */
bool log_is_ours(const char *dir);

/* `quiet`: nothing to stdout (log.txt gets everything). Text before log_attach is kept and goes
 * into log.txt too. */
struct log *log_create(const struct comm *comm, bool quiet);
/* From now on also to DIR/log.txt, which is made, or for a continued run (`append`) continued; a
 * link of that name is not followed. Errors that end the program go into it, too, from whichever
 * rank they come. `head` is for the file alone, before all else. Failure: EXIT_IO. */
void log_attach(struct log *log, const char *dir, bool append, const char *head);
void log_free(struct log *log); /* NULL is fine */

/* One or more lines, printf. A newline is added at the end. */
void log_print(struct log *log, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* What the run's elements are called in its rates: "particle", "cell"; not copied. */
void log_element(struct log *log, const char *name);
/* "12.3 million particle updates/s": elements times steps per second of wall time. Owned by the
 * caller. */
char *log_rate(const struct log *log, double per_second);
/* fail_warn, and into log.txt. */
void log_warn(struct log *log, const char *format, ...) __attribute__((format(printf, 2, 3)));

struct log_progress {
    int64_t step, n_step; /* now, and at the end; for the run as a whole */
    double time, end;     /* simulated [s] */
    int64_t n_element;    /* over all ranks */
};
/* Progress; may be called at every step (it reads a clock). Terminal: one line, rewritten five
 * times a second. File or batch log: a line each 30 s and at each tenth of the run. The first call
 * starts the clock. */
void log_progress(struct log *log, const struct log_progress *progress);
/* Ends the progress line with the last state, without a rate (the rate of the whole run follows
 * elsewhere); later output starts on a fresh line. */
void log_progress_end(struct log *log, const struct log_progress *progress);

/* 1.2 s, 3 min 05 s, 2 h 07 min. Returns `text`. */
enum { LOG_DURATION_SIZE = 32 };
char *log_duration(double seconds, char text[LOG_DURATION_SIZE]);

#endif
