/* What a contact has taken from the energy since it was last collected: planes of double
 * [LEDGER_WIDTH][capacity], one number per contact each [J]. Host and device share the numbers;
 * they exist only WITH_ENERGY. */
#ifndef DEMOCLES_LEDGER_H
#define DEMOCLES_LEDGER_H

#define LEDGER_NORMAL 0     /* dashpot along the normal */
#define LEDGER_TANGENTIAL 1 /* dashpot across it */
#define LEDGER_SLIDING 2
#define LEDGER_ROLLING 3 /* rolling and twisting */
#define LEDGER_BONDS 4   /* bonds that broke */
#define LEDGER_ELASTIC 5 /* no loss: what the springs hold at this step; not cumulative */
#define LEDGER_WORK 6    /* what a moving wall has given */
#define LEDGER_WIDTH 7

#endif
