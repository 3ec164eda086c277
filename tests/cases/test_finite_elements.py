#!/usr/bin/python3
"""A plate with a corner force, at rest, against finite elements: the lattice's deflection of the
corner tends to that of CalculiX (`ccx`) on the same plate. Argument: democles. Skipped (77) where
there is no ccx.

Both solve one problem. Steel, T = 20 mm thick, 6 T square, a force across spread evenly over the
volume of a corner, T x T through the thickness. Held is the volume x >= 5.5 T, 1.5 T <= y <= 4.5 T:
the middle half of an edge, half a thickness deep. The lattice's clamp stands at the centres of the
fixed cells, so with an odd number of cells in T its faces, at odd multiples of T/2, pass through
centres in every lattice, while the faces of the plate and of the loaded corner are faces of cells.
With 2, 4, 8 cells it would stand elsewhere in each, by a share of a cell.

The order to expect is that of the clamp's singularity: around its upright edges displacement goes
with r^s, sin(1.5 pi s) = s/(3 - 4 nu) for 270 degrees of material in plane strain (Williams 1952,
J. Appl. Mech. 19, 526), s = 0.595 here, and the error of a load's own deflection with h^(2 s) (of
finite elements: Strang, Fix 1973, An Analysis of the Finite Element Method, ch. 8). s > 1/2 below
360 degrees, so the order is above 1.

Finite elements: bricks with 20 nodes, reduced integration (C3D20R), T/2 wide, and halved towards
the edges of the clamp. Checked once, at 1 kN: halved 3, 4, 5, 6 times in the plane 39.125, 39.165,
39.183, 39.190 um; 5 times in the plane and 2, 3, 4 times across the thickness 39.183, 39.186,
39.187 um; 5 times, and T/4 wide elsewhere, 39.183 um. So 5 and 2 are within 0.05 % of the limit."""
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy

YOUNG, NU, DENSITY = 210e9, 0.3, 7900  # [Pa], [1], [kg/m3]
T, SIDE, FORCE = 0.02, 6, 1e3  # thickness [m], side [T], force downwards [N]
CLAMP = (
    numpy.array([[5.5, 1.5, 0], [SIDE, 4.5, 1]]) * T
)  # lowest and highest corner of what is held [m]
LAYERS = (3, 5, 9)  # cells through the thickness
IN_PLANE, ACROSS = 5, 2  # how often elements are halved towards the clamp's edges
POWER = 2 * 0.595  # of the error in the size of cells, see above
BOUND, ORDER, LIMIT = (
    0.02,
    1,
    0.005,
)  # largest error of the finest lattice, lowest order, largest error of the limit

# Nodes of a brick in half edges: its corners, below and then above,
# and the middles of the edges between these.
CORNERS = numpy.array(
    [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]]
)
EDGES = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
]
BRICK = numpy.vstack([CORNERS, [(CORNERS[a] + CORNERS[b]) // 2 for a, b in EDGES]])


def lines(length, edges, halved):
    """Planes [m] between elements along one axis, from 0 to length [T]: every T/2,
    and at T/2, T/4, ... from these edges [T]."""
    unit = 2**halved
    at = set(range(0, length * unit + 1, unit // 2))
    at.update(
        round(edge * unit) + sign * (unit >> k)
        for edge in edges
        for k in range(1, halved + 1)
        for sign in (-1, 1)
    )
    return numpy.array(sorted(x for x in at if 0 <= x <= length * unit)) * T / unit


def mesh():
    """Nodes [n][3] [m], elements [n][20] as numbers of nodes from 1,
    middles of the elements [n][3] [m]."""
    planes = [
        lines(SIDE, [5.5], IN_PLANE),
        lines(SIDE, [1.5, 4.5], IN_PLANE),
        lines(1, [0, 1], ACROSS),
    ]
    fine = [numpy.sort(numpy.concatenate([x, (x[1:] + x[:-1]) / 2])) for x in planes]
    place = numpy.indices([len(x) for x in fine]).reshape(3, -1).T
    place = place[(place % 2).sum(axis=1) <= 1]  # no node in the middle of a face or of an element
    number = numpy.zeros([len(x) for x in fine], int)
    number[tuple(place.T)] = numpy.arange(1, len(place) + 1)
    first = 2 * numpy.indices([len(x) - 1 for x in planes]).reshape(3, -1).T
    elements = number[tuple(numpy.moveaxis(first[:, None] + BRICK, 2, 0))]
    nodes, middles = (
        numpy.stack([fine[a][where[:, a]] for a in range(3)], axis=1)
        for where in (place, first + 1)
    )
    return nodes, elements, middles


def finite_elements(folder):
    """Deflection of the corner [m]: u_z at (0, 0, T/2)."""
    nodes, elements, middles = mesh()
    held = numpy.all((nodes > CLAMP[0] - 1e-6 * T) & (nodes < CLAMP[1] + 1e-6 * T), axis=1)
    corner = 1 + numpy.abs(nodes - [0, 0, T / 2]).sum(axis=1).argmin()
    text = (
        ["*NODE"]
        + ["%d, %.12g, %.12g, %.12g" % (k, *x) for k, x in enumerate(nodes, 1)]
        + ["*ELEMENT, TYPE=C3D20R, ELSET=PLATE"]
    )
    for k, element in enumerate(elements, 1):
        text += [", ".join(map(str, [k, *element[:10]])) + ",", ", ".join(map(str, element[10:]))]
    text += (
        ["*NSET, NSET=HELD"]
        + [str(k) for k in numpy.flatnonzero(held) + 1]
        + ["*NSET, NSET=CORNER", str(corner), "*ELSET, ELSET=LOADED"]
    )
    text += [str(k) for k in numpy.flatnonzero(numpy.all(middles < T, axis=1)) + 1]
    # The weight of the loaded volume under this acceleration is the force.
    text += [
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        f"{YOUNG}, {NU}",
        "*DENSITY",
        f"{DENSITY}",
        "*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL",
        "*BOUNDARY",
        "HELD, 1, 3",
        "*STEP",
        "*STATIC",
        "*DLOAD",
        f"LOADED, GRAV, {FORCE / (DENSITY * T**3)!r}, 0, 0, -1",
        "*NODE PRINT, NSET=CORNER",
        "U",
        "*NODE PRINT, NSET=HELD, TOTALS=ONLY",
        "RF",
        "*END STEP",
    ]
    (folder / "plate.inp").write_text("\n".join(text) + "\n")
    run(folder, "ccx", "plate")
    # Two tables of numbers: the corner's node and displacement, then the total reaction, which
    # shows that the load is the one meant.
    numbers = [
        [float(word) for word in line.split()]
        for line in (folder / "plate.dat").read_text().splitlines()
        if is_numbers(line)
    ]
    (node, *displacement), reaction = numbers
    if node != corner or not numpy.allclose(reaction, [0, 0, FORCE], atol=1e-3 * FORCE):
        sys.exit(
            f"ccx: displacement of node {node:g} instead of {corner}, or reaction {reaction} N "
            f"instead of {FORCE:g} N"
        )
    print(
        f"{len(elements)} finite elements, {len(nodes)} nodes: "
        f"corner {displacement[2] * 1e6:.4f} um"
    )
    return displacement[2]


def is_numbers(line):
    return bool(line.split()) and all(character in "0123456789.+-E " for character in line)


def box(low, high):
    return {"box": {"min": list(low), "max": list(high)}}


def lattice(folder, n, democles):
    """Deflection of the corner [m] with n cells through the thickness:
    linear from the centres of the three cells there."""
    h = T / n
    near = {
        f"cell_{i}_{j}": [(i + 0.5) * h, (j + 0.5) * h, T / 2] for i, j in ((0, 0), (1, 0), (0, 1))
    }
    # Regions are larger than the clamp, and smaller than the loaded corner, by less than half a
    # cell: none of its free faces bears the force.
    scene = {
        "method": "lattice",
        "time": {"end": 1},
        "lattice": {"rotation": "small", "relax": {"tolerance": 1e-7}},
        "materials": {"steel": {"density": DENSITY, "young": YOUNG, "poisson": NU}},
        "bodies": [
            {
                "name": "plate",
                "material": "steel",
                "cell": h,
                "shape": box([0, 0, 0], [SIDE * T, SIDE * T, T]),
            }
        ],
        "boundaries": [
            {
                "where": box(CLAMP[0] - h / 4, CLAMP[1] + h / 4),
                "fix": ["x", "y", "z", "rx", "ry", "rz"],
            },
            {"where": box([h / 4] * 3, [T - h / 4] * 3), "force": [0, 0, -FORCE]},
        ],
        # Lines are written at multiples of their interval, not at rest: it is short, so that the
        # last line is as good as at rest.
        "measure": [
            {"name": name, "every": 1e-5, "probe": {"at": at, "fields": ["displacement"]}}
            for name, at in near.items()
        ],
    }
    (folder / "scene.yaml").write_text(json.dumps(scene, indent=1))
    run(folder, democles, "run", "scene.yaml", "-o", "out", "--force", "--quiet")
    record = json.loads((folder / "out" / "run.json").read_text())
    if record["elements"] != n * (SIDE * n) ** 2 or not record["rest"]["reached"]:
        sys.exit(f"{n} layers: {record['elements']} cells, rest {record['rest']}")
    at, *beside = (
        numpy.genfromtxt(folder / "out" / f"{name}.csv", delimiter=",", names=True)["u_z_m"][-1]
        for name in near
    )
    return at + sum((at - there) / 2 for there in beside)


def run(folder, *command):
    done = subprocess.run(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}")


def main():
    if not shutil.which("ccx"):
        print("no ccx: install calculix-ccx")
        sys.exit(77)
    democles = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory(prefix="democles_finite_elements_") as name:
        folder = pathlib.Path(name)
        right = finite_elements(folder)
        found = [lattice(folder, n, democles) for n in LAYERS]
    errors, orders = [u / right - 1 for u in found], []
    for k, n in enumerate(LAYERS):
        text = (
            f"{n} cells through the thickness: corner {found[k] * 1e6:.4f} um, "
            f"error {100 * errors[k]:.3f} %"
        )
        if k:
            orders.append(math.log(abs(errors[k - 1] / errors[k])) / math.log(n / LAYERS[k - 1]))
            text += f", order {orders[-1]:.2f}"
        print(text)
    # A wrong elastic constant can hide in the error of the finest lattice,
    # not in where the two finest lead.
    limit = found[-1] + (found[-1] - found[-2]) / ((LAYERS[-1] / LAYERS[-2]) ** POWER - 1)
    print(
        f"limit of the last two with h^{POWER:g}: {limit * 1e6:.4f} um, "
        f"error {100 * (limit / right - 1):.3f} %"
    )
    if abs(errors[-1]) > BOUND or min(orders) < ORDER or abs(limit / right - 1) > LIMIT:
        sys.exit(
            f"WRONG: last error at most {100 * BOUND:g} %, orders at least {ORDER}, error of the "
            f"limit at most {100 * LIMIT:g} %"
        )


if __name__ == "__main__":
    main()
