/* Binding force: a bond forms at the first touch and lets the normal spring pull until it pulls
 * harder than F_b, then it breaks at once and all history of the contact is dropped; it forms again
 * at the next touch. While it holds, friction has the cap mu (F_n + F_b). The list of candidates
 * must reach F_b/k_n beyond touching. */
#ifndef DEMOCLES_LAW_BINDING_H
#define DEMOCLES_LAW_BINDING_H

#include "law_parameters.h"

/* Is the pair bonded at t^{n+1}? spring: k_n s delta [N], whether or not there is contact. */
LAW int binding_holds(int was_bonded, real delta, real spring, struct contact_parameters p)
{
    return WITH_BINDING && p.f_b > 0 && (delta > 0 || (was_bonded && spring >= -p.f_b));
}

#endif
