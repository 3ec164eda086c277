#!/usr/bin/python3
"""The limit in a run: a bonded chain, whose true limit is known, blows up 5 % over it and does not
5 % below it; a step over it is refused.

Free chain of N masses m on springs k: w_max = 2 (k/m)^(1/2) sin((N - 1) pi/(2 N)), dt = 2/w_max;
the bound is (m/k)^(1/2), 0.08 % less at N = 40."""
import csv
import math
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "system"))
import cli  # noqa: E402

N, K, R, DENSITY = 40, 1e3, 2.5e-3, 2200
TRUE = 1 / (
    math.sqrt(K / (DENSITY * 4 / 3 * math.pi * R**3)) * math.sin((N - 1) * math.pi / (2 * N))
)
SCENE = """method: particles
time: {{end: {end:.9e} s, step: {dt:.9e} s, allow_unstable: {allow}}}
gravity: [0, 0, 0]
materials:
  a: {{density: 2200}}
contacts:
  - between: [a, a]
    normal: {{law: linear, stiffness: 1e3, damping_ratio: 0}}
    binding: {{force: 0.25 N}}
elements:
  - {{name: chain, material: a, file: chain.csv}}
measure:
  - {{name: energy, every: {dt:.9e} s, energy: all}}
"""


class Chain(cli.Case):
    def chain(self, dt, steps, allow):
        """Runs it from the shortest wave, to excite the top mode."""
        rows = [f"{i * 2 * R * (1 - 1e-9)!r},0,0,{R},{(-1)**i * 1e-7},0,0" for i in range(N)]
        self.put("chain.csv", "x,y,z,radius,vx,vy,vz\n" + "\n".join(rows) + "\n")
        self.put("scene.yaml", SCENE.format(dt=dt, end=dt * steps, allow=str(allow).lower()))
        return self.call("run", "scene.yaml", "-o", "out")

    def kinetic(self):
        """[J] by line."""
        with open(os.path.join(self.dir, "out", "energy.csv")) as file:
            rows = list(csv.reader(file))
        column = next(k for k, name in enumerate(rows[0]) if name.startswith("kinetic"))
        return [float(row[column]) for row in rows[1:]]

    def test_below(self):
        done = self.chain(0.95 * TRUE, 400, False)
        self.assertEqual(done.code, 0, done.err)
        energy = self.kinetic()
        # leapfrog's energy swings by 1/(1 - (w dt/2)^2) in the top mode, here 10.3
        self.assertLess(max(energy), 10.5 * energy[0])
        self.assertGreater(max(energy[300:]), 0.1 * energy[0])

    def test_over(self):
        done = self.chain(1.05 * TRUE, 30, True)
        energy = self.kinetic()
        self.assertEqual(done.code, 0, done.err)
        self.assertGreater(
            energy[-1], 1e8 * energy[0]
        )  # each step multiplies the amplitude by (1.05 + (1.05^2 - 1)^(1/2))^2 = 1.87

    def test_refused(self):
        done = self.chain(1.05 * TRUE, 30, False)
        self.assertEqual(done.code, 5, done.err)
        text = "\n".join(done.err)
        found = re.search(
            r"time step ([\d.e-]+) s exceeds the critical time step ([\d.e-]+) s, set by the "
            r"contacts of element (\d+)",
            text,
        )
        self.assertTrue(found, text)
        self.assertAlmostEqual(float(found[1]) / TRUE, 1.05, 3)
        self.assertAlmostEqual(float(found[2]) / TRUE, math.sin((N - 1) * math.pi / (2 * N)), 3)
        self.assertIn(int(found[3]), range(1, N - 1))  # the ends have one neighbour only


if __name__ == "__main__":
    cli.main()
