#!/usr/bin/python3
"""A bed of 3,000 spheres here and in LAMMPS, with LAMMPS's choices. Argument: democles.

Both start from the same stirred bed, without history, and run for 20 ms at several steps. LAMMPS
takes the dashpots at the half step, which is of first order, so that the difference of both codes
halves with the step if, and only if, both have the same model. Without one of the choices it comes
to rest at what that choice makes. docs/conventions.md has the table. Skipped where there is no
program `lmp` (77)."""
import math
import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cases"))
import numpy  # noqa: E402

import bodies  # noqa: E402

LMP = shutil.which("lmp") or shutil.which("lammps")
R, RHO, G, WIDTH, N = 2.5e-3, 2500, 9.81, 0.07, 3000
K, K_T, Z, MU = 1e3, 800, 0.3, 0.2
M = RHO * 4 / 3 * math.pi * R**3
RATE = 2 * Z * math.sqrt(K / (M / 2))  # LAMMPS's gamma_n: dashpot per effective mass [1/s]
END, TIMES = 0.02, 4  # [s], states that are compared
STEPS = tuple(2e-5 / 2**k for k in range(5))
REACHED = 1.6e-6  # largest difference that an independent code reached after 20 ms [m]
WITHOUT = 5e-6  # step of the runs that leave out a choice [s]

INPUT = f"""units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
read_data bed.data
neighbor 0.0005 bin
neigh_modify delay 0 every 1 check yes
pair_style gran/hooke/history {K} {K_T} {RATE!r} {RATE / 2!r} {MU} 1
pair_coeff * *
timestep ${{step}}
fix g all gravity {G} vector 0 0 -1
fix w1 all wall/gran hooke/history {K} {K_T} {RATE!r} {RATE / 2!r} {MU} 1 zplane 0 NULL
fix w2 all wall/gran hooke/history {K} {K_T} {RATE!r} {RATE / 2!r} {MU} 1 xplane 0 {WIDTH}
fix w3 all wall/gran hooke/history {K} {K_T} {RATE!r} {RATE / 2!r} {MU} 1 yplane 0 {WIDTH}
fix i all nve/sphere
thermo 1000000
dump d all custom ${{every}} bed.dump id x y z
dump_modify d sort id format float %.17g
run ${{steps}}
"""
CHOICES = {"slip": "whole", "lever": "radius", "cap": "magnitude"}


class Lammps(bodies.Case):
    def bed(self, elements, step, end, every, choices):
        """Places at every `every` seconds [times][N][3], and the last state."""
        tangential = {
            "stiffness_ratio": K_T / K,
            "friction": MU,
            "damping_factor": 0.5,
            **choices,
        }
        planes = {
            "floor": ([0, 0, 0], [0, 0, 1]),
            "left": ([0, 0, 0], [1, 0, 0]),
            "right": ([WIDTH, 0, 0], [-1, 0, 0]),
            "front": ([0, 0, 0], [0, 1, 0]),
            "back": ([0, WIDTH, 0], [0, -1, 0]),
        }
        # at a wall the effective mass is that of the sphere
        ratio = {"s": Z, "wall": RATE / 2 * math.sqrt(M / K)}
        scene = {
            "time": {"end": end, "step": step},
            "gravity": [0, 0, -G],
            "materials": {"s": {"density": RHO}, "wall": {"density": RHO}},
            "contacts": [
                {
                    "between": ["s", other],
                    "normal": {"law": "linear", "stiffness": K, "damping_ratio": ratio[other]},
                    "tangential": tangential,
                }
                for other in ("s", "wall")
            ],
            "elements": [{"name": "s", "material": "s", **elements}],
            "walls": [
                {
                    "name": name,
                    "material": "wall",
                    "surface": {"plane": {"point": point, "normal": normal}},
                }
                for name, (point, normal) in planes.items()
            ],
            "output": {
                "every": every,
                "fields": ["velocity", "angular_velocity", "radius", "id"],
            },
        }
        last = self.run_scene(scene)
        x = []
        for path in bodies.frames.paths(last.folder)[1:]:
            frame = bodies.frames.Frame(path)
            x.append(frame.points[numpy.argsort(frame.field("id"))])
        return numpy.array(x), last

    def start(self):
        """A bed that has come down, stirred: rows of a CSV, and LAMMPS's data."""
        corner = {"min": [0, 0, 0], "max": [WIDTH, WIDTH, 0.12]}
        fill = {
            "shape": {"sphere": {"radius": R}},
            "fill": {"region": {"box": corner}, "count": N, "jitter": 0.02},
        }
        _, state = self.bed(fill, 2e-5, 0.5, 0.5, {})
        random = numpy.random.default_rng(3)
        v = state.v + random.uniform(-0.05, 0.05, (N, 3))
        w = random.uniform(-20, 20, (N, 3))
        with open(self.dir / "bed.data", "w") as file:
            file.write(f"bed\n\n{N} atoms\n1 atom types\n\n")
            for axis, high in (("x", WIDTH), ("y", WIDTH), ("z", 0.2)):
                file.write(f"-0.001 {high + 0.001} {axis}lo {axis}hi\n")
            file.write("\nAtoms\n\n")
            for k in range(N):
                place = " ".join(repr(float(a)) for a in state.x[k])
                file.write(f"{k + 1} 1 {2 * R!r} {RHO} {place}\n")
            file.write("\nVelocities\n\n")
            for k in range(N):
                rates = " ".join(repr(float(a)) for a in (*v[k], *w[k]))
                file.write(f"{k + 1} {rates}\n")
        rows = [(state.x[k], v[k], R, w[k]) for k in range(N)]
        return {"file": self.spheres("bed.csv", rows)}

    def lammps(self, step):
        steps = round(END / step)
        (self.dir / "in.bed").write_text(INPUT)
        variables = {"step": repr(step), "steps": str(steps), "every": str(steps // TIMES)}
        command = [LMP, "-in", "in.bed", "-log", "none"]
        for name, value in variables.items():
            command += ["-var", name, value]
        done = subprocess.run(
            command, cwd=self.dir, stdin=subprocess.DEVNULL, capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        lines = (self.dir / "bed.dump").read_text().splitlines()
        x = [
            [[float(a) for a in line.split()[1:]] for line in lines[k + 9 : k + 9 + N]]
            for k in range(0, len(lines), N + 9)
        ]
        return numpy.array(x)[1:]

    def difference(self, name, x, other):
        """Median and largest distance at the end [m]."""
        d = numpy.linalg.norm(x - other, axis=2)
        median, most = numpy.median(d, axis=1), d.max(axis=1)
        cells = [f"{a:.2e} {b:.2e}" for a, b in zip(median, most)]
        print(f"{name:28s} {'  '.join(cells)}", flush=True)
        return median[-1], most[-1]

    def test_bed_follows_lammps(self):
        elements = self.start()
        print("median and largest difference of places [m] at 5, 10, 15, 20 ms")
        there, gap = {}, []
        for step in STEPS:
            there[step] = self.lammps(step)
            x = self.bed(elements, step, END, END / TIMES, CHOICES)[0]
            gap.append(self.difference(f"{step:.3g} s", x, there[step]))
        orders = numpy.log2(numpy.array(gap[0]) / gap[-1]) / (len(gap) - 1)
        print(f"order {orders[0]:.2f} of the median, {orders[1]:.2f} of the largest difference")
        self.assertGreater(orders[0], 0.9)  # one sphere that slips or not rules the largest
        self.below("largest difference at the smallest step [m]", gap[-1][1], REACHED)
        limit = 2 * there[STEPS[-1]] - there[STEPS[-2]]
        own = self.difference("to LAMMPS's limit", self.at(elements, CHOICES), limit)
        for name in CHOICES:
            rest = {key: value for key, value in CHOICES.items() if key != name}
            other = self.difference(f"the same without {name}", self.at(elements, rest), limit)
            self.assertGreater(other[0], 5 * own[0])

    def at(self, elements, choices):
        return self.bed(elements, WITHOUT, END, END / TIMES, choices)[0]


if __name__ == "__main__":
    if not LMP:
        print("there is no LAMMPS here")
        sys.exit(77)
    bodies.main()
