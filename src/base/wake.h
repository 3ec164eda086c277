/* Quick wake-up of a thread that waits while others compute on its core. */
#ifndef DEMOCLES_WAKE_H
#define DEMOCLES_WAKE_H

/* Linux may keep a thread that has woken up waiting until the slice of the one that computes is
 * over, 3 ms, and may end a sleep 50 us late to save wake-ups: both are longer than a step. This
 * asks for short slices (understood from Linux 6.12 on) and punctual sleeps for the calling thread;
 * threads that it creates later would have them too. In vain where the system does not know or
 * allow it. */
void wake_at_once(void);

#endif
