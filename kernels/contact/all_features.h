/* The features of the contact laws, for the host: the driver's struct law_features, the build
 * options of the force kernels, `features` in run.json and in `check` follow from the rows; the
 * tests' lists of flags from the lines below them (tests/meson.build reads this file).
 *
 * Kernels do not include this: their flags are build options. Host code that has named no flag of
 * its own gets all of them. */
#ifndef DEMOCLES_ALL_FEATURES_H
#define DEMOCLES_ALL_FEATURES_H

/* Member, flag WITH_..., whether contacts of the material c (struct contact_material) need it. */
#define CONTACT_FEATURES(X)                                                                        \
    X(linear, LINEAR, !(c.law & CONTACT_HERTZ))                                                    \
    X(hertz, HERTZ, c.law &CONTACT_HERTZ)                                                          \
    X(no_attraction, NO_ATTRACTION, c.law &CONTACT_NO_ATTRACTION)                                  \
    X(tangential, TANGENTIAL, c.mu > 0)                                                            \
    X(tangential_damping, TANGENTIAL_DAMPING, c.mu > 0 && c.gamma_t > 0)                           \
    X(rolling_cdt, ROLLING_CDT, c.mu_r > 0 && !(c.k_r > 0))                                        \
    X(rolling_epsd, ROLLING_EPSD, c.k_r > 0)                                                       \
    X(binding, BINDING, c.f_b > 0)                                                                 \
    X(jkr, JKR, c.jkr > 0)                                                                         \
    X(whole_slip, WHOLE_SLIP, c.mu > 0 && (c.law & CONTACT_OTHER_SLIP))                            \
    X(radius_lever, RADIUS_LEVER, c.mu > 0 && (c.law & CONTACT_RADIUS_LEVER))                      \
    X(no_rescale, NO_RESCALE, c.mu > 0 && (c.law & CONTACT_NO_RESCALE))                            \
    X(cap_magnitude, CAP_MAGNITUDE, c.mu > 0 && (c.law & CONTACT_CAP_MAGNITUDE))

#ifndef WITH_LINEAR
#define WITH_LINEAR 1
#define WITH_HERTZ 1
#define WITH_NO_ATTRACTION 1
#define WITH_TANGENTIAL 1
#define WITH_TANGENTIAL_DAMPING 1
#define WITH_ROLLING_CDT 1
#define WITH_ROLLING_EPSD 1
#define WITH_BINDING 1
#define WITH_JKR 1
#define WITH_WHOLE_SLIP 1
#define WITH_RADIUS_LEVER 1
#define WITH_NO_RESCALE 1
#define WITH_CAP_MAGNITUDE 1
#define WITH_ENERGY 1 /* no feature of a law: losses are accounted for */
#endif

#endif
