#!/usr/bin/python3
"""scripts/scaling.py on a tiny scene. Arguments: democles, the folder of cases."""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(1, os.path.join(HERE, "..", "system"))
import parallel_scenes  # noqa: E402

DEMOCLES, CASES = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])


class Scaling(unittest.TestCase):
    def study(self, folder, *args, scene=None):
        scene = scene or parallel_scenes.put("few", folder, CASES)
        self.out = os.path.join(folder, "study")
        script = os.path.join(HERE, "..", "..", "scripts", "scaling.py")
        return subprocess.run(
            [script, scene, "--steps", "8", "--methods", "geometric", "--out", self.out, *args],
            capture_output=True,
            text=True,
            timeout=240,
        )

    def test_table(self):
        with tempfile.TemporaryDirectory() as folder:
            run = self.study(
                folder, "--ranks", "1,2,3", "--cores", "2", "--profile", "--program", DEMOCLES
            )
            self.assertEqual(run.returncode, 0, run.stderr)
            with open(os.path.join(self.out, "scaling.csv")) as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([row["ranks"] for row in rows], ["1", "2", "3"])
            self.assertEqual(len({row["digest"] for row in rows}), 1)
            for row in rows:
                with open(os.path.join(self.out, f"geometric_{row['ranks']}", "run.json")) as file:
                    record = json.load(file)
                self.assertEqual(float(row["U max [1]"]), record["imbalance"]["max"])
                self.assertEqual(
                    float(row["neighbours max"]), record["exchange"]["neighbours"]["max"]
                )
                self.assertEqual(
                    float(row["neighbours max"]), record["ranks"] - 1
                )  # so few that all are neighbours
                self.assertEqual(
                    float(row["sent per step, all ranks [kB]"]), record["halo_bytes_per_step"] / 1e3
                )
                self.assertIn("kernels", record)
                timed = [
                    row[name]
                    for name in (
                        "time [s]",
                        "speed-up",
                        "efficiency [%]",
                        "compute [%]",
                        "wait [%]",
                    )
                ]
                self.assertEqual([bool(cell) for cell in timed], 5 * [record["ranks"] <= 2])
                if timed[0]:
                    shares = [
                        float(row[part + " [%]"])
                        for part in ("compute", "exchange", "wait", "regroup")
                    ]
                    self.assertAlmostEqual(sum(shares), 100, places=6)
            self.assertEqual(float(rows[0]["speed-up"]), 1)
            self.assertIn("their times would say nothing", run.stdout)
            self.assertGreater(os.path.getsize(os.path.join(self.out, "scaling.png")), 10000)

    def test_results(self):
        """From the frame of a run on, on several numbers of ranks:
        to what that run would have come to."""
        with tempfile.TemporaryDirectory() as folder:
            whole = self.study(folder, "--steps", "20", "--ranks", "1", "--program", DEMOCLES)
            self.assertEqual(whole.returncode, 0, whole.stderr)
            with open(os.path.join(self.out, "scaling.csv")) as file:
                digest = [row["digest"] for row in csv.DictReader(file)]
            first = self.study(folder, "--ranks", "1", "--program", DEMOCLES)
            self.assertEqual(first.returncode, 0, first.stderr)
            begun = os.path.join(folder, "begun")
            os.rename(os.path.join(self.out, "geometric_1"), begun)
            run = self.study(
                folder, "--steps", "12", "--ranks", "1,2", "--program", DEMOCLES, scene=begun
            )
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn("12 steps from t = ", run.stdout)
            with open(os.path.join(self.out, "scaling.csv")) as file:
                self.assertEqual([row["digest"] for row in csv.DictReader(file)], 2 * digest)

    def test_digests(self):
        """Another digest on other ranks does not pass."""
        with tempfile.TemporaryDirectory() as folder:
            program = os.path.join(folder, "program")
            with open(program, "w") as file:
                file.write(
                    f'#!/bin/sh\n[ "${{OMPI_COMM_WORLD_SIZE:-${{PMI_SIZE:-1}}}}" = 2 ] && set -- '
                    f'"$@" --steps 7\nexec "{DEMOCLES}" "$@"\n'
                )
            os.chmod(program, 0o755)
            run = self.study(folder, "--ranks", "1,2", "--program", program)
            self.assertEqual(run.returncode, 1)
            self.assertIn("the digests differ", run.stderr)

    def test_fails(self):
        with tempfile.TemporaryDirectory() as folder:
            run = self.study(folder, "--ranks", "1", "--program", DEMOCLES, "--set", "time.step=1")
            self.assertEqual(run.returncode, 1)
            self.assertIn("exit code", run.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
