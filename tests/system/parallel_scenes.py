"""Small scenes that between them use every part of the particle method that depends on who owns
what: for the tests of the parallel runs.

Each is written into a folder by `put`: scene.yaml and what it reads. Steps are few and rebuilds
many, so that elements change hands all the time."""
import math
import os

import yaml

from scene_parts import (
    bonded_hertz,
    FRICTION,
    HERTZ,
    LINEAR,
    block,
    box,
    drum_stl,
    gas_csv,
    scene,
    sheet_stl,
    stl,
)
from short_scenes import few, mixed


def funnel(cases):
    """The V-funnel with balls of 10 mm, gate gone early."""
    with open(os.path.join(cases, "v_funnel", "scene.yaml")) as file:
        s = yaml.safe_load(file)
    s["elements"][0]["shape"]["sphere"]["diameter"] = "10 mm"
    s["elements"][0]["fill"]["count"] = 1000
    s["elements"][0]["velocity"] = [0.2, 0, -1.5]
    s["time"] = {"end": 0.03, "step": 5e-5}
    for wall in s["walls"]:
        if wall["name"] == "gate":
            wall["motion"] = {"remove_at": 0.01}
    s["partition"] = {"every": 10, "threshold": 0}
    s["output"] = {}
    s["measure"] = [
        {"name": "outflow", "every": 0.003, "count": {"below": {"z": 0}}},
        {"name": "energy", "every": 0.003, "energy": "all"},
    ]
    files = {}
    for name in ("filling.stl", "funnel.stl"):
        with open(os.path.join(cases, "v_funnel", name)) as file:
            files[name] = file.read()
    return s, files


def column(cases):
    """A column that collapses into a trough, with cohesive bonds: the L-box in small."""
    walls = [
        box("trough", (0, 0, 0), (0.3, 0.04, 0.2)),
        {
            "name": "gate",
            "surface": {
                "rectangle": {"center": [0.05, 0.02, 0.1], "normal": [1, 0, 0], "size": [0.2, 0.2]}
            },
            "motion": {"remove_at": 0.004},
        },
    ]
    contact = {"normal": LINEAR, "tangential": FRICTION, "binding": {"force": 1e-2}}
    return (
        scene(
            600,
            2e-5,
            contact,
            [block("mortar", (0.0, 0.0, 0.0), (0.047, 0.04, 0.15), 0.008, velocity=(0.8, 0, -1))],
            walls,
        ),
        {},
    )


def hertz(cases):
    """Sizes 1 to 4 on a wavy mesh in a cylinder, Hertz, rolling springs, bonds."""
    contact = bonded_hertz()
    walls = [
        {"name": "sheet", "surface": {"stl": "sheet.stl"}},
        {
            "name": "tube",
            "surface": {"cylinder": {"from": [0, 0, 0], "to": [0, 0, 1], "radius": 0.045}},
        },
    ]
    elements = [
        block(
            "small",
            (-0.028, -0.028, 0.005),
            (0.028, 0.028, 0.03),
            (0.004, 0.006),
            velocity=(1, 0, -1),
        ),
        block("large", (-0.022, -0.022, 0.031), (0.022, 0.022, 0.065), 0.016, velocity=(0, 1, -4)),
    ]
    return (
        scene(600, 2e-5, contact, elements, walls),
        {
            "sheet.stl": sheet_stl(
                -0.05, 0.05, 6, lambda x, y: 0.004 * math.sin(90 * x) * math.cos(70 * y)
            )
        },
    )


def gas(axes, n=60, size=(0.05, 0.04, 0.045), radius=0.0025, speed=2.0, steps=800):
    """Fast spheres in a box that is periodic along some axes
    and has walls across the others, fixed drift through its faces."""

    def make(cases):
        # A wall across an axis that does not repeat: two planes.
        walls = []
        for k, axis in enumerate("xyz"):
            if axis in axes:
                continue
            normal = [0, 0, 0]
            for side, sign in ((0, 1), (size[k], -1)):
                normal[k], point = sign, [0, 0, 0]
                point[k] = side + (-0.0026 if sign > 0 else 0.0026)
                walls.append(
                    {
                        "name": axis + ("low" if sign > 0 else "high"),
                        "surface": {"plane": {"point": point, "normal": list(normal)}},
                    }
                )
        contact = {"normal": LINEAR, "tangential": FRICTION}
        low = [0 if a in axes else -0.01 for a in "xyz"]
        high = [s if a in axes else s + 0.01 for a, s in zip("xyz", size)]
        return (
            scene(
                steps,
                1e-5,
                contact,
                [{"name": "gas", "file": "gas.csv"}],
                walls,
                domain={"periodic": list(axes), "box": {"min": low, "max": high}},
                output={"fields": ["velocity", "orientation"]},
            ),
            {"gas.csv": gas_csv(n, size, radius, speed)},
        )

    return make


def shear(cases):
    """A dense layer between two rough plates that move against each other,
    periodic along the flow and across it."""
    plates = [
        {
            "name": "bottom",
            "surface": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
            "motion": {"velocity": [-1.5, 0, 0]},
        },
        {
            "name": "top",
            "surface": {"plane": {"point": [0, 0, 0.016], "normal": [0, 0, -1]}},
            "motion": {"velocity": [1.5, 0.2, 0]},
        },
    ]
    contact = {
        "normal": LINEAR,
        "tangential": {**FRICTION, "friction": 0.7},
        "rolling": {"model": "cdt", "friction": 0.05},
    }
    return (
        scene(
            600,
            2e-5,
            contact,
            [block("layer", (0, 0, 0.0005), (0.06, 0.03, 0.0155), 0.0047, velocity=(0.3, 0.3, -1))],
            plates,
            domain={
                "periodic": ["x", "y"],
                "box": {"min": [0, 0, -0.01], "max": [0.06, 0.03, 0.03]},
            },
        ),
        {},
    )


def three(cases):
    """Fewer elements than ranks: a collision of three, with empty ranks all the time."""
    rows = (
        "x,y,z,radius,vx,vy,vz\n"
        "0,0,0.006,0.005,1,0,0\n"
        "0.0105,0.001,0.005,0.005,-1,0,0\n"
        "0.005,0.012,0.006,0.006,0,-2,0\n"
    )
    contact = {"normal": LINEAR, "tangential": FRICTION, "binding": {"force": 1e-2}}
    walls = [{"name": "floor", "surface": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}]
    return scene(400, 1e-5, contact, [{"name": "three", "file": "three.csv"}], walls), {
        "three.csv": rows
    }


def thin(cases):
    """A bed one element thick and few long, some large: subdomains thinner than the halo,
    ghosts from ranks beyond the next."""
    contact = {"normal": LINEAR, "tangential": FRICTION}
    walls = [box("trough", (0, 0, 0), (0.12, 0.011, 0.05))]
    elements = [
        block("row", (0, 0, 0), (0.12, 0.011, 0.006), 0.005, velocity=(0.5, 0, 0)),
        block("above", (0, 0, 0.007), (0.12, 0.011, 0.018), 0.01, velocity=(-0.8, 0, -1)),
    ]
    return scene(500, 2e-5, contact, elements, walls), {}


def moving(cases):
    """A shaken box, a turning drum of triangles with its lid gone and back, a cylinder that turns
    inside; a plate that comes and a plate that goes."""
    walls = [
        {
            "name": "drum",
            "surface": {"stl": "drum.stl"},
            "motion": {"rotation": {"center": [0, 0, 0], "axis": [0, 1, 0], "rate": 40}},
        },
        {
            "name": "rod",
            "surface": {
                "cylinder": {
                    "from": [0.02, -1, 0],
                    "to": [0.02, 1, 0],
                    "radius": 0.006,
                    "inside": False,
                }
            },
            "motion": {"rotation": {"center": [0, 0, 0], "axis": [0, 1, 0], "rate": -25}},
        },
        {
            "name": "plate",
            "surface": {
                "rectangle": {
                    "center": [-0.01, 0.03, -0.012],
                    "normal": [0.2, 0, 1],
                    "size": [0.02, 0.06],
                }
            },
            "motion": {
                "oscillation": {"amplitude": [0, 0, 0.008], "frequency": 80, "phase": 0.4},
                "velocity": [0.2, 0, 0],
                "appear_at": 0.003,
                "remove_at": 0.007,
            },
        },
        {
            "name": "shelf",
            "surface": {
                "rectangle": {
                    "center": [-0.02, 0.03, 0.004],
                    "normal": [0, 0, 1],
                    "size": [0.02, 0.06],
                }
            },
            "motion": {"remove_at": 0.002},
        },
    ]
    contact = {"normal": LINEAR, "tangential": {**FRICTION, "friction": 0.5}}
    elements = [
        block("balls", (-0.03, 0.002, -0.027), (0.012, 0.058, -0.012), 0.005, velocity=(1, 0, -2)),
        block(
            "on_the_shelf",
            (-0.029, 0.002, 0.005),
            (-0.011, 0.058, 0.012),
            0.005,
            velocity=(0, 0, -1.5),
        ),
    ]
    return scene(500, 2e-5, contact, elements, walls), {"drum.stl": drum_stl(0.045, 0.06, 14)}


def leaving(cases):
    """Elements that fly out of the domain on all sides while they collide, few left at the end."""
    contact = {"normal": LINEAR, "tangential": FRICTION, "binding": {"force": 5e-3}}
    elements = [
        block("left", (0, 0, 0), (0.02, 0.03, 0.03), 0.005, velocity=(3, 0, 0.5)),
        block("right", (0.022, 0, 0), (0.045, 0.03, 0.03), 0.004, velocity=(-3, 1, 0)),
    ]
    return (
        scene(
            800,
            1e-5,
            contact,
            elements,
            domain={
                "remove_outside": True,
                "box": {"min": [-0.002, -0.002, -0.002], "max": [0.046, 0.032, 0.031]},
            },
            measure=[{"name": "outside", "count": {"above": {"x": 0.03}}}],
        ),
        {},
    )


def apart(cases):
    """No contact laws at all, no walls: two clouds fly past each other."""
    clouds = [
        block("there", (0, 0, 0), (0.02, 0.02, 0.02), 0.005, velocity=(2, 0, 0)),
        block("back", (0.03, 0.021, 0), (0.05, 0.041, 0.02), 0.005, velocity=(-2, 0, 0)),
    ]
    return scene(300, 1e-4, {}, clouds), {}


ALL = {
    "funnel": funnel,
    "column": column,
    "hertz": hertz,
    "gas_x": gas("x"),
    "gas_xy": gas("xy"),
    "gas_xyz": gas("xyz"),
    "shear": shear,
    "three": three,
    "thin": thin,
    "moving": moving,
    "leaving": leaving,
    "apart": apart,
    "few": few,
    "mixed": mixed,
}


def write(scene_and_files, folder):
    """Into a folder: the scene, as scene.yaml, and what it reads; returns the path of the scene."""
    content, files = scene_and_files
    for file, text in {**files, "scene.yaml": yaml.safe_dump(content)}.items():
        with open(os.path.join(folder, file), "w") as out:
            out.write(text)
    return os.path.join(folder, "scene.yaml")


def put(name, folder, cases):
    """Writes scene `name` into a folder; returns its path."""
    return write(ALL[name](cases), folder)
