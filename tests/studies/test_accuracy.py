#!/usr/bin/python3
"""scripts/accuracy.py on two spheres in contact. Arguments: democles, and the tests
that run (all)."""
import contextlib
import csv
import io
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts"))
from democles import accuracy, accuracy_report, accuracy_runs, expect, study  # noqa: E402

DEMOCLES = os.path.abspath(sys.argv[1])
# k_n 1e4 N/m and m* 6.5e-4 kg touch for 8e-4 s: half of it, so that the motion is smooth.
MASS, STIFFNESS, SPEED, END = 2500 * 4 / 3 * math.pi * 5e-3**3, 1e4, 0.5, 4e-4
SCENE = """
method: particles
time: {end: 4e-4, step: 1e-5}
materials: {a: {density: 2500}}
contacts: [{between: [a, a], normal: {law: linear, stiffness: 1e4, damping_ratio: 0}}]
elements: [{name: two, material: a, file: two.csv}]
measure:
  - {name: left, every: 4e-5, probe: {element: 0}}
  - {name: energy, every: 4e-5, energy: all}
"""
FILL = """
method: particles
time: {end: 4e-4, step: 2e-5}
gravity: [0, 0, -9.81]
materials: {a: {density: 2500}}
contacts: [{between: [a, a], normal: {law: linear, stiffness: 1e4, damping_ratio: 0}}]
elements:
  - name: few
    material: a
    shape: {sphere: {radius: 5 mm}}
    velocity: [-5, 0, 0]
    fill: {region: {box: {min: [0, 0, 0], max: [0.05, 0.05, 0.05]}}, count: 9, jitter: 0.2}
walls: [{name: wall, material: a, surface: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}}]
measure: [{name: first, every: 4e-5, probe: {element: 0}}]
"""


class Base(unittest.TestCase):
    """A scene in a folder, and the tool."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.put("scene.yaml", SCENE)
        self.put(
            "two.csv", f"x,y,z,radius,vx\n-5e-3,0,0,5e-3,{SPEED / 2}\n5e-3,0,0,5e-3,{-SPEED / 2}\n"
        )
        self.out = os.path.join(self.folder.name, "study")

    def put(self, name, text):
        path = pathlib.Path(self.folder.name) / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)

    def study(self, *args, scene="scene.yaml", figures=False):
        """Output and messages of the tool; in this process, since its modules take a second."""
        scene = os.path.join(self.folder.name, scene)
        words = [scene, "--out", self.out, "--program", DEMOCLES, "--repeats", "1", *args]
        words += ["--no-figures"] * (not figures)
        said, told = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(told):
            with unittest.mock.patch.object(sys, "argv", ["accuracy", *words]):
                accuracy.main()
        return said.getvalue(), told.getvalue()

    def rows(self, measure):
        with open(os.path.join(self.out, "accuracy.csv"), newline="") as file:
            return [row for row in csv.DictReader(file) if row["measure"] in (measure, None)]


class Accuracy(Base):
    """What is quick."""

    def test_steps(self):
        """Three steps, one that fails, and the same again."""
        args = ["--vary", "time.step=1e-3,4e-5,2e-5,1e-5", "--measure", "left", "--target", "0.2%"]
        first, told = self.study(*args, figures=True)
        rows = self.rows("left.x")
        self.assertRegex(rows[0]["state"], "^failed: .* use a smaller time.step$")
        self.assertEqual([row["steps"] for row in rows[1:]], ["10", "20", "40"])
        self.assertEqual([row["force evaluations"] for row in rows[1:]], ["10", "20", "40"])
        self.assertAlmostEqual(float(rows[3]["order"]), 2, delta=0.1)
        self.assertEqual(told.count("accuracy: run "), 4)
        again, told = self.study(*args)
        self.assertEqual(told, "")
        self.assertTrue(first.startswith(again[: again.rindex("\n\n")]), again)
        self.check_advice(first.splitlines()[-1])
        still, _ = self.study(*args[:2], "--measure", "left.y")
        self.assertIn("left does not change: nothing is compared.", still)
        self.assertTrue(still.endswith("there is nothing to advise by.\n"), still)
        for name in ("accuracy.png", "curves.png"):
            self.assertGreater(os.path.getsize(os.path.join(self.out, name)), 10000)

    def check_advice(self, line):
        """Of two settings one is within the target in every column, which the CSV shows."""
        with open(os.path.join(self.out, "accuracy.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        for step, is_good in (("4e-5", False), ("2e-5", True)):
            errors = [float(r["error: largest [1]"]) for r in rows if r["time.step"] == step]
            self.assertEqual((len(errors), max(errors) <= 0.002), (9, is_good))
        self.assertTrue(
            line.startswith("time.step=2e-5 is the cheapest setting within 0.2 %"), line
        )

    def test_finest(self):
        """Smallest cells first, whatever unit they are given in; then order, step and digits."""
        rows = (
            ("2.5e-3", "0.25 cm", 1e-6, "leapfrog", "single"),
            ("2.5e-3", "2.5 mm", 1e-6, "leapfrog", "double"),
            ("2.5e-3", "0.0025", 2e-6, "rk4", "single"),
            ("1e-2", "10mm", 1e-7, "rk4", "double"),
        )
        runs = []
        for k, (cell, given, dt, scheme, precision) in enumerate(rows):
            self.put(f"{k}/resolved.yaml", f"bodies:\n  - name: a\n    cell: {cell}\n")
            run = accuracy_runs.Run({"bodies.a.cell": given})
            run.folders = [pathlib.Path(self.folder.name) / str(k)]
            run.records = [{"dt": dt, "scheme": scheme, "precision": precision}]
            runs.append(run)
        found = sorted(range(4), key=lambda k: runs[k].fineness())
        self.assertEqual(found, [2, 1, 0, 3])

    def test_keys(self):
        """As --set takes them; several may take one value; what no device can do says so."""
        scene = {"contacts": [{"normal": {"law": 1}}], "elements": [{"name": "a", "material": 2}]}
        keys = {"contacts[0].normal.law": 1, "elements.a.name": "a", "elements.a.material": 2}
        self.assertEqual(dict(expect.leaves(scene)), keys)
        vary = ["--vary", "time.step,measure.left.every=4e-5,2e-5", "--vary", "device=0:0,9:99"]
        self.study(*vary, "--measure", "left.x")
        rows = self.rows("left.x")
        self.assertEqual([row["state"][:9] for row in rows], ["done", "no device"] * 2)
        self.assertEqual([row["steps"] for row in rows[::2]], ["10", "20"])

    def refused(self, *args):
        """What the tool says that refuses these before it runs anything."""
        told = io.StringIO()
        words = [os.path.join(self.folder.name, "scene.yaml"), "--out", self.out]
        words += ["--program", DEMOCLES, *args]
        with contextlib.redirect_stderr(told), self.assertRaises(SystemExit) as left:
            with unittest.mock.patch.object(sys, "argv", ["accuracy", *words]):
                accuracy.main()
        self.assertEqual(left.exception.code, 2, told.getvalue())
        return told.getvalue()

    def test_refused(self):
        """Values that cannot be meant: exit code 2, and a message that names them."""
        for word in ("ranks=1,x", "ranks=0,1", "ranks=1.5,2", "time.step,ranks=-1,2"):
            self.assertIn("no whole number from 1 on", self.refused("--vary", word))
        vary = ["--vary", "time.step=2e-5,1e-5"]
        for word in ("--reference", "--set"):
            self.assertIn("ranks=x", self.refused(*vary, word, "ranks=x"))
        for word in ("nan", "-1%", "0", "1e400", "x%"):
            self.assertIn(f"'{word}'", self.refused(*vary, f"--target={word}"))
        for word in ("--starts=-3", "--repeats=0", "--repeats=1.5"):
            self.assertIn("whole number", self.refused(*vary, word))
        for word in ("left.x=x", "left.x=0", "left.x=nan"):
            self.assertIn(word[7:], self.refused(*vary, "--scale", word))
        self.assertIn("/no/where", self.refused(*vary, "--program", "/no/where"))
        alone = self.refused("--vary", "time.step=1e-5,1e-5,10e-6")
        self.assertIn("alone has nothing to be compared with", alone)

    def test_folder(self):
        """One study at a time, and one scene unless the user has named the folder."""
        folder, scene = pathlib.Path(self.out), pathlib.Path(self.folder.name) / "scene.yaml"
        with study.take_folder("accuracy", folder, scene, False):
            args = ["--vary", "time.step=2e-5,1e-5"]
            self.assertIn("another study is writing into " + self.out, self.refused(*args))
        told = io.StringIO()
        with contextlib.redirect_stderr(told), self.assertRaises(SystemExit) as left:
            study.take_folder("accuracy", folder, scene.with_name("other.yaml"), False)
        self.assertEqual(left.exception.code, 2)
        self.assertRegex(told.getvalue(), "has the results of .*/scene.yaml: --out names another")
        study.take_folder("accuracy", folder, scene.with_name("other.yaml"), True).close()

    def test_failures(self):
        """Those of the setting are remembered, others are tried again by the next study."""
        runner = object.__new__(accuracy_runs.Runner)
        runner.program, runner.scene, runner.common = "democles", pathlib.Path("s.yaml"), {}
        runner.folder = pathlib.Path(self.out)
        for code, is_kept in ((3, True), (5, True), (2, False), (4, False)):
            run, again = accuracy_runs.Run({}), accuracy_runs.Run({})
            run.key = again.key = str(code)
            with unittest.mock.patch.object(study, "run", return_value=(code, "so it is\n")):
                with contextlib.redirect_stderr(io.StringIO()):
                    runner.start(run, 0)
            self.assertRegex(run.reason, "^[a-z ]+: so it is$")
            self.assertEqual(runner.take(again, 0), is_kept, code)
            self.assertEqual(again.reason, run.reason if is_kept else None)
        for code in (6, 75, -9, 137):
            with unittest.mock.patch.object(study, "run", return_value=(code, "so it is\n")):
                with contextlib.redirect_stderr(io.StringIO()), self.assertRaises(SystemExit):
                    runner.start(run, 0)
            self.assertFalse(runner.take(run, 0))

    def made_up(self, name, seconds, outside=(), dt=1e-5):
        """A run that has only been written down."""
        self.put(f"{name}/resolved.yaml", "time: {end: 4e-4}\n")
        run = accuracy_runs.Run({"name": name})
        run.folders = [pathlib.Path(self.folder.name) / name]
        trust = {"overlap": 0.4, "slipping": None, "outside": list(outside)}
        record = {"dt": dt, "time_end": max(dt, 4e-4), "force_evaluations": 1 / dt, "elements": 1}
        run.records = [{**record, "trust": trust, "wall_s": {"loop": seconds}}]
        return run

    def advice(self, *runs):
        """What is advised by these runs and their errors; the first is the reference."""
        result = unittest.mock.Mock(runs=[run for run, _ in runs], can_advise=True)
        errors = dict(runs)
        result.reference_run = runs[0][0]
        result.plan.graded, result.plan.runs = None, result.runs
        result.is_good = lambda run: errors[run] <= 0.01
        result.worst = lambda run: (errors[run], "left.x")
        options = unittest.mock.Mock(target=0.01, by="largest")
        return accuracy_report.advice(options, result)

    def test_trust(self):
        """Runs that say that they are wrong are not advised, nor those that go beyond the end."""
        fine, soft = self.made_up("fine", 9), self.made_up("soft", 2, ["overlap"])
        good, long = self.made_up("good", 5), self.made_up("long", 1, dt=2e-3)
        self.assertEqual((fine.doubts, soft.doubts), ([], ["overlap 0.4"]))
        self.assertEqual(long.doubts, ["step of 0.002 s longer than the run"])
        pairs = [(fine, 0), (soft, 1e-3), (long, 1e-3)]
        self.assertRegex(self.advice(*pairs, (good, 2e-3)), "^name=good is the cheapest")
        self.assertRegex(self.advice(*pairs, (good, 0.1)), "can be trusted: the best, name=good")
        self.assertRegex(self.advice(*pairs), "^No setting can be advised: .* not to be trusted")

    def test_cheap_reference(self):
        """It competes with the rest, but for one that is not to be trusted."""
        dear = self.made_up("dear", 5, dt=2e-5)
        said = self.advice((self.made_up("fine", 1), 0), (dear, 1e-3))
        self.assertRegex(said, "^The reference itself, name=fine, is the cheapest .* 1 %: 1 s")
        said = self.advice((self.made_up("fine", 1, ["overlap"]), 0), (dear, 1e-3))
        self.assertRegex(said, "^name=dear is the cheapest")

    def test_signal(self):
        """A study that is ended ends its run."""
        program = os.path.join(self.folder.name, "program")
        self.put(
            "program",
            f"#!/bin/sh\necho $$ > {self.folder.name}/new\n"
            f"mv {self.folder.name}/new {self.folder.name}/pid\nexec sleep 100\n",
        )
        os.chmod(program, 0o700)
        code = "import pathlib, sys; sys.path.insert(1, sys.argv[1]); from democles import study\n"
        code += "study.end_by_signals(); study.run(sys.argv[2], pathlib.Path('s'), 'f', 1)"
        command = [sys.executable, "-c", code, os.path.dirname(accuracy.__file__) + "/..", program]
        with subprocess.Popen(command) as tool:
            pid = pathlib.Path(self.folder.name) / "pid"
            while not pid.exists() and tool.poll() is None:
                time.sleep(0.05)
            tool.terminate()
            self.assertEqual(tool.wait(60), 128 + signal.SIGTERM)
        with self.assertRaises(ProcessLookupError):
            os.kill(int(pid.read_text()), 0)


class AccuracyMore(Base):
    """What takes many runs."""

    def test_richardson(self):
        """What the finest three extrapolate to is nearer to the closed form than any of them."""
        self.study("--vary", "time.step=4e-5,2e-5,1e-5", "--reference", "richardson")
        omega = math.sqrt(2 * STIFFNESS / MASS)
        exact = SPEED / omega * math.sin(omega * END) / 2 - 5e-3
        rows = self.rows("left.x")
        final = [float(row["final"]) for row in rows]
        error = [float(row["error: final [1]"]) * float(row["scale"]) for row in rows]
        extrapolated = final[-1] + error[-1] * (-1 if final[-1] < final[0] else 1)
        self.assertLess(abs(extrapolated - exact), 0.05 * abs(final[-1] - exact))
        for row in rows[1:]:
            self.assertAlmostEqual(float(row["order"]), 2, delta=0.1)

    def test_references(self):
        """A run of its own, and a file of values; ranks have no error."""
        omega = math.sqrt(2 * STIFFNESS / MASS)
        exact = SPEED / omega * math.sin(omega * END) / 2 - 5e-3
        self.put("values.csv", f"measure,number,value\nleft.x,final,{exact!r}\n")
        vary = ["--vary", "time.step=2e-5,1e-5", "--vary", "ranks=1,2", "--measure", "left.x"]
        values = os.path.join(self.folder.name, "values.csv")
        self.study(*vary, "--reference-file", values, "--by", "final")
        error = [float(row["error: final [1]"]) for row in self.rows("left.x")]
        self.assertEqual(error[0], error[1])
        self.assertAlmostEqual(error[0] / error[2], 4, delta=0.2)
        self.study(*vary, "--reference", "time.step=1e-6", "--crossing", "left.x=-4.95e-3")
        rows = self.rows("left.x")
        self.assertEqual([row["role"] for row in rows], ["run"] * 4 + ["reference"])
        self.assertEqual(float(rows[-1]["error: largest [1]"]), 0)
        self.assertAlmostEqual(float(rows[2]["order"]), 2, delta=0.1)
        when = math.asin(2 * 5e-5 * omega / SPEED) / omega
        # linear between times of the measure, h apart: a h^2/8 of a way at speed v, and the step
        self.assertAlmostEqual(float(rows[0]["crossing [s]"]), when, delta=1e-6)

    def test_starts(self):
        """An error below what starts differ by is not distinguishable."""
        self.put("fill.yaml", FILL)
        said, _ = self.study(
            *(
                "--vary",
                "time.step=4e-5,2e-5,1e-5",
                "--starts",
                "2",
                "--measure",
                "first.x",
                "--target",
                "1e-9",
            ),
            scene="fill.yaml",
        )
        rows = self.rows("first.x")
        self.assertGreater(float(rows[0]["scatter: largest [1]"]), 1e-3)
        self.assertEqual(rows[0]["verdict"], "not distinguishable")
        self.assertIn("3 starts with time.step=2e-5 differ by up to", said)
        self.assertIn("the cheapest setting that cannot be told from other starts", said)
        seeds = set()
        for folder, _, files in os.walk(os.path.join(self.out, "runs")):
            if "run.json" in files:
                with open(os.path.join(folder, "run.json")) as file:
                    self.assertEqual(json.load(file)["exit"], 0)
                with open(os.path.join(folder, "resolved.yaml")) as file:
                    seeds |= {line.split()[-1] for line in file if "seed:" in line}
        self.assertEqual(len(seeds), 3, seeds)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
