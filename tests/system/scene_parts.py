"""Parts of scenes for the tests of runs: contacts, blocks of elements, walls, meshes,
lists of elements."""
import math
import random

GLASS = {"density": 2500, "young": 5e6, "poisson": 0.25}
STEEL = {"density": 7850, "young": 2e7, "poisson": 0.3}
LINEAR = {"law": "linear", "stiffness": 1000, "damping_ratio": 0.1}
HERTZ = {"law": "hertz", "restitution": 0.6}
FRICTION = {"stiffness_ratio": 0.8, "damping_ratio": 0.1, "friction": 0.3}
EVERYTHING = [
    {"name": "energy", "energy": "all"},
    {"name": "momentum", "momentum": "all"},
    {"name": "probe", "probe": {"element": 1}},
]


def bonded_hertz():
    """A contact with every part but CDT rolling: Hertz, friction, rolling springs, bonds."""
    return {
        "normal": HERTZ,
        "tangential": {"damping_ratio": 0.2, "friction": 0.4},
        "rolling": {"model": "epsd", "friction": 0.1, "damping_ratio": 0.3},
        "binding": {"force": 2e-3},
    }


def scene(steps, dt, contact, elements, walls=(), materials=None, measure=(), observe=5, **more):
    """A scene of glass elements and steel walls with one contact law; frames at both ends,
    measures `observe` times."""
    end = steps * dt
    return {
        "title": "parallel test",
        "method": "particles",
        "time": {"end": end, "step": dt},
        "gravity": [0.3, 0.2, -9.81],
        "materials": materials or {"glass": GLASS, "steel": STEEL},
        "contacts": [
            {"between": ["glass", other], **contact}
            for other in (["glass", "steel"] if walls else ["glass"])
        ],
        "elements": [{"material": "glass", **group} for group in elements],
        "walls": [{"material": "steel", **wall} for wall in walls],
        "partition": {"every": 10, "threshold": 0},
        "measure": [
            {"every": end / observe, **m}
            for m in [
                *EVERYTHING,
                *({"name": w["name"], "wall_force": w["name"]} for w in walls),
                *measure,
            ]
        ],
        **more,
    }


def block(name, low, high, diameter, velocity=(0, 0, 0), **fill):
    """Elements in a box; diameter: a number or (min, max)."""
    size = {"min": diameter[0], "max": diameter[1]} if isinstance(diameter, tuple) else diameter
    return {
        "name": name,
        "shape": {"sphere": {"diameter": size}},
        "velocity": list(velocity),
        "fill": {
            "region": {"box": {"min": list(low), "max": list(high)}},
            "jitter": 0.05,
            "seed": 3,
            **fill,
        },
    }


def box(name, low, high, **motion):
    return {
        "name": name,
        "surface": {"box": {"min": list(low), "max": list(high)}},
        **({"motion": motion} if motion else {}),
    }


def stl(name, triangles):
    """ASCII STL of [(a, b, c), ...] in metres."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex %.17g %.17g %.17g\n" % v for v in t)
        + "endloop\nendfacet\n"
        for t in triangles
    )
    return f"solid {name}\n{facets}endsolid {name}\n"


def drum_stl(radius, length, sides):
    """A prism along y, closed: for a drum turning about y."""
    ring = [
        (radius * math.cos(2 * math.pi * k / sides), radius * math.sin(2 * math.pi * k / sides))
        for k in range(sides)
    ]
    out = []
    for (ax, az), (bx, bz) in zip(ring, ring[1:] + ring[:1]):
        a0, a1, b0, b1 = (ax, 0, az), (ax, length, az), (bx, 0, bz), (bx, length, bz)
        out += [(a0, b0, b1), (a0, b1, a1), ((0, 0, 0), b0, a0), ((0, length, 0), a1, b1)]
    return stl("drum", out)


def sheet_stl(low, high, n, height):
    """A wavy sheet of 2 n^2 triangles over a square, height(x, y)."""
    step = (high - low) / n
    at = [
        [
            (low + i * step, low + j * step, height(low + i * step, low + j * step))
            for j in range(n + 1)
        ]
        for i in range(n + 1)
    ]
    return stl(
        "sheet",
        [
            t
            for i in range(n)
            for j in range(n)
            for t in (
                (at[i][j], at[i + 1][j], at[i + 1][j + 1]),
                (at[i][j], at[i + 1][j + 1], at[i][j + 1]),
            )
        ],
    )


def gas_csv(n, size, radius, speed, seed=5):
    """n spheres without overlap in a periodic cube (0..size each axis), some across its faces,
    random velocities and spins."""
    rng, points = random.Random(seed), []
    while len(points) < n:
        p = [rng.uniform(0, s) for s in size]
        apart = (
            math.sqrt(sum(min(abs(a - b), s - abs(a - b)) ** 2 for a, b, s in zip(p, q, size)))
            for q in points
        )
        if all(d > 2.05 * radius for d in apart):
            points.append(p)
    rows = [
        p
        + [radius]
        + [rng.gauss(0, speed) for _ in range(3)]
        + [rng.gauss(0, speed / radius) for _ in range(3)]
        for p in points
    ]
    return "x,y,z,radius,vx,vy,vz,wx,wy,wz\n" + "".join(
        ",".join("%.17g" % value for value in row) + "\n" for row in rows
    )


def touching_csv(n, spacing, radii, origin, drift, seed=7):
    """Spheres on a lattice n[0] x n[1] x n[2], radii in turn; with a spacing below the diameter
    they touch at the start. Drift, random velocities and spins pull contacts apart and roll
    them."""
    rng, rows = random.Random(seed), "x,y,z,radius,vx,vy,vz,wx,wy,wz\n"
    for number, cell in enumerate(
        (i, j, k) for i in range(n[0]) for j in range(n[1]) for k in range(n[2])
    ):
        values = [o + spacing * c for o, c in zip(origin, cell)] + [radii[number % len(radii)]]
        values += [d + rng.gauss(0, 2) for d in drift] + [rng.gauss(0, 300) for _ in range(3)]
        rows += ",".join("%.17g" % value for value in values) + "\n"
    return rows


def shutters(dt, steps):
    """Plates far away that come and go: each makes the lists anew."""
    return [
        {
            "name": f"shutter{step}",
            "surface": {
                "rectangle": {"center": [0, 0, -1], "normal": [0, 0, 1], "size": [0.01, 0.01]}
            },
            "motion": {"remove_at" if step % 2 else "appear_at": step * dt},
        }
        for step in steps
    ]
