"""Scenes with every feature and few elements, for runs of a few steps."""
from scene_parts import (
    bonded_hertz,
    FRICTION,
    HERTZ,
    LINEAR,
    box,
    scene,
    sheet_stl,
    shutters,
    stl,
    touching_csv,
)


def few(cases):
    """Few elements, steps, many rebuilds: equal sizes, friction, bonds on moving planes, triangles,
    a rod, periodic, no account of energy."""
    dt, radius = 2e-5, 0.0025
    walls = [
        {
            "name": "floor",
            "surface": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
            "motion": {"velocity": [1, 0, 0.5]},
        },
        {
            "name": "rod",
            "surface": {
                "cylinder": {
                    "from": [0.0285, -1, 0.005],
                    "to": [0.0285, 1, 0.005],
                    "radius": 0.004,
                    "inside": False,
                }
            },
        },
        {"name": "sheet", "surface": {"stl": "sheet.stl"}},
        *shutters(dt, (2, 5)),
    ]
    contact = {"normal": LINEAR, "tangential": FRICTION, "binding": {"force": 1e-2}}
    s = scene(
        8,
        dt,
        contact,
        [{"name": "few", "file": "few.csv"}],
        walls,
        domain={
            "periodic": ["y"],
            "box": {"min": [-0.02, -0.0025, -0.02], "max": [0.04, 0.0123, 0.04]},
        },
    )
    s["measure"] = [
        {"name": name, "every": 8 * dt, "wall_force": name} for name in ("floor", "rod", "sheet")
    ]
    s["partition"] = {"every": 0}
    return s, {
        "few.csv": touching_csv((5, 3, 1), 0.0049, [radius], (0.0002, 0, 0.00245), (30, 15, 0)),
        "sheet.stl": sheet_stl(-0.0055, 0.026, 1, lambda x, y: 0.0048 + 0.1 * x),
    }


def mixed(cases):
    """The same with Hertz, sizes and materials, rolling springs, bonds, a box and a tube, the
    account of energy; some leave the domain."""
    dt = 1e-5
    contact = bonded_hertz()
    walls = [
        box("room", (-0.0028, -0.0028, 0.0002), (1, 1, 1)),
        {
            "name": "tube",
            "surface": {
                "cylinder": {
                    "from": [0.0098, 0.0049, -1],
                    "to": [0.0098, 0.0049, 1],
                    "radius": 0.0133,
                }
            },
        },
        {
            "name": "sheet",
            "surface": {"stl": "sheet.stl"},
            "motion": {"rotation": {"center": [0, 0, 0], "axis": [0, 0, 1], "rate": 30}},
        },
        *shutters(dt, (2, 7)),
    ]
    elements = [
        {"name": "mixed", "file": "mixed.csv"},
        {"name": "fast", "file": "fast.csv", "material": "steel"},
    ]
    s = scene(
        8,
        dt,
        contact,
        elements,
        walls,
        observe=1,
        output={"fields": ["velocity", "orientation"]},
        domain={
            "remove_outside": True,
            "box": {"min": [-0.01, -0.01, -0.01], "max": [0.03, 0.03, 0.0123]},
        },
    )
    s["contacts"].append({"between": ["steel", "steel"], **contact})
    s["partition"] = {"every": 0}
    return s, {
        "mixed.csv": touching_csv(
            (5, 3, 1), 0.0049, [0.0025, 0.0026, 0.002], (0, 0, 0.0025), (55, 3, -4)
        ),
        "fast.csv": "x,y,z,radius,vx,vy,vz\n0.006,0.004,0.0122,0.001,0,0,5\n"
        "0.0015,0.0045,0.0069,0.0015,0,0,-20\n",
        "sheet.stl": sheet_stl(-0.012, 0.03, 1, lambda x, y: 0.0048 + 0.1 * x),
    }
