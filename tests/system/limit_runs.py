#!/usr/bin/python3
"""Extreme numbers in a scene: they have their effect, or are refused with a message."""
import json
import os
import re

import cli

SCENE = """method: particles
time: {end: 2e-4, step: 1e-5}
materials: {a: {density: 2500}}
contacts: [{between: [a, a], normal: {law: linear, stiffness: 1e4, damping_ratio: 0.1}}]
walls: [{name: f, material: a, WALL}]
elements: [{name: e, material: a, file: e.csv}]
"""
PLANE = "surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}, motion: {velocity: [0, 0, 0.1]}"
DISC = (
    "surface: {rectangle: {center: [0, 0, 0], size: [1, 1], normal: [0, 0, 1]}}, "
    "motion: {rotation: {center: [0, 0, 0], axis: [0, 0, 1], rate: 5}}"
)


class Directions(cli.Case):
    def digest(self, wall, name):
        self.put("s.yaml", SCENE.replace("WALL", wall))
        self.put("e.csv", "x,y,z,radius\n0,0.3,0.049,0.05\n0.1,0.1,0.3,0.05\n")
        run = self.call("run", "s.yaml", "-o", name, "--quiet")
        self.assertEqual((run.code, run.err), (0, []))
        with open(os.path.join(self.dir, name, "run.json")) as file:
            return json.load(file)["digest"]

    def test_any_length(self):
        """The same bits as with a length of one, and not those without a wall."""
        free = self.digest(PLANE.replace("point: [0, 0, 0]", "point: [0, 0, -9]"), "free")
        for wall in (PLANE, DISC):
            digests = set()
            for last in ("1]", "1e-200]", "1e200]"):
                long = wall.replace("normal: [0, 0, 1]", "normal: [0, 0, " + last)
                long = long.replace("axis: [0, 0, 1]", "axis: [0, 0, " + last)
                digests.add(self.digest(long, f"{wall[10:15]}{last[:-1]}"))
            self.assertEqual(len(digests), 1, wall)
            self.assertNotIn(free, digests)


class Texts(cli.Case):
    def test_resume_reads_what_run_accepts(self):
        """Characters that YAML takes for line breaks, or only as escapes, and the longest name."""
        self.put("e.csv", "x,y,z,radius\n0,0.3,0.06,0.05\n")
        text = SCENE.replace("WALL", PLANE).replace("{a: {density", "{? NAME : {density")
        text = text.replace("[a, a]", "[NAME, NAME]").replace("material: a", "material: NAME")
        title = (
            'title: "\\x80\\x9f a\\Nb \\u2028\\u2029 \\uFFFE\\uFEFF \\t\\r\\n\\e \\U0010FFFF "\n'
        )
        self.put("s.yaml", title + text.replace("NAME", 1000 * "q"))
        run = self.call("run", "s.yaml", "-o", "d", "--quiet", "--steps", "5")
        self.assertEqual((run.code, run.err), (0, []))
        run = self.call("resume", "d", "--quiet")
        self.assertEqual((run.code, run.err), (0, []))
        said = [self.call("check", path).out for path in ("s.yaml", "d/resolved.yaml")]
        hashes = [re.search("hash ([0-9a-f]{16})", text)[1] for text in said]
        self.assertEqual(hashes[0], hashes[1])


if __name__ == "__main__":
    cli.main(2)
