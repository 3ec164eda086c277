/* What a step tells the host, an int each, set to 1 by whoever sees it first. */
#ifndef DEMOCLES_FLAGS_H
#define DEMOCLES_FLAGS_H

#define FLAG_STALE 0 /* some element has used up the room that the lists gave it */
#define FLAG_LOST 1  /* some number is NaN or beyond measure */
#define FLAG_N 2

#endif
