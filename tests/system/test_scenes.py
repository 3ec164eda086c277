#!/usr/bin/python3
"""Scenes that are wrong (exit code 3, every message once, on any number of ranks) and what `check`
says of those that are right."""
import json
import math
import os
import re
import shutil

import cli

SCENE = """title: two kinds of balls
method: particles
time: {end: 1 ms, step: 1e-6 s}
gravity: [0, 0, -9.81]
materials:
  glass: {density: 2500 kg/m3, young: 1 MPa, poisson: 0.25}
  steel: {density: 7850 kg/m3}
contacts:
  - between: [glass, glass]
    normal: {law: linear, stiffness: 1 kN/m, damping_ratio: 0.1}
    tangential: {stiffness_ratio: 0.5, friction: 0.3}
  - between: [glass, steel]
    normal: {law: linear, stiffness: 2 kN/m, restitution: 0.5}
elements:
  - {name: small, material: glass, shape: {sphere: {diameter: 2 mm}},
     fill: {region: {box: {min: [0, 0, 10 mm], max: [20 mm, 20 mm, 30 mm]}}, count: 30}}
  - {name: listed, material: glass, file: listed.csv}
walls:
  - {name: floor, material: steel, surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}}
  - {name: mould, material: steel, surface: {stl: mould.stl, scale: 1 mm},
      motion: {remove_at: 0.5 ms}}
output: {every: 0.3 ms}
measure:
  - {name: energy, every: 0.1 ms, energy: all}
"""
LISTED = "x,y,z,radius\n0.1,0.1,0.1,0.002\n0.2,0.1,0.1,0.002\n"
FACET = "vertex 500 500 500\nvertex 510 500 500\nvertex 500 510 500\n"
MOULD = f"solid m\nfacet normal 0 0 1\nouter loop\n{FACET}endloop\nendfacet\nendsolid m\n"
TEN = {
    "time.end",
    "gravity[2]",
    "materials.mortar.density",
    "contacts[0].normal.stifness",
    "contacts[1].tangential",
    "elements[0].material",
    "elements[0].fill.count",
    "walls[0].surface.stl",
    "walls[0].motion.remove_at",
    "measure[0].count.below.z",
}
TEN_MISTAKES = os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "..", "scene", "ten_mistakes.yaml"
)


class Scenes(cli.Case):
    def setUp(self):
        super().setUp()
        self.put("scene.yaml", SCENE)
        self.put("listed.csv", LISTED)
        self.put("mould.stl", MOULD)

    def number(self, pattern, text):
        """The number in the place of #."""
        found = re.search(pattern.replace("#", r"([-+.e\d]+)"), text)
        self.assertIsNotNone(found, f"{pattern} in\n{text}")
        return float(found[1])

    def refused(self, patterns, commands=(("check", 1), ("run", 3))):
        """`check` and `run` say just this, in this order, and start nothing."""
        before = sorted(os.listdir(self.dir))
        for command, ranks in commands:
            run = self.call(command, "scene.yaml", ranks=ranks)
            self.assertEqual((run.code, run.out), (3, ""), run.err)
            self.assertEqual(len(run.err), len(patterns), run.err)
            for line, pattern in zip(run.err, patterns):
                self.assertRegex(line, r"\A" + pattern + r"\Z")
            self.assertEqual(sorted(os.listdir(self.dir)), before)


class Wrong(Scenes):
    def test_missing_scene(self):
        os.remove(os.path.join(self.dir, "scene.yaml"))
        self.refused([r"scene\.yaml: cannot be read: No such file or directory"])

    def test_ten_mistakes(self):
        shutil.copy(TEN_MISTAKES, os.path.join(self.dir, "scene.yaml"))
        self.put("filling.stl", MOULD)
        lines = {}
        for command, ranks in (("check", 1), ("run", 1), ("run", 3)):
            run = self.call(command, "scene.yaml", ranks=ranks)
            self.assertEqual((run.code, run.out), (3, ""))
            self.assertEqual(len(run.err), 10, run.err)
            found = [
                re.fullmatch(r"scene\.yaml:(\d+):(\d+): ([\w.\[\]]+): .+", line) for line in run.err
            ]
            self.assertTrue(all(found), run.err)
            self.assertEqual({m[3] for m in found}, TEN)
            places = [(int(m[1]), int(m[2])) for m in found]
            self.assertEqual(places, sorted(places))
            lines[command, ranks] = run.err
        self.assertEqual(lines["run", 1], lines["run", 3])
        self.assertEqual(lines["run", 1], lines["check", 1])
        self.assertIn(
            "scene.yaml:11:31: contacts[0].normal.stifness: unknown key; did you mean 'stiffness'?",
            lines["run", 1],
        )
        self.assertNotIn("out", os.listdir(self.dir))

    def test_wrong_set(self):
        run = self.call(
            "check",
            "scene.yaml",
            "--set",
            "time.ende=1s",
            "--set",
            "walls.flor.motion.remove_at=1s",
        )
        self.assertEqual((run.code, run.out, len(run.err)), (3, "", 2))
        self.assertRegex(
            run.err[0], r"--set time\.ende=1s: time\.ende: unknown key; did you mean 'end'\?"
        )
        self.assertRegex(run.err[1], r"--set walls\.flor.*did you mean 'floor'\?")

    def test_nan_in_csv(self):
        self.put("listed.csv", "x,y,z,radius\n0.1,0.1,0.1,0.002\n0.2,nan,0.1,0.002\n")
        self.refused([r"listed\.csv:3:5: .*nan.*"])

    def test_nul_bytes(self):
        """As after a power cut: in the scene, in --set, in a CSV."""
        nul = "NUL byte: this is no text, or damaged"
        self.put("listed.csv", LISTED + "\0\0\0\0\n0.3,0.1,0.1,0.002\n")
        self.refused([r"listed\.csv:4:1: " + nul])
        self.put("listed.csv", LISTED)
        run = self.call("check", "scene.yaml", "--set", 'title="a\\0b"')
        self.assertEqual((run.code, len(run.err)), (3, 1))
        self.assertIn("text with a null character", run.err[0])
        self.put("scene.yaml", SCENE + "\0\0\0")
        self.refused([r"scene\.yaml:\d+:1: control character 0x00"])

    def test_unreadable_stl(self):
        self.put("mould.stl", "no surface at all")
        self.refused([r"scene\.yaml:20: wall 'mould': .*mould\.stl.*"])

    def test_all_inputs_in_one_go(self):
        self.put(
            "listed.csv", "x,y,z,radius\n0.1,0.1,0.1,0.002\n0.2,0.1,inf,0.002\n0.3,0.1,0.1,-1\n"
        )
        self.put("mould.stl", "no surface at all")
        self.refused(
            [r"scene\.yaml:20: wall 'mould': .*", r"listed\.csv:3:9: .*", r"listed\.csv:4:13: .*"]
        )

    def test_coincident_elements(self):
        self.put("listed.csv", LISTED + "0.1,0.1,0.1,0.001\n")
        self.refused(
            [
                r"scene\.yaml:17: element 30 of group 'listed' and element 32 of group 'listed' "
                r"coincide at \(0\.1, 0\.1, 0\.1\)"
            ]
        )

    def test_element_inside_a_wall(self):
        self.put("listed.csv", LISTED + "0.3,0.1,-0.01,0.002\n")
        self.refused(
            [
                r"scene\.yaml:19: element 32 of group 'listed' at \(0\.3, 0\.1, -0\.01\) is "
                r"inside wall 'floor'"
            ]
        )

    def test_one_rank_alone_has_trouble(self):
        """Files may differ between nodes: nobody may wait for ever for the others."""
        self.put("other.yaml", SCENE.replace("restitution: 0.5", "restitution: 0.6"))
        for other, message in (
            ("nothing.yaml", "nothing.yaml: cannot be read: No such file or directory"),
            ("other.yaml", "other.yaml: rank 1 reads a different scene from this path than rank 0"),
        ):
            run = cli.launch([(1, ["check", "scene.yaml"]), (1, ["check", other])], cwd=self.dir)
            self.assertEqual((run.code, run.out, run.err), (3, "", [message]))


class Checked(Scenes):
    def test_check(self):
        run = self.call("check", "scene.yaml")
        self.assertEqual((run.code, run.err), (0, []))
        self.assertTrue(run.out.startswith("two kinds of balls\n"))
        for text in (
            "particles: 32\n",
            "small: 30 of glass, diameter 0.002 m,",
            "listed: 2 of glass, diameter 0.004 m,",
            "walls: 2, of 2 facets\n",
            "floor: steel, plane\n",
            "mould: steel, 1 triangle, until 0.0005 s\n",
            "k_t 500 N/m",
            "in 1000 steps of 1e-06 s",
            "every 0.0003 s, 5 in all",
            "energy.csv every 0.0001 s",
        ):
            self.assertIn(text, run.out)
        pair, wall = run.out.split("glass and steel")
        m, z = 2500 * math.pi * 0.002**3 / 6, math.log(2) / math.hypot(math.pi, math.log(2))
        self.assertAlmostEqual(self.number("smallest particles: m\\* # kg", pair) / (m / 2), 1, 3)
        self.assertAlmostEqual(
            self.number("particles: m.* contact duration # s", pair)
            / (math.pi * math.sqrt(m / 2 / 1000 / 0.99)),
            1,
            3,
        )
        self.assertAlmostEqual(
            self.number("restitution #\\)", pair), math.exp(-0.1 * math.pi / math.sqrt(0.99)), 3
        )
        self.assertAlmostEqual(self.number("damping ratio #", wall), z, 3)
        self.assertAlmostEqual(self.number("wall: m\\* # kg", wall) / m, 1, 3)
        self.assertAlmostEqual(
            self.number("wall: m.* contact duration # s", wall)
            / (math.pi * math.sqrt(m / 2000 / (1 - z * z))),
            1,
            3,
        )

    def test_features(self):
        def features(*args):
            text = self.call("check", "scene.yaml", *args).out
            into, out = re.search(
                r"features in:(.*)features out:(.*)\n\nmemory on", text, re.S
            ).groups()
            self.assertEqual(set(into.split()) & set(out.split()), set())
            return set(into.split())

        base = features()
        self.assertLessEqual(
            {"spin", "sizes", "plane", "triangle", "pair_tangential", "energy", "timed"}, base
        )
        self.assertEqual(
            base
            & {
                "pair_hertz",
                "wall_tangential",
                "rectangle",
                "moving",
                "orientation",
                "periodic_x",
                "pair_binding",
            },
            set(),
        )
        more = features(
            "--set",
            "contacts[0].binding.force=1 mN",
            "--set",
            "walls.mould.motion.velocity=[0, 0, 1]",
            "--set",
            "walls.mould.motion.remove_at=",
        )
        self.assertEqual((more - base, base - more), ({"pair_binding", "moving"}, {"timed"}))

    def test_hertz(self):
        args = [
            "--set",
            "contacts[0].normal={law: hertz, restitution: 0.5}",
            "--set",
            "contacts[0].tangential.stiffness_ratio=",
        ]
        text = self.call("check", "scene.yaml", *args).out
        e_star, m, r = 1e6 / 2 / (1 - 0.25**2), 2500 * math.pi * 0.002**3 / 6 / 2, 0.0005
        self.assertAlmostEqual(self.number("E\\* # Pa", text) / e_star, 1, 3)
        self.assertAlmostEqual(
            self.number("contact duration # s at 1 m/s", text)
            / (2.87 * (m**2 / (r * e_star**2)) ** 0.2),
            1,
            2,
        )

    def test_step(self):
        for step, allow, says in (
            (1e-6, "false", None),
            (1.0, "false", "a run stops"),
            (1.0, "true", "a run continues"),
        ):
            text = self.call(
                "check",
                "scene.yaml",
                "--set",
                f"time.step={step}",
                "--set",
                f"time.allow_unstable={allow}",
            ).out
            self.assertEqual("the time step exceeds it" in text, says is not None)
            self.assertIn(says or "critical time step", text)
        text = self.call(
            "check", "scene.yaml", "--set", "time.step=auto", "--set", "time.safety=0.25"
        ).out
        step, limit = self.number("steps of # s, 0.25 of the critical", text), self.number(
            "critical time step # s, for the densest packing", text
        )
        self.assertAlmostEqual(step / (0.25 * limit), 1, 3)

    def test_resolved(self):
        run = self.call("check", "scene.yaml", "--resolved")
        self.assertEqual((run.code, run.err), (0, []))
        self.assertRegex(run.out, r"(?m)^  safety: 0\.8$")
        self.put("again.yaml", run.out)
        again = self.call("check", "again.yaml", "--resolved", ranks=3)
        self.assertEqual((again.code, again.out), (0, run.out))

    def test_precision(self):
        single = self.call("check", "scene.yaml", "--resolved", "--set", "precision=single").out
        self.assertIn("precision: single\n", single)
        both = self.call(
            "check", "scene.yaml", "--resolved", "--precision", "single", "--set", "precision=mixed"
        )
        self.assertEqual((both.code, both.out), (0, single))
        self.assertIn(
            "in single precision", self.call("check", "scene.yaml", "--precision=single").out
        )


class Ran(Scenes):
    """What `check` says is what a run does."""

    def test_files(self):
        said = self.call("check", "scene.yaml").out
        run = self.call("run", "scene.yaml", "--quiet")
        self.assertEqual((run.code, run.out, run.err), (0, "", []))
        out = os.path.join(
            self.dir, "out", os.path.basename(self.dir)
        )  # scene.yaml is named for its folder
        frames = [name for name in os.listdir(out) if name.endswith(".hdf")]
        self.assertEqual(len(frames), self.number("every 0.0003 s, # in all", said))
        others = "energy.csv frames.hdf.series log.txt resolved.yaml run.json scene.yaml".split()
        self.assertEqual(sorted(set(os.listdir(out)) - set(frames)), others)
        with open(os.path.join(out, "resolved.yaml")) as file:
            self.assertEqual(file.read(), self.call("check", "scene.yaml", "--resolved").out)
        with open(os.path.join(out, "run.json")) as file:
            record = json.load(file)
        self.assertEqual((record["steps"], record["elements"], record["exit"]), (1000, 32, 0))
        features = {name for name, value in record["features"].items() if value}
        self.assertEqual(
            set(re.search("features in:(.*)features out:", said, re.S)[1].split()), features
        )
        again = self.call("run", "scene.yaml", ranks=3)
        self.assertEqual((again.code, len(again.err)), (2, 1))
        self.assertRegex(
            again.err[0], "holds results already; --force replaces, -o DIR writes elsewhere"
        )

    def test_no_element_left(self):
        """An empty state has a digest of zeros; the log says why, lest it looks like a mistake."""
        change = (
            "walls=",
            "elements.small=",
            "elements.listed.velocity=[0, 0, 190]",
            "domain={box: {min: [0, 0, 0], max: [0.3, 0.3, 0.2]}, remove_outside: true}",
        )
        run = self.call(
            "run", "scene.yaml", "-o", "out", *(word for key in change for word in ("--set", key))
        )
        self.assertEqual((run.code, run.err), (0, []))
        self.assertEqual(
            run.out.splitlines()[-1], "no element is left, so there is no state to digest"
        )
        self.assertIn("\ntime step 1e-06 s (no contact limits it yet), 1000 steps\n", run.out)
        with open(os.path.join(self.dir, "out", "run.json")) as file:
            record = json.load(file)
        self.assertEqual((record["elements_removed"], record["digest"]), (2, 16 * "0"))

    def test_memory(self):
        keys = (
            "walls=",
            "elements[0].fill.count=2500",
            "elements[0].fill.region.box.max=[28 mm, 28 mm, 1 m]",
            "elements[0].velocity=[0, 0, 1]",
            "time={end: 3 ms, step: 1e-5 s}",
            "output=",
        )
        change = [word for key in keys for word in ("--set", key)]
        said = self.call("check", "scene.yaml", *change).out
        run = self.call("run", "scene.yaml", "-o", "out", *change)
        self.assertEqual((run.code, run.err), (0, []))
        with open(os.path.join(self.dir, "out", "run.json")) as file:
            record = json.load(file)
        self.assertGreater(record["rebuilds"], 0)
        pairs = record["interactions"] / record["elements"]
        bytes_now = (
            self.number("# bytes per particle", said)
            + self.number("and # per neighbour pair", said) * pairs
        )
        # arrays that have grown hold up to a quarter more, and small things are not counted
        self.assertTrue(
            1 <= record["device_bytes_per_element"] / bytes_now <= 1.3,
            (record["device_bytes_per_element"], bytes_now),
        )


if __name__ == "__main__":
    cli.main(2)
