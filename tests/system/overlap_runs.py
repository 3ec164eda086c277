#!/usr/bin/python3
"""Overlaps that are too large, and walls that are passed, are said before a run and by it."""
import json
import math
import os

import cli

# A ball of 5 mm whose weight needs m g/k = 6.4 mm of overlap: its centre passes the wall.
HEAVY = """method: particles
time: {end: END, step: 1e-5 s}
gravity: [0, 0, -9.81]
materials: {ball: {density: 2500}, steel: {density: 7800}}
contacts:
  - {between: [ball, steel], normal: {law: linear, stiffness: 2 N/m, damping_ratio: 0.2}}
  - {between: [ball, ball], normal: {law: linear, stiffness: STIFF N/m, damping_ratio: 0.2}}
elements:
  - {name: ball, material: ball, file: ball.csv}
walls:
  - {name: plate, material: steel, SURFACE}
  - {name: far, material: steel, surface: {plane: {point: [0, 0, -50], normal: [0, 0, 1]}}}
  - {name: aside, material: steel, motion: {velocity: [0, 0, -1e-3]},
     surface: {rectangle: {center: [50, 0, -40], normal: [0, 0, 1], size: [1, 1]}}}
  - name: rectangle
    material: steel
    surface: {rectangle: {center: [1, 0, 1], normal: [0, 0, 1], size: [0.1, 0.1]}}
  - name: pipe
    material: steel
    surface: {cylinder: {from: [2, -1, 1.5], to: [2, 1, 1.5], radius: 0.5, inside: true}}
  - name: rod
    material: steel
    surface: {cylinder: {from: [4, -1, 0.5], to: [4, 1, 0.5], radius: 0.5, inside: false}}
  - {name: mesh, material: steel, surface: {stl: plate.stl}}
"""  # walls of all kinds in each scene, most of them out of reach: kernels are compiled once
RECTANGLE = "surface: {rectangle: {center: [0, 0, 0], normal: [0, 0, 1], size: [1, 1]}}"
PLANE = "surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}"
RISES = "surface: {rectangle: {center: [0, 0, -0.05], normal: [0, 0, 1], size: [1, 1]}}"
STL = """solid s
facet normal 0 0 1
outer loop
vertex 5.5 -1 1
vertex 6.5 -1 1
vertex 6 1 1
endloop
endfacet
endsolid s
"""


class Overlaps(cli.Case):
    def setUp(self):
        super().setUp()
        self.put("plate.stl", STL)

    def go(self, name, scene, rows, *args, ranks=1):
        self.put("ball.csv", "x,y,z,radius,vz\n" + "\n".join(rows))
        self.put("s.yaml", scene)
        run = self.call("run", "s.yaml", "-o", name, "--quiet", *args, ranks=ranks)
        self.assertEqual(run.code, 0, run.err)
        with open(os.path.join(self.dir, name, "run.json")) as file:
            return run, json.load(file)

    def test_before(self):
        self.put("ball.csv", "x,y,z,radius\n0,0,0.00501,0.005\n")
        scene = HEAVY.replace("END", "1 ms").replace("SURFACE", RECTANGLE)
        self.put("s.yaml", scene.replace("STIFF", "2"))
        for args in (["check", "s.yaml"], ["run", "s.yaml", "-o", "d"]):
            run = self.call(*args)
            said = run.out + "\n".join(run.err)
            self.assertRegex(said, "warning: particles of material 'ball' and wall 'plate' may")
            self.assertIn("above 1 they pass the wall", said)
        self.put("s.yaml", scene.replace("2 N/m", "1e5 N/m").replace("STIFF", "1e5"))
        self.assertNotIn("may overlap", self.call("check", "s.yaml").out)

    def test_walls_of_all_kinds(self):
        scene = HEAVY.replace("END", "60 ms").replace("SURFACE", PLANE)
        rows = ["0,0,0.00501,0.005,0"] + [f"{x},0,1.00501,0.005,0" for x in (1, 2, 4, 6)]
        run, record = self.go("d", scene.replace("STIFF", "2"), rows)
        text = "\n".join(run.err)
        self.assertRegex(text, r"t = 0.0\d+ s: element 0 has passed wall 'plate'")
        self.assertRegex(text, r"element \d and wall '\w+' overlap by 0")
        self.assertEqual(record["passed_walls"]["count"], 5)
        self.assertGreater(record["overlap"]["largest"], 0.9)

    def test_wall_that_moves(self):
        """It comes from below, faster than its springs can push the ball."""
        scene = HEAVY.replace("END", "20 ms").replace("STIFF", "2")
        scene = scene.replace("SURFACE", RISES + ", motion: {velocity: [0, 0, 5]}")
        run, record = self.go("d", scene, ["0,0,0.00501,0.005,0"])
        self.assertIn("has passed wall 'plate'", "\n".join(run.err))
        self.assertEqual(record["passed_walls"]["count"], 1)

    def test_nothing_to_say(self):
        """A ball that comes to rest on stiff springs, m g/k = 1.3e-4 radii."""
        scene = HEAVY.replace("END", "20 ms").replace("SURFACE", RECTANGLE).replace("STIFF", "2e4")
        run, record = self.go("d", scene.replace("2 N/m", "2e4 N/m"), ["0,0,0.00501,0.005,0"])
        self.assertEqual(run.err, [])
        self.assertEqual(record["passed_walls"], {"count": 0})
        self.assertTrue(0 < record["overlap"]["largest"] < 0.01)
        self.assertEqual(record["trust"]["outside"], [])

    def test_trust(self):
        """Two balls that meet within few steps: each number from what it stands for."""
        scene = HEAVY.replace("END", "4 ms").replace("SURFACE", RECTANGLE).replace("STIFF", "2e4")
        scene = scene.replace("2 N/m", "2e4 N/m") + "measure: [{name: e, every: 1 s, energy: all}]"
        rows = ["0,0,0.1,0.005,0", "0,0,0.111,0.005,-3", "0.3,0,0.00499,0.005,0"]
        run, record = self.go("d", scene, rows, "--set", "time.step=4e-5")
        trust, energy = record["trust"], record["energy"]
        mass, end = 2500 * 4 / 3 * math.pi * 0.005**3, energy["end"]
        contact = math.pi * math.sqrt(mass / 2 / 2e4)  # of the pair; with the wall it is longer
        self.assertAlmostEqual(trust["contact_steps"] / (contact / 4e-5), 1, places=6)
        supplied = energy["start"]["kinetic"] + energy["start"]["elastic"]
        supplied += abs(end["gravity"] - energy["start"]["gravity"])
        self.assertAlmostEqual(
            trust["energy_error"] / (abs(energy["balance_error"]) / supplied), 1, places=6
        )
        self.assertEqual(trust["step"], record["dt"] / record["dt_limit"])
        self.assertEqual(trust["overlap"], record["overlap"]["largest"])
        # the one at rest had room for its own speed alone: it went off with about 3 m/s
        self.assertGreater(trust["list_room"], 1)
        self.assertIn("contact_steps", trust["outside"])
        self.assertIn("list_room", trust["outside"])
        said = [line for line in run.err if "errors may be above 1 %" in line]
        self.assertRegex(said[0], "shortest contact 14.2 steps, below 20: a smaller time.step")

    def test_slipping(self):
        """Three pairs that are pressed together: one slides, at ten times what mu F_n lets its
        spring hold; one moves, but sticks; one is at rest."""
        friction = "tangential: {stiffness_ratio: 0.8, friction: 0.1, damping_ratio: 0.1}, "
        scene = HEAVY.replace("END", "0.1 ms").replace("SURFACE", PLANE).replace("STIFF", "1e3")
        scene = scene.replace("{between: [ball, ball], ", "{between: [ball, ball], " + friction)
        balls = [(0, 0), (0.0099, 1), (0.2, 0), (0.2099, 0.02), (0.4, 0), (0.4099, 0)]
        self.put(
            "pairs.csv", "x,y,z,radius,vy\n" + "".join(f"{x},0,1,5e-3,{v}\n" for x, v in balls)
        )
        found = []
        for ranks in (1, 3):
            _, record = self.go(
                f"d{ranks}", scene.replace("ball.csv", "pairs.csv"), [], ranks=ranks
            )
            self.assertAlmostEqual(record["trust"]["slipping"], 1 / 3, places=12)
            found.append(record["trust"])
        self.assertEqual(found[0], found[1])

    def test_pairs_on_any_ranks(self):
        """Two balls that pass each other; 3 m/s (m*/k)^(1/2) = 24 mm are more than 10 mm."""
        scene = HEAVY.replace("END", "10 ms").replace("SURFACE", RECTANGLE).replace("STIFF", "10")
        found = []
        for ranks in (1, 3):
            rows = ["0,0,0.104,0.005,0", "0,0,0.12,0.005,-3", "0.3,0,0.1,0.005,0"]
            run, record = self.go(f"d{ranks}", scene, rows, ranks=ranks)
            self.assertRegex("\n".join(run.err), "element 0 and element 1 overlap by [01][.]")
            found.append((record["overlap"], record["passed_walls"]))
        self.assertEqual(found[0], found[1])
        self.assertGreater(found[0][0]["largest"], 1)

    def test_wall_that_appears(self):
        """Within the ball, beside it, and just in touch with it."""
        self.put("ball.csv", "x,y,z,radius,vz\n9,0,3,0.005,0\n0,0,0.00101,0.005,0\n")
        moves = ", velocity: [0, 0, 1]"
        for surface, more, is_in in (
            (RECTANGLE, "", True),
            (PLANE, "", True),
            (RISES.replace("-0.05", "-0.002"), moves, True),
            (RECTANGLE.replace("[0, 0, 0]", "[0, 0, -0.004]"), "", False),
            (PLANE.replace("[0, 0, 0]", "[0, 0, -0.01]"), "", False),
        ):
            motion = f", motion: {{appear_at: 1 ms{more}}}"
            scene = HEAVY.replace("END", "2 ms").replace("SURFACE", surface + motion)
            self.put("s.yaml", scene.replace("STIFF", "2e4").replace("2 N/m", "2e4 N/m"))
            for ranks in (1, 3) if surface == PLANE else (1,):
                run = self.call("run", "s.yaml", "-o", "d", "--quiet", "--force", ranks=ranks)
                text = "\n".join(run.err)
                self.assertEqual(run.code, 5 if is_in else 0, text)
                said = "t = 0.001 s: element 1 is inside wall 'plate', which appears (1 in all)"
                self.assertEqual(said in text, is_in, text)


def trough(low, high, wave=0.0):
    """Strips along x from low to high, of 10 cells; `wave` [m] with a period of 0.1 m across."""
    x = [low + (high - low) * k / 10 for k in range(11)]
    z = [wave * math.sin(20 * math.pi * a) for a in x]
    text = "solid s\n"
    for k in range(10):
        a, b = (x[k], -0.05, z[k]), (x[k + 1], -0.05, z[k + 1])
        c, d = (x[k + 1], 0.05, z[k + 1]), (x[k], 0.05, z[k])
        for corners in ((a, b, c), (a, c, d)):
            text += "facet normal 0 0 1\nouter loop\n"
            text += "".join("vertex %.9g %.9g %.9g\n" % p for p in corners)
            text += "endloop\nendfacet\n"
    return text + "endsolid s\n"


def box(low, high):
    return f"box: {{min: [{low}, -1, -1], max: [{high}, 1, 1]}}"


def rod(x, y=0.08, along="z"):
    ends = (f"[{x}, {y}, -0.2]", f"[{x}, {y}, 0.2]")
    if along == "x":
        ends = (f"[{x}, {y}, 0]", f"[{0.1 - x}, {y}, 0]")
    return f"cylinder: {{from: {ends[0]}, to: {ends[1]}, radius: 6 mm, inside: false}}"


def plate(x, size, normal="[0, 0, 1]"):
    return f"rectangle: {{center: [{x}, 0, -0.05], normal: {normal}, size: {size}}}"


class Periodic(cli.Case):
    """A domain of 0.1 m in x, balls of 5 mm; walls that go on beyond both faces, or end before."""

    SCENE = """method: particles
time: {end: 90 ms, step: 1e-5 s}
materials: {a: {density: 2500}}
contacts: [{between: [a, a], normal: {law: linear, stiffness: 1e4, restitution: 1}}]
elements: [{name: ball, material: a, file: ball.csv}]
domain: {periodic: [x], box: {min: [0, -0.1, -0.1], max: [0.1, 0.1, 0.1]}}
walls: [{name: odd, material: a, surface: {SURFACE}MOTION}]
"""

    def accepted(self, surface, motion=""):
        motion = ", motion: {" + motion + "}" if motion else ""
        self.put("s.yaml", self.SCENE.replace("SURFACE", surface).replace("MOTION", motion))
        run = self.call("check", "s.yaml")
        text = "\n".join(run.err)
        if run.code == 0:
            return True
        self.assertEqual(run.code, 3, text)
        self.assertIn("s.yaml:7: wall 'odd' reaches over a periodic face, x = 0 m or 0.1 m", text)
        return False

    def test_faces(self):
        self.put("ball.csv", "x,y,z,radius\n0.05,0,0.05,0.005\n")
        self.put("exact.stl", trough(0, 0.1))
        self.put("long.stl", trough(-0.03, 0.13))
        self.put("waves.stl", trough(-0.02, 0.13, wave=0.003))
        self.put("repeats.stl", trough(-0.05, 0.15, wave=0.003))
        self.put("one_sided.stl", trough(-0.05, 0.104))
        for surface, motion, good in (
            ("plane: {point: [0, 0, -0.05], normal: [0, 0, 1]}", "", True),
            ("plane: {point: [0, 0, -0.05], normal: [0, 1, 3]}", "velocity: [1, 0, 0]", True),
            ("plane: {point: [0, 0, -0.05], normal: [0.1, 0, 1]}", "", False),
            ("plane: {point: [-0.005, 0, 0], normal: [1, 0, 0]}", "", True),
            ("plane: {point: [-0.0049, 0, 0], normal: [1, 0, 0]}", "", False),
            (box(-0.005, 0.105), "", True),
            (box(0, 0.1), "", False),
            (rod(0), "", False),
            (rod(0.1), "", False),
            (rod(0.1, y=0.12), "", True),
            (rod(0.01), "", False),
            (rod(0.012), "", True),
            (rod(0.088), "", True),
            (rod(0.09), "", False),
            (rod(-0.2), "", True),
            (rod(-0.006, along="x"), "", True),
            (rod(0, along="x"), "", False),
            (rod(0.05), "velocity: [1, 0, 0]", False),
            (rod(0.05), "velocity: [1, 0, 0], remove_at: 30 ms", True),
            (rod(0.05), "oscillation: {amplitude: [0.05, 0, 0], frequency: 20}", False),
            (rod(0.05), "velocity: [0, 0, 1]", True),
            (plate(0.05, "[0.1, 1]"), "", False),
            (plate(0.05, "[0.12, 1]"), "", True),
            (plate(0.05, "[0.08, 1]"), "", True),
            (
                plate(0.05, "[0.12, 1]"),
                "rotation: {center: [0, 0, 0], axis: [0, 1, 0], rate: 1}",
                False,
            ),
            (
                plate(0.05, "[0.12, 1]"),
                "rotation: {center: [0, 0, 0], axis: [1, 0, 0], rate: 1}",
                True,
            ),
            ("stl: exact.stl", "", False),
            ("stl: long.stl", "", True),
            ("stl: one_sided.stl", "", False),
            ("stl: repeats.stl", "", True),
            ("stl: waves.stl", "", False),
        ):
            self.assertEqual(self.accepted(surface, motion), good, (surface, motion))


if __name__ == "__main__":
    cli.main(2)
