#!/usr/bin/python3
"""Extreme numbers in a scene: they have their effect, or are refused with a message."""
import json
import os
import re
import resource
import subprocess
import time

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
# Walls of both kinds out of reach: kernels are compiled for both, and once.
FAR = "".join(
    f"}}, {{name: {name}, material: a, " + wall.replace("[0, 0, 0]", "[0, 0, -9]", 1)
    for name, wall in (("g", PLANE), ("h", DISC))
)


class Directions(cli.Case):
    def digest(self, wall, name):
        self.put("s.yaml", SCENE.replace("WALL", wall + FAR))
        self.put("e.csv", "x,y,z,radius\n0,0.3,0.049,0.05\n0.1,0.1,0.3,0.05\n")
        run = self.call("run", "s.yaml", "-o", name, "--quiet")
        self.assertEqual(run.code, 0, run.err)
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


class Measured(cli.Case):
    def test_force_that_is_too_large_to_add(self):
        """1e17 N on a wall are beyond the integers that add forces in any order."""
        scene = SCENE.replace("WALL", "surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}")
        scene = scene.replace("{end: 2e-4, step: 1e-5}", "{end: 2e-13, step: 1e-13}")
        scene += "measure: [{name: w, wall_force: f, every: 1e-13}]\n"
        self.put("e.csv", "x,y,z,radius\n0,0,0.049,0.05\n")
        for stiffness, force in (("1e9", -1e6), ("1e20", None)):
            self.put("s.yaml", scene.replace("1e4", stiffness))
            run = self.call("run", "s.yaml", "-o", "d" + stiffness, "--quiet")
            self.assertEqual((run.code, run.err), (0, []))
            with open(os.path.join(self.dir, "d" + stiffness, "w.csv")) as file:
                row = file.read().splitlines()[1].split(",")
            if force:
                self.assertAlmostEqual(float(row[3]) / force, 1, 6)
            else:
                self.assertEqual(row[1:4], ["nan", "nan", "nan"])


class Single(cli.Case):
    """What single precision is too coarse for; `mixed` and `double` say nothing."""

    GRAINS = """method: particles
time: {end: 3e-5, step: 1e-6}
materials: {a: {density: 2500}}
contacts: [{between: [a, a], normal: {law: linear, stiffness: 1e3, restitution: 0.5}}]
elements: [{name: e, material: a, file: e.csv}]
"""
    BAR = """method: lattice
time: {end: 1e-4, step: 1e-7}
materials: {a: {density: 2500, young: 1e9, poisson: 0.2}}
bodies: [{name: bar, material: a, cell: 1 mm, velocity: [SPEED, 0, 0],
    shape: {box: {min: [9, 9, 9], max: [9.004, 9.002, 9.002]}}}]
"""

    def warnings(self, scene, *args):
        self.put("s.yaml", scene)
        run = self.call("check", "s.yaml", *args)
        self.assertEqual(run.code, 0, run.err)
        return re.findall("warning: (precision: single: .*)", run.out)

    def grains(self, x, radius, speed):
        gap = 2.05 * radius
        self.put("e.csv", f"x,y,z,radius,vx\n{x},0,0,{radius},{speed}\n{x+gap},0,0,{radius},0\n")

    def test_grains(self):
        for x, radius, speed, what in (
            (10, 0.0005, 0.1, "0.00191 of the smallest radius"),
            (1e5, 0.005, 1, "of the smallest radius"),
            (1, 0.0005, 0.1, "of the overlap of an impact"),
            (4, 0.05, 0.001, "of the overlap of an impact"),
            (0.01, 0.0005, 0.1, None),
        ):
            self.grains(x, radius, speed)
            said = self.warnings(self.GRAINS, "--precision", "single")
            self.assertEqual(len(said), what is not None, (x, said))
            self.assertIn(what or "", "".join(said))
            for precision in ("mixed", "double"):
                self.assertEqual(self.warnings(self.GRAINS, "--precision", precision), [])
        self.grains(10, 0.0005, 0.1)
        run = self.call("run", "s.yaml", "-o", "d", "--precision", "single", "--quiet")
        self.assertEqual(run.code, 0)
        self.assertRegex("\n".join(run.err), "warning: precision: single: at 10 m.*mixed")

    def test_lattice(self):
        """It works with displacements: where a body is does not matter, only how far it moves."""
        for speed, n in ((1e-3, 0), (10, 0), (1e3, 1)):
            scene = self.BAR.replace("SPEED", str(speed))
            self.assertEqual(len(self.warnings(scene, "--precision", "single")), n, speed)
            self.assertEqual(self.warnings(scene, "--precision", "mixed"), [])


class Steps(cli.Case):
    """`run` says of the step what `check` says, whatever touches at the start."""

    def test_far_over_the_limit(self):
        wall = "surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}"
        self.put("e.csv", "x,y,z,radius,vz\n0,0,0.2,0.05,-1\n0.2,0,0.2,0.05,0\n")
        over = r"exceeds (\d\S+) s, the critical time step of the densest packing"
        for step, is_over in (("1.5e-2", True), ("1e-3", False)):
            self.put(
                "s.yaml",
                SCENE.replace("WALL", wall).replace(
                    "{end: 2e-4, step: 1e-5}", "{end: 3e-2, step: " + step + "}"
                ),
            )
            said = self.call("check", "s.yaml").out
            self.assertEqual("the time step exceeds it" in said, is_over, said)
            run = self.call("run", "s.yaml", "-o", "d" + step, "--quiet")
            self.assertEqual(run.code, 0, run.err)
            found = re.search(over, "\n".join(run.err))
            self.assertEqual(found is not None, is_over, run.err)
            if found:
                self.assertIn(f"critical time step {found[1]} s", said)

    def test_numbers_that_overflow(self):
        wall = "surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}"
        self.put("e.csv", "x,y,z,radius\n0,0,0.2,0.05\n")
        scene = SCENE.replace("WALL", wall).replace("step: 1e-5", "step: auto")
        for density, stiffness, what in (
            ("1e-308", "1e4", "masses or stiffnesses are beyond"),
            ("2500", "1e308", "masses or stiffnesses are beyond"),
        ):
            self.put("s.yaml", scene.replace("2500", density).replace("1e4", stiffness))
            run = self.call("check", "s.yaml")
            self.assertIn(what, run.out + "".join(run.err), (density, stiffness))
            self.assertNotIn("nothing in this scene", run.out)

    def test_velocity_of_what_relaxes(self):
        bar = Single.BAR.replace("SPEED", "VELOCITY") + "lattice: {relax: {tolerance: 1e-6}}\n"
        for velocity, n in (("0", 0), ("1", 1)):
            self.put("s.yaml", bar.replace("VELOCITY", velocity))
            said = self.call("check", "s.yaml").out
            self.assertEqual(said.count("warning: body 'bar': its initial velocity has no"), n)


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


class Bounded(cli.Case):
    """Small scenes that ask for more than there can be: a message at once, and little memory."""

    def refused(self, scene, what, *args):
        self.put("s.yaml", scene)
        began = time.monotonic()
        run = subprocess.run(
            [cli.DEMOCLES, "check", "s.yaml", *args],
            cwd=self.dir,
            capture_output=True,
            text=True,
            timeout=60,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)),
        )
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertRegex(run.stderr, what)
        self.assertLess(time.monotonic() - began, 30)

    def test_depth(self):
        for text in ("{" * 100000, "[" * 100000, "- " * 100000, "{b: " * 50000):
            self.refused(text, "nested too deeply")

    def test_sites_of_a_fill(self):
        fill = SCENE.replace("WALL", PLANE).replace(
            "file: e.csv",
            "shape: {sphere: {diameter: SIZE}}, "
            "fill: {region: {box: {min: [0, 0, 1], max: [LONG, 1, 2]}}COUNT}",
        )
        for size, long, count in (
            ("1e-5", "1", ""),
            ("1e-6", "1", ", count: 10"),
            ("0.1", "1e300", ", count: 10"),
            ("0.1", "1e300", ""),
            ("1e-300", "1", ", count: 1"),
        ):
            text = fill.replace("SIZE", size).replace("LONG", long).replace("COUNT", count)
            for gravity in ("[0, 0, 0]", "[0, 0, -9.81]", "[1, 2, -3]"):
                self.refused(
                    text, "sites or more .*: too many, at most", "--set", "gravity=" + gravity
                )

    def test_few_of_many(self):
        """Count is looked at while sites are collected: a tall region is no obstacle."""
        self.put(
            "s.yaml",
            SCENE.replace("WALL", PLANE).replace(
                "file: e.csv",
                "shape: {sphere: {diameter: 0.1}}, fill: {region: {box: "
                "{min: [0, 0, 1], max: [1, 1, 1e300]}}, count: 10}",
            ),
        )
        run = self.call("check", "s.yaml")
        self.assertEqual((run.code, run.err), (0, []))
        self.assertIn("particles: 10\n", run.out)

    def test_cells_of_a_body(self):
        body = (
            "method: lattice\ntime: {end: 1}\nmaterials: {a: {density: 1, young: 1, poisson: 0}}\n"
            "bodies: [{name: b, material: a, cell: CELL, "
            "shape: {box: {min: [0, 0, 0], max: [MAX, 1, 1]}}}]\n"
        )
        for cell, most in (("1e-5", "1"), ("1e-300", "1"), ("0.1", "1e300")):
            text = body.replace("CELL", cell).replace("MAX", most)
            self.refused(text, "into too many cells")

    def test_files_that_never_end(self):
        self.refused(SCENE.replace("WALL", PLANE).replace("e.csv", "/dev/zero"), "not a file")
        self.refused(SCENE.replace("WALL", "surface: {stl: /dev/zero}"), "not a file")
        run = self.call("check", "/dev/zero")
        self.assertEqual(run.code, 3)
        self.assertEqual(run.err, ["/dev/zero: cannot be read: Operation not supported"])

    def test_aliases(self):
        """A text of 100 kB, said 100,000 times."""
        lines = ["title: &a0 " + 100000 * "x"]
        lines += [f"t{k}: &a{k} [" + ", ".join(10 * [f"*a{k - 1}"]) + "]" for k in range(1, 6)]
        self.refused("\n".join(lines) + "\n", "too large: bulk data belong")


class Extremes(cli.Case):
    """Numbers at the ends of what a double holds, in every reader: a message or a right answer.
    Under sanitizers, which see undefined conversions, as part of the short tests."""

    def answered(self, scene, csv="0,0,1,0.1\n", *args, code=(0, 3)):
        self.put("s.yaml", scene)
        self.put("e.csv", "x,y,z,radius\n" + csv)
        run = self.call("check", "s.yaml", *args)
        self.assertIn(run.code, code, run.err)
        for line in run.err:
            self.assertNotIn("runtime error", line)
            self.assertNotIn("Sanitizer", line)
        return run

    def test_elements(self):
        scene = SCENE.replace("WALL", PLANE)
        for csv in (
            "1e308,-1e308,1e308,1e-300\n-1e308,1e308,1e308,1e-300\n",
            "1e308,0,1,1e308\n-1e308,0,1,1e308\n",
            "1e-320,1,1,1e-320\n1,0,1,1e-320\n",
            "0,0,1e300,1e-300\n0,0,1e-300,1e-300\n",
        ):
            self.answered(scene, csv)

    def test_surfaces(self):
        corners = "vertex {0} 0 0\nvertex -{0} 0 0\nvertex 0 {0} 0\n"
        for size, scale in (
            ("1e308", "1"),
            ("1", "1e308"),
            ("1e-308", "1"),
            ("1", "1e-308"),
            ("1e-320", "1e300"),
            ("1e70", "1"),
        ):
            loop = "facet normal 0 0 1\nouter loop\n" + corners.format(size) + "endloop\nendfacet\n"
            self.put("m.stl", "solid m\n" + loop + "endsolid m\n")
            wall = f"surface: {{stl: m.stl, scale: {scale}}}"
            run = self.answered(SCENE.replace("WALL", wall))
            self.assertEqual(run.code, 0 if size == "1e70" else 3)

    def test_shapes(self):
        for wall in (
            "surface: {plane: {point: [1e308, -1e308, 1e308], normal: [1e308, 1e308, 1e308]}}",
            "surface: {box: {min: [-1e308, -1e308, -1e308], max: [1e308, 1e308, 1e308]}}",
            "surface: {cylinder: {from: [0, 0, -1e300], to: [0, 0, 1e300], radius: 1e300}}",
            "surface: {rectangle: {center: [0, 0, 0], normal: [0, 0, 1], size: [1e308, 1e-308]}}",
        ):
            self.answered(SCENE.replace("WALL", wall))

    def test_numbers(self):
        for change in (
            "time.end=1e308",
            "time.step=1e-308",
            "time={end: 1e-300, step: 1e-308}",
            "gravity=[1e308, 1e308, 1e308]",
            "materials.a.density=1e308",
            "contacts[0].normal.stiffness=1e308",
            "domain={box: {min: [-1e308, -1, -1], max: [1e308, 1, 1]}, periodic: [x]}",
            "output={every: 1e-308, checkpoint_every: 1e308}",
            "walls.f.motion={rotation: {center: [0, 0, 0], axis: [0, 0, 1], rate: 1e308}}",
            "walls.f.motion={remove_at: 1e308}",
        ):
            self.answered(SCENE.replace("WALL", PLANE), "0,0,1,0.1\n", "--set", change)


if __name__ == "__main__":
    cli.main(2)
