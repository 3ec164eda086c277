#!/usr/bin/python3
"""The energy budget of small runs: it closes, with everything that gives and takes energy, and is
the same text on any number of ranks.

Arguments: name of the test, democles, mpirun, its arguments."""
import csv
import json
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
import cli

SCENE = """
method: particles
time: {{end: {end} s, step: {dt} s}}
gravity: {gravity}
materials:
  ball: {{density: 2500}}
  wall: {{density: 7850}}
contacts:
  - between: [ball, ball]
    normal: {{law: linear, stiffness: 1e4, damping_ratio: 0.2}}
    {law}
  - between: [ball, wall]
    normal: {{law: linear, stiffness: 1e4, damping_ratio: 0.2}}
    {law}
elements:
  - {{name: balls, material: ball, shape: {{sphere: {{diameter: 10 mm}}}},
      fill: {{region: {{box: {region}}}, count: {n}, jitter: 0.05, seed: 1}}}}
walls:
{walls}
domain: {domain}
measure:
  - {{name: energy, every: {every} s, energy: all}}
"""
LATTICE = """
method: lattice
time: {{end: 2e-3 s, step: {dt} s, scheme: {scheme}}}
gravity: [0, -9.81, 0]
materials:
  base: {{density: 1000, young: 1e9, poisson: 0.3, damping: {{mass: 100, link: 1e-6}}}}
  tip: {{density: 700, young: 5e8, poisson: 0.2}}
bodies:
  - {{name: base, material: base, cell: 10 mm,
      shape: {{box: {{min: [0, 0, 0], max: [0.2, 0.03, 0.02]}}}}}}
  - {{name: tip, material: tip, cell: 10 mm,
      shape: {{box: {{min: [0.2, 0, 0], max: [0.3, 0.03, 0.02]}}}}}}
boundaries:
  - {{where: {{box: {{min: [-1, -1, -1], max: [0.01, 1, 1]}}}}, velocity: [0, 0.5, 0],
      history: {{sine: {{frequency: 600 Hz}}}}}}
  - {{where: {{box: {{min: [-1, -1, -1], max: [0.01, 1, 1]}}}}, fix: [rx, ry, rz]}}
  - {{where: {{box: {{min: [0.3, -1, -1], max: [1, 1, 1]}}}}, force: [500, -100, 50],
      history: {{sine: {{frequency: 400 Hz}}}}}}
  - {{where: {{box: {{min: [0.1, 0.03, -1], max: [0.2, 1, 1]}}}}, pressure: 2e5,
      history: {{sine: {{frequency: 500 Hz}}}}}}
  - {{where: {{body: tip}}, acceleration: [0, 0, 300]}}
measure:
  - {{name: energy, every: 2e-4 s, energy: all}}
"""
FRICTION = "tangential: {stiffness_ratio: 0.8, friction: 0.3, damping_ratio: 0.2}"
ALL = (
    FRICTION
    + "\n    rolling: {model: epsd, friction: 0.05, damping_ratio: 0.3}\n    binding: {force: 0.2}"
)
TILTED = """
  - {name: room, material: wall, surface: {box: {min: [0, 0, 0], max: [0.04, 0.04, 0.3]}}}
  - {name: floor, material: wall, surface: {plane: {point: [0, 0, 0.005], normal: [0.1, 0, 1]}},
     motion: {oscillation: {amplitude: [0.002, 0, 0.01], frequency: 30 Hz}}}"""
LOSSES = ["dashpot_normal", "dashpot_tangential", "sliding", "rolling", "bonds"]


class Budget(cli.Case):
    def budget(self, ranks, **keys):
        """Columns by name, the same for all numbers of ranks."""
        keys = {
            "dt": 2e-5,
            "end": 0.06,
            "every": 0.002,
            "law": FRICTION,
            "gravity": "[0, 0, -9.81]",
            "n": 20,
            "domain": "{}",
            "region": "{min: [0, 0, 0.005], max: [0.04, 0.04, 0.2]}",
            "scene": SCENE,
            **keys,
        }
        self.put("scene.yaml", keys["scene"].format(**keys))
        texts = []
        for n in ranks:
            run = self.call("run", "scene.yaml", "-o", "out", "--force", ranks=n)
            self.assertEqual(run.code, 0, run.err)
            with open(os.path.join(self.dir, "out", "energy.csv")) as file:
                texts.append(file.read())
        self.assertEqual(len(set(texts)), 1, "not the same on all numbers of ranks")
        rows = list(csv.reader(texts[0].splitlines()))
        return {
            name.split()[0]: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])
        }

    def closes(self, e, part):
        """The balance, relative to all energy that came, went or was there."""
        size = max(e["gravity"]) - min(e["gravity"]) + e["wall_work"][-1] + max(e["kinetic"])
        self.assertGreater(size, 0.01)
        self.assertLess(max(map(abs, e["balance"])), part * size)

    def test_moving_wall(self):
        """A floor that tilts to and fro under balls which stick, slip and roll:
        every term of the account takes part."""
        e = self.budget([1, 3], law=ALL, walls=TILTED)
        self.closes(e, 3e-3)
        self.assertGreater(e["wall_work"][-1], 0.01)
        for name in LOSSES:
            self.assertGreater(e[name][-1], 0, name)
        self.assertGreater(max(e["elastic"]), 0)
        self.assertEqual(set(e["removed"]), {0.0})

    def test_friction_of_other_codes(self):
        """The same with what LAMMPS takes for friction."""
        choices = "friction: 0.3, slip: whole, lever: radius, cap: magnitude"
        e = self.budget([1, 3], law=ALL.replace("friction: 0.3", choices, 1), walls=TILTED)
        self.closes(e, 3e-3)

    def test_wall_that_turns_in_itself(self):
        """Without friction it does no work, to a higher order than that of a step;
        with friction it does, and that closes."""
        drum = """
  - {name: drum, material: wall,
      surface: {cylinder: {from: [0, -1, 0], to: [0, 1, 0], radius: 0.06, inside: true}},
     motion: {rotation: {center: [0, 0, 0], axis: [0, 1, 0], rate: 300 rpm}}}
  - {name: front, material: wall, surface: {plane: {point: [0, -0.01, 0], normal: [0, 1, 0]}}}
  - {name: back, material: wall, surface: {plane: {point: [0, 0.05, 0], normal: [0, -1, 0]}}}"""
        keys = {"walls": drum, "region": "{min: [-0.02, 0, -0.045], max: [0.02, 0.04, 0.03]}"}
        smooth = self.budget([1], law="", **keys)
        self.assertGreater(smooth["dashpot_normal"][-1], 1e-3)
        self.assertLess(max(map(abs, smooth["wall_work"])), 1e-6 * smooth["dashpot_normal"][-1])
        rough = self.budget([1, 2], **keys)
        self.assertGreater(rough["wall_work"][-1], 5e-3)
        self.closes(rough, 1e-3)

    def test_elements_and_walls_that_leave(self):
        """A gate opens under a packing; what falls out of the domain takes its energy with it."""
        box = "{min: [-0.1, -0.1, -0.05], max: [0.14, 0.14, 0.4]}"
        e = self.budget(
            [1, 2],
            end=0.2,
            domain="{remove_outside: true, box: " + box + "}",
            walls="""
  - {name: pipe, material: wall,
      surface: {cylinder: {from: [0.02, 0.02, -0.1], to: [0.02, 0.02, 0.4],
        radius: 0.03, inside: true}}}
  - {name: gate, material: wall,
      surface: {rectangle: {center: [0.02, 0.02, 0], normal: [0, 0, 1], size: [0.1, 0.1]}},
     motion: {remove_at: 0.05 s}}""",
        )
        self.closes(e, 1e-3)
        self.assertEqual(e["kinetic"][-1], 0)
        self.assertEqual(e["gravity"][-1], 0)
        self.assertGreater(e["removed"][-1], 0.01)

    def test_round_and_round(self):
        """A period along a slope: gravity goes on giving."""
        box = "{min: [0, 0, -0.01], max: [0.04, 0.04, 0.3]}"
        e = self.budget(
            [1, 2],
            gravity="[6, 0, -7.5]",
            end=0.2,
            domain="{periodic: [x, y], box: " + box + "}",
            walls="""
  - {name: slope, material: wall, surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}}""",
        )
        self.closes(e, 3e-3)
        mass = 20 * 2500 * 3.14159265 / 6 * 1e-6
        self.assertGreater(
            e["gravity"][0] - e["gravity"][-1], mass * (6 * 0.08 + 7.5 * 0.01)
        )  # further than two periods

    def test_lattice(self):
        """A bar that is shaken at its base, pulled, pressed, pushed and damped: the balance closes
        at second order, and is that of the record."""
        coarse, fine = (
            self.budget([1, 3] if dt == 1e-6 else [1], scene=LATTICE, dt=dt, scheme="leapfrog")
            for dt in (2e-6, 1e-6)
        )
        self.assertEqual(
            list(fine),
            [
                "time",
                "kinetic",
                "rotational",
                "gravity",
                "elastic",
                "link_damping",
                "mass_damping",
                "released",
                "work",
                "balance",
            ],
        )
        work, off = max(map(abs, fine["work"])), [
            max(map(abs, e["balance"])) for e in (coarse, fine)
        ]
        self.assertGreater(off[0] / off[1], 3.5)
        self.assertLess(off[0] / off[1], 4.5)
        self.assertLess(off[1], 1e-3 * work)
        for name in ("link_damping", "mass_damping"):
            self.assertEqual(fine[name], sorted(fine[name]), name)
            self.assertGreater(fine[name][-1], 1e-3 * work, name)
        self.assertEqual(fine["work"][0], 0)
        with open(os.path.join(self.dir, "out", "run.json")) as file:
            record = json.load(file)
        self.assertEqual(record["energy"]["balance_error"], fine["balance"][-1])
        self.assertEqual(record["energy"]["end"]["work"], fine["work"][-1])
        self.assertEqual(record["features"]["energy"], 1)


if __name__ == "__main__":
    cli.main(2)
