/* The scene: everything a user asked for, in SI units, checked and complete with defaults.
 *
 * A scene is read once, by every rank alike, and is constant afterwards. It knows no device, no MPI
 * and no element: generate.c turns it into elements and walls, features.c into the kernels that it
 * needs. One typed table of keys (scene_keys.c) drives the parser, its errors, the defaults,
 * `explain` and `check --resolved`. */
#ifndef DEMOCLES_SCENE_H
#define DEMOCLES_SCENE_H

#include <stdbool.h>
#include <stddef.h>

enum method { METHOD_PARTICLES, METHOD_LATTICE };
/* in the order of enum lattice_scheme */
enum scheme { SCHEME_LEAPFROG, SCHEME_RK4, SCHEME_RKN4, SCHEME_PEFRL, SCHEME_VEFRL };
enum precision { PRECISION_DEFAULT, PRECISION_DOUBLE, PRECISION_MIXED, PRECISION_SINGLE };

/* More steps than this are no run but a mistake; all of them are whole numbers in double
 * precision. */
#define SCENE_STEPS_MOST 1e15

struct scene_time {
    double end;          /* [s] */
    double step;         /* [s]; 0: auto */
    double safety;       /* [1] fraction of the critical time step that `auto` takes */
    enum scheme scheme;  /* particles: leapfrog */
    bool allow_unstable; /* run although the step is over its limit */
};

enum damping_by { DAMPING_MASS, DAMPING_LINK };
enum plane { PLANE_STRESS, PLANE_STRAIN };
/* BREAK_* of kernels/lattice/law_break.h, then that of law_principal.h */
enum criterion { CRITERION_SUM, CRITERION_LARGEST, CRITERION_STRESS, CRITERION_PRINCIPAL };
/* Which link of a cell that fails goes: the one pulled most, or by lot. */
enum crack_path { PATH_GRID, PATH_DRAWN };
struct material {
    char *name;
    double density; /* [kg/m3] */
    double young;   /* [Pa]; 0: not given */
    double poisson; /* [1] */
    /* lattice only */
    /* alpha [1/s]: a = -alpha v; follows from `ratio` where that is given */
    double mass_damping;
    double link_damping;              /* eta [s]: links pull with k (gap + eta rate); likewise */
    double damping_ratio, damping_at; /* zeta [1] at a frequency [1/s]; ratio 0: not given */
    enum damping_by damping_by;       /* what makes up that ratio */
    bool has_strength;
    /* what the face of a cell bears [Pa]; infinity: anything; tension 0: from `energy` */
    double tension, shear;
    double energy;    /* of fracture [J/m2] */
    enum plane plane; /* state that `energy` is turned into a tension for */
    enum criterion criterion;
    enum crack_path crack_path; /* criterion principal only */
};

enum normal_law { NORMAL_LINEAR, NORMAL_HERTZ };
/* Friction as other codes have it (docs/conventions.md); the first of each is the default. */
enum slip_rule { SLIP_SPRING, SLIP_WHOLE, SLIP_UNDAMPED };
enum lever { LEVER_CONTACT, LEVER_RADIUS };
enum friction_cap { CAP_COMPRESSION, CAP_MAGNITUDE };
enum damping_mass { DAMPING_MASS_SURFACE, DAMPING_MASS_CENTRE };
enum rolling_model { ROLLING_NONE, ROLLING_CDT, ROLLING_EPSD };

/* Contact of two materials, unordered pair. A part that the scene leaves out has its `has_` false
 * and costs nothing. */
struct contact {
    int between[2]; /* materials, indices into scene.material */
    enum normal_law normal_law;
    double stiffness;     /* k_n [N/m], linear law only */
    double damping_ratio; /* z_n [1]; from `restitution` where that is given */
    double restitution;   /* e [1] as given, else negative */
    bool attraction;      /* keep the attractive tail of the dashpot (default true) */
    bool has_tangential;
    /* k_t/k_n [1], linear law; Hertz takes Mindlin's where this is negative (not given) */
    double stiffness_ratio;
    double tangential_damping; /* z_t [1] */
    enum damping_mass damping_mass;
    double damping_factor; /* gamma_t/gamma_n [1] in place of z_t, else negative */
    double friction;       /* mu [1] */
    enum slip_rule slip;
    enum lever lever;
    enum friction_cap cap;
    bool rescale; /* Hertz: no cycle of loading gives energy (default true) */
    enum rolling_model rolling;
    double rolling_friction;  /* mu_r [1] */
    double rolling_damping;   /* eta_r [1], EPSD */
    double rolling_stiffness; /* k_r/(k_n (mu_r R*)^2) [1], EPSD, default 2.25 */
    double binding_force;     /* F_b [N]; 0: none */
    double adhesion_work;     /* w [J/m2], JKR; 0: none */
};

enum region_kind { REGION_ALL, REGION_BOX, REGION_CYLINDER, REGION_SPHERE, REGION_STL };
struct region {
    enum region_kind kind;
    double min[3], max[3];         /* box [m] */
    double from[3], to[3], radius; /* cylinder [m]; radius also of a sphere */
    double center[3];              /* sphere [m] */
    char *stl;                     /* closed surface, path as usable from the working directory */
    double scale;                  /* metres per unit of the file */
};

struct element_group {
    char *name;
    int material;
    double diameter[2]; /* smallest, largest [m]; uniform in between; equal: one size */
    bool from_file;
    char *file;           /* CSV x,y,z,radius[,vx,vy,vz,wx,wy,wz] */
    struct region region; /* fill */
    long count;           /* number of elements; 0: as many as fit */
    /* [1]: lattice of spacing (1+jitter) d, each element displaced by up to jitter d/2 per axis */
    double jitter;
    unsigned long seed;
    double velocity[3];         /* [m/s] */
    double angular_velocity[3]; /* [rad/s] */
    int line;                   /* of the scene file, for later errors */
};

/* A solid that is cut into cells. */
struct body {
    char *name;
    int material;
    double cell; /* edge h [m] */
    struct region shape;
    struct region *minus; /* [n_minus] holes */
    int n_minus;
    struct region *crack; /* [n_crack] links whose middle is inside are not there */
    int n_crack;
    double velocity[3];         /* at time 0 [m/s] ... */
    double angular_velocity[3]; /* ... and about the middle of its cells [rad/s] */
    int line, column;           /* of its entry in the scene file */
};

enum history_kind { HISTORY_CONSTANT, HISTORY_RAMP, HISTORY_SINE, HISTORY_TABLE };
/* Factor of a load over time, see history.h. */
struct history {
    enum history_kind kind;
    double ramp;             /* [s] */
    double frequency, phase; /* [1/s], [rad] */
    double (*point)[2];      /* [n_point] time [s], factor [1]; times ascend */
    int n_point;
};

enum boundary_kind {
    BOUNDARY_FIX,
    BOUNDARY_FORCE,
    BOUNDARY_PRESSURE,
    BOUNDARY_ACCELERATION,
    BOUNDARY_VELOCITY,
    BOUNDARY_ANGULAR_VELOCITY
};
struct boundary {
    struct region where; /* REGION_ALL: anywhere */
    int body;            /* only cells of this body; -1: of any */
    enum boundary_kind kind;
    bool fix[6];     /* x, y, z, rx, ry, rz */
    double value[3]; /* force [N], acceleration [m/s2], velocity [m/s], [rad/s]; infinity: free */
    double pressure; /* [Pa] */
    struct history history;
    int line, column;
};

enum lattice_law { LAW_ISOTROPIC, LAW_REFERENCE }; /* in the order of enum link_set */
enum rotation { ROTATION_FINITE, ROTATION_SMALL };
enum curved_surface { CURVED_CUT, CURVED_STEPPED };
enum stress_form { STRESS_AVERAGE, STRESS_EXTRAPOLATED };
struct lattice_method {
    enum lattice_law law;
    enum rotation rotation;
    enum curved_surface surface;
    enum stress_form stress; /* of cells at a surface */
    bool relax;              /* look for equilibrium, and stop there */
    double tolerance;        /* [1] of the largest load */
    long look_every;         /* steps between two looks at what is left */
};

enum surface_kind { SURFACE_PLANE, SURFACE_RECTANGLE, SURFACE_BOX, SURFACE_CYLINDER, SURFACE_STL };
struct wall {
    char *name;
    int material;
    enum surface_kind kind;
    double point[3], normal[3]; /* plane; rectangle: center, normal (a unit vector) */
    /* rectangle [m], along its two in-plane axes (see walls_axes in src/shape/walls.h) */
    double size[2];
    double min[3], max[3];         /* box: elements stay inside */
    double from[3], to[3], radius; /* cylinder */
    bool inside;                   /* cylinder: elements stay inside it */
    char *stl;
    double scale;
    double velocity[3];          /* [m/s] */
    double rotation_center[3];   /* [m] */
    double rotation_axis[3];     /* unit vector, also without rotation */
    double rotation_rate;        /* [rad/s] */
    double amplitude[3];         /* oscillation x = A sin(2 pi f t + phase) [m] */
    double frequency, phase;     /* [Hz], [rad] */
    double appear_at, remove_at; /* [s]; 0 and infinity where not given */
    int line;
};

struct domain {
    bool periodic[3];
    /* min, max were given; else the bounding box of walls and elements (grown by a margin) */
    bool has_box;
    double min[3], max[3]; /* [m]; needed for periodic directions */
    bool remove_outside;
    double start_overlap; /* [1] of the smaller radius, the most of two particles at time 0 */
};

enum partition_method { PARTITION_GEOMETRIC, PARTITION_INTERACTIONS, PARTITION_GRAPH };
enum partition_weights { WEIGHTS_INTERACTIONS, WEIGHTS_MEASURED };
/* pairs of two ranks: computed on both, or on one (kernels/particle/assign.cl) */
enum partition_boundary { CUT_PAIRS_BOTH, CUT_PAIRS_ASSIGNED };
#define PARTITION_AUTO (-1)
struct scene_partition {
    enum partition_method method;
    long every; /* steps between re-cuts; 0: never; PARTITION_AUTO: when it pays */
    /* imbalance U above which a due re-cut is made, and below which weights are not raised any
     * more */
    double threshold;
    enum partition_weights weights;
    enum partition_boundary boundary;
};

enum measure_kind {
    MEASURE_COUNT,
    MEASURE_ENERGY,
    MEASURE_MOMENTUM,
    MEASURE_WALL_FORCE,
    MEASURE_WALL_TORQUE,
    MEASURE_PROBE,
    MEASURE_STRESS_MAX,
    MEASURE_BROKEN
};
struct measure {
    char *name;
    double every; /* [s] */
    enum measure_kind kind;
    double below[3]; /* count: element centre below this coordinate; +infinity where not given */
    double above[3]; /* count: above; -infinity where not given */
    int wall;        /* wall_force, wall_torque: index into scene.wall */
    double about[3]; /* wall_torque: the point about which it is taken [m] */
    long element;    /* probe, particles: global id */
    double at[3];    /* probe, lattice: the cell whose centre is nearest [m] */
    char **field;    /* probe, lattice: [n_field] names */
    int n_field;
    int line;
};

struct output {
    double every;            /* [s]; 0: first and last frame only */
    double checkpoint_every; /* [s]; 0: frames are the checkpoints */
    char **field;            /* [n_field] names */
    int n_field;
};

/* Messages of one reading, sorted by line and column. */
struct scene_errors {
    char **text;
    int n;
};

struct scene {
    char *path; /* of the file, as given */
    char *name; /* stem of the file, or of its folder when the file is scene.yaml */
    char *title;
    enum method method;
    enum precision precision;
    struct scene_time time;
    double gravity[3]; /* [m/s2] */
    struct material *material;
    int n_material;
    struct contact *contact;
    int n_contact;
    struct element_group *group;
    int n_group;
    struct wall *wall;
    int n_wall;
    struct body *body;
    int n_body;
    struct boundary *boundary;
    int n_boundary;
    struct lattice_method lattice;
    struct domain domain;
    struct scene_partition partition;
    struct output output;
    struct measure *measure;
    int n_measure;
    /* the file's text [n_given] as it is; NULL of a scene that was read from memory */
    char *given;
    size_t n_given;
    /* the scene with all defaults, as YAML text that reads back to the same scene */
    char *resolved;
    unsigned long hash;        /* of the resolved text */
    struct scene_errors notes; /* names of an earlier release that the scene uses */
};

/* Reads and checks `path`, with `set` (n_set strings KEY=VALUE, KEY as dotted path: time.end=1s,
 * walls[1].motion.remove_at=0.2s) applied. Returns NULL when `errors` is not empty. Not collective:
 * every rank reads; each gets the same answer. */
struct scene *scene_read(
    const char *path, const char *const *set, int n_set, struct scene_errors *errors);
/* The same of a text [n]; `path` is what it is called, and its folder is what paths are relative
 * to. */
struct scene *scene_read_text(const char *path, const char *text, size_t n, const char *const *set,
    int n_set, struct scene_errors *errors);
void scene_free(struct scene *scene);

/* Mass of a sphere [kg]; radius [m]. */
double scene_mass(const struct scene *scene, int material, double radius);
void scene_errors_add(struct scene_errors *errors, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void scene_errors_free(struct scene_errors *errors);

/* The reference page of all keys, or of those below `key` ("contacts.normal"), to stdout. Returns
 * false, and names the nearest, if there is none. */
bool scene_explain(const char *key);

#endif
