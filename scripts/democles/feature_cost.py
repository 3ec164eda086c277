"""What each feature of the lattice costs that a scene asks for: time per cell and step, and device
memory per cell, each on its own.

Runs a block of N x N x N cells, bare and with one feature more, round robin, and takes each one's
best round: other work on the machine slows, nothing makes faster. Writes out/feature_cost.csv and
prints it as a table for a README.

    scripts/feature_cost.py                    60^3 cells, one rank
    scripts/feature_cost.py --cells 100 --steps 20 --rounds 5 --precision single"""
import argparse
import csv
import json
import subprocess

import yaml

from democles import places

OUT = places.OUT / "feature_cost"


def bare(cells):
    """A free block that a small part of it shakes: leapfrog, nu = 0, small rotations,
    no damping."""
    edge = 0.01
    return {
        "title": "features",
        "method": "lattice",
        "time": {"end": 1, "scheme": "leapfrog"},
        "lattice": {"rotation": "small"},
        "materials": {
            "m": {"density": 2700, "young": 70e9, "poisson": 0},
            "n": {"density": 2500, "young": 60e9, "poisson": 0},
        },
        "bodies": [
            {
                "name": "block",
                "material": "m",
                "cell": edge,
                "velocity": [1, 0, 0],
                "shape": {"box": {"min": [0, 0, 0], "max": 3 * [cells * edge]}},
            }
        ],
        "output": {"every": 0},
    }


def face(scene, **what):
    """All cells of the lowest layer in x."""
    scene["boundaries"] = [
        {"where": {"box": {"min": [-1, -1, -1], "max": [0.005, 100, 100]}}, **what}
    ]


def poisson(scene):
    for material in scene["materials"].values():
        material["poisson"] = 0.3


def half(scene):
    box = scene["bodies"][0]["shape"]["box"]["max"]
    scene["bodies"].append(
        {
            "name": "other",
            "material": "n",
            "cell": 0.01,
            "shape": {"box": {"min": [box[0] / 2, 0, 0], "max": list(box)}},
        }
    )


FEATURES = {
    "none (leapfrog, nu = 0, small rotations)": lambda s: None,
    "Poisson's ratio 0.3: volumetric term": poisson,
    "finite rotations": lambda s: s["lattice"].update(rotation="finite"),
    "damping by mass": lambda s: s["materials"]["m"].update(damping={"mass": 1.0}),
    "damping of links": lambda s: s["materials"]["m"].update(damping={"link": 1e-8}),
    "gravity": lambda s: s.update(gravity=[0, 0, -9.81]),
    "fixed DOF on a face": lambda s: face(s, fix=["x", "y", "z"]),
    "force on a face": lambda s: face(s, force=[1000, 0, 0]),
    "two materials": half,
    "strength: links may break": lambda s: s["materials"]["m"].update(
        strength={"tension": 1e12, "shear": 1e12}
    ),
    "stress in frames": lambda s: s["output"].update(fields=["displacement", "stress"]),
    "energy measured every 10 steps": lambda s: s.update(
        measure=[{"name": "energy", "every": 1, "energy": "all"}]
    ),
    "rk4 (four evaluations)": lambda s: s["time"].update(scheme="rk4"),
}


def run(options, name, k):
    scene = bare(options.cells)
    FEATURES[name](scene)
    if "measure" in scene:  # the step is not known here, but about this
        scene["measure"][0]["every"] = 10 * 0.8e-6
    path = OUT / f"scene_{k}.yaml"
    path.write_text(yaml.safe_dump(scene))
    command = [
        options.program,
        "run",
        path,
        "-o",
        OUT / "run",
        "--force",
        "--quiet",
        "--steps",
        str(options.steps),
        "--precision",
        options.precision,
    ]
    subprocess.run(command, stdin=subprocess.DEVNULL, check=True)
    record = json.loads((OUT / "run" / "run.json").read_text())
    return 1e9 / record["element_steps_per_s"], record["device_bytes_per_element"]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--cells",
        type=int,
        default=60,
        help="number of cells along each edge of the block (default: %(default)s)",
    )
    parser.add_argument(
        "--steps", type=int, default=50, help="number of steps per run (default: %(default)s)"
    )
    parser.add_argument(
        "--rounds",
        type=int,
        default=5,
        help="repetitions, of which the fastest counts (default: %(default)s)",
    )
    parser.add_argument(
        "--precision", default="double", help="double, single or mixed (default: %(default)s)"
    )
    parser.add_argument("--program", default=places.program())
    options = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    best = {}
    for _ in range(options.rounds):
        for k, name in enumerate(FEATURES):
            time, memory = run(options, name, k)
            best[name] = (min(time, best.get(name, (time,))[0]), memory)
    first = next(iter(best.values()))
    rows = [
        (name, f"{time:.1f}", f"{time / first[0]:.2f}", f"{memory:.0f}")
        for name, (time, memory) in best.items()
    ]
    titles = (
        "feature",
        "time per cell and step [ns]",
        "over none",
        "device memory per cell [byte]",
    )
    with open(OUT.with_suffix(".csv"), "w", newline="") as file:
        csv.writer(file).writerows([titles, *rows])
    for row in (titles, len(titles) * ["---"], *rows):
        print("| " + " | ".join(row) + " |")
