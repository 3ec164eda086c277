#!/usr/bin/python3
"""Overlaps that are too large, and walls that are passed, are said before a run and by it."""
import json
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
"""
RECTANGLE = "surface: {rectangle: {center: [0, 0, 0], normal: [0, 0, 1], size: [1, 1]}}"
PLANE = "surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}"
ALL_KINDS = """
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
"""
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
    def go(self, name, scene, rows, *args, ranks=1):
        self.put("plate.stl", STL)
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
        scene = HEAVY.replace("END", "60 ms").replace("SURFACE}", PLANE + "}" + ALL_KINDS)
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
        self.put("plate.stl", STL)
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


if __name__ == "__main__":
    cli.main(2)
