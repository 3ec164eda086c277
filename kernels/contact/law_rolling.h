/* Rolling resistance: a moment M on i, -M on j, against the relative rolling w_r = the part of w_i
 * - w_j in the tangent plane.
 *
 * CDT   M = -L w_r/|w_r|, L = mu_r R* F_n (Ai et al. 2011, Powder Technol. 206, 269). It would
 *       chatter about zero; here it is at most what halves the relative spin of the two free bodies
 *       in one step, M = -w_r/(2 dt (1/I_i + 1/I_j)). With w_r predicted from the half step and the
 *       last kick, a moment that stops it would leave a mode of -1 per step; this one leaves 0.64.
 * EPSD  M = -k_r theta - C_r w_r, |k_r theta| <= L, with theta the rolling angle, which is carried
 *       and cut like the friction spring (law_slider.h); the whole of M is kept within L.
 * w_r is that of t^{n+1}, predicted from the moments of the last step (law_kinematics.h). A pair
 * with k_r = 0 takes CDT; mu_r = 0 gives no moment. */
#ifndef DEMOCLES_LAW_ROLLING_H
#define DEMOCLES_LAW_ROLLING_H

#include "law_normal.h"
#include "law_slider.h"

LAW real rolling_cap(real force_n, struct contact_parameters p)
{
    return p.roll_limit * r_max(force_n, (real)0);
}

LAW vec3 rolling_cdt(vec3 w_r, real cap, struct contact_parameters p)
{
    real w = r_sqrt(v3_dot(w_r, w_r));
    real slope = cap < p.roll_stop * w ? cap / w : p.roll_stop;
    slope = cap > 0 ? slope : (real)0;
    return v3_scale(-slope, w_r);
}

/* trial: theta carried to t^{n+1}, zero where there is no contact. */
LAW struct slider rolling_epsd(vec3 trial, vec3 before, vec3 w_r_end, real cap,
    struct normal_factors f, struct contact_parameters p)
{
    return slider_slip(
        trial, before, p.k_r * f.spring, 1, v3_scale(-(p.c_r * f.damper), w_r_end), cap);
}

#endif
