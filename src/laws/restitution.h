/* Coefficient of restitution e and damping ratio z of a binary impact: one function for the linear
 * and the Hertz law, independent of speed (physics: y = delta^1.25 maps damped Hertz onto the
 * linear oscillator; Antypov and Elliott 2011, EPL 94, 50004). Pure functions, host only.
 * `attraction`: the contact ends at zero overlap and the dashpot may pull before; else it ends when
 * the force falls to zero. */
#ifndef DEMOCLES_RESTITUTION_H
#define DEMOCLES_RESTITUTION_H

#include <stdbool.h>

/* e [1] for z >= 0 [1]. With attraction and z >= 1 the bodies never part: 0. */
double restitution_of_damping(double z, bool attraction);

/* z [1] for 0 < e <= 1 [1]. */
double restitution_damping(double e, bool attraction);

#endif
