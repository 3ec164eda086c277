#!/usr/bin/python3
"""make_moulds.py [DIR]: writes the moulds of the cases as ASCII STL in mm (DIR: the cases' folder,
default cases/ of this checkout).

V-funnel for mortar (Okamura, Ozawa): top 270 x 30, taper 240 high, neck 60 high, outlet 30 x 30.
Outlet at z = 0, axis z; the taper is in x alone.
    Volume 30 x 30 x 60 + 30 x 240 x (30 + 270)/2 mm3 = 1.134 L. 10,600 spheres of 5 mm are 0.694 L:
    at a solid fraction of 0.612 they just fill it. On the lattice that they start from (pitch 1.05
    x 5 mm, so 0.45 solid) they need more room: a collar with straight walls carries on above the
    funnel.
L-box of EN 12350-10 (leg 100 x 200 in plan, 600 high; trough 200 wide, 150 high, 700 long), model
scale 0.45:
    leg 45 x 90 x 270, trough 90 wide, 67.5 high, 315 long, opening of the gate 90 x 67.5 at x = 45.
    The leg holds 1.0935 L; 46,680 spheres of 3 mm are 0.660 L: solid fraction 0.6035. Bars of 12 mm
    become 5.4 mm: three of them leave gaps of 18.45 mm (centres at y = 21.15, 45, 68.85), two leave
    26.4 mm (y = 29.1, 60.9); they are cylinders in the scene, not part of this surface. The lattice
    of pitch 3.15 needs 375 mm of leg, so its walls go up to 390 mm.

Neighbouring faces share their corners, so that no sphere meets an edge that a neighbour does not
have."""
import pathlib
import sys

import numpy as np

FUNNEL = {
    "top": 270.0,
    "depth": 30.0,
    "outlet": 30.0,
    "neck": 60.0,
    "taper": 240.0,
    "collar": 110.0,
}  # mm
L_BOX = {
    "scale": 0.45,
    "leg": (100.0, 200.0, 600.0),
    "trough": (700.0, 150.0),
    "walls": 390.0,
}  # mm before scaling, walls after
HAIR = 1e-3  # mm that the filling keeps from the walls: they are not to touch it by rounding


def quad(a, b, c, d):
    """Two triangles; the normal is a -> b -> c right-handed."""
    return [(a, b, c), (a, c, d)]


def write_stl(path, name, triangles):
    with open(path, "w", encoding="ascii") as out:
        out.write(f"solid {name}\n")
        for triangle in triangles:
            a, b, c = (np.array(p, dtype=float) for p in triangle)
            normal = np.cross(b - a, c - a)
            normal = normal / np.linalg.norm(normal) + 0.0
            out.write("facet normal {:.6g} {:.6g} {:.6g}\nouter loop\n".format(*normal))
            for p in (a, b, c):
                out.write("vertex {:.9g} {:.9g} {:.9g}\n".format(*p))
            out.write("endloop\nendfacet\n")
        out.write(f"endsolid {name}\n")
    print(f"{path}: {len(triangles)} triangles")


def volume(triangles):
    """Of a closed surface whose normals point outwards: sum of tetrahedra against the origin."""
    return sum(np.dot(a, np.cross(b, c)) for a, b, c in triangles) / 6


def funnel(levels, closed):
    """Stacked rings of four walls. levels: (z, half width in x, half width in y)
    from below; normals point outwards."""
    rings = [[(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)] for z, x, y in levels]
    triangles = []
    for low, high in zip(rings, rings[1:]):
        for k in range(4):
            n = (k + 1) % 4
            triangles += quad(low[k], low[n], high[n], high[k])
    if closed:
        triangles += quad(rings[0][3], rings[0][2], rings[0][1], rings[0][0]) + quad(*rings[-1])
    return triangles


def v_funnel(folder):
    f = FUNNEL
    z = [0.0, f["neck"], f["neck"] + f["taper"], f["neck"] + f["taper"] + f["collar"]]
    half = [f["outlet"] / 2, f["outlet"] / 2, f["top"] / 2, f["top"] / 2]
    write_stl(
        folder / "funnel.stl",
        "funnel",
        funnel([(h, x, f["depth"] / 2) for h, x in zip(z, half)], closed=False),
    )
    # The slope is 1 : 2, so a horizontal hair in x is enough for a distance of 0.9 hairs.
    inner = [
        (h, x - HAIR, f["depth"] / 2 - HAIR)
        for h, x in zip([z[0] + HAIR, *z[1:3], z[3] - HAIR], half)
    ]
    triangles = funnel(inner, closed=True)
    write_stl(folder / "filling.stl", "filling", triangles)
    below_collar = [(h, x, f["depth"] / 2) for h, x in zip(z[:3], half)]
    print(
        f"  funnel up to z = {z[2]:g} mm: "
        f"{volume(funnel(below_collar, closed=True)) / 1e6:.4f} L, "
        f"filling: {volume(triangles) / 1e6:.4f} L"
    )


def l_box(folder):
    """Faces as quads between the grid lines x0 x1 x2, z0 z1 z2,
    so that floor, sides and front meet at common corners."""
    s = L_BOX["scale"]
    x0, x1, x2 = 0.0, s * L_BOX["leg"][0], s * (L_BOX["leg"][0] + L_BOX["trough"][0])
    y0, y1 = 0.0, s * L_BOX["leg"][1]
    z0, z1, z2 = 0.0, s * L_BOX["trough"][1], L_BOX["walls"]
    triangles = []
    for a, b in ((x0, x1), (x1, x2)):
        triangles += quad((a, y0, z0), (a, y1, z0), (b, y1, z0), (b, y0, z0))  # floor
    sides = ((x0, x1, z0, z1), (x0, x1, z1, z2), (x1, x2, z0, z1))
    for y, turned in ((y0, False), (y1, True)):
        for a, b, low, high in sides:
            face = [(a, y, low), (b, y, low), (b, y, high), (a, y, high)]
            triangles += quad(*(face[::-1] if turned else face))
    for x, low, high, turned in (
        (x0, z0, z1, True),
        (x0, z1, z2, True),
        (x1, z1, z2, False),
        (x2, z0, z1, False),
    ):  # back, front, end of the trough
        face = [(x, y0, low), (x, y1, low), (x, y1, high), (x, y0, high)]
        triangles += quad(*(face[::-1] if turned else face))
    write_stl(folder / "l_box.stl", "l_box", triangles)
    print(
        f"  leg {x1:g} x {y1:g} x {s * L_BOX['leg'][2]:g} mm: "
        f"{x1 * y1 * s * L_BOX['leg'][2] / 1e6:.4f} L, trough {x2 - x1:g} x {y1:g} x {z1:g} mm"
    )


if __name__ == "__main__":
    cases = (
        pathlib.Path(sys.argv[1])
        if len(sys.argv) > 1
        else pathlib.Path(__file__).resolve().parent.parent / "cases"
    )
    for case, make in (("v_funnel", v_funnel), ("l_box", l_box)):
        (cases / case).mkdir(parents=True, exist_ok=True)
        make(cases / case)
