"""step_study.py CASE: at which time step a case's outflow curve stops changing.

Runs cases/CASE once per time step, without frames in between, and some more times at one step with
other random starts: where two steps differ by no more than two starts do, the step no longer
matters. Writes out/CASE_steps/: step_study.csv (a line per run), curves.csv (the curves, some 200
lines) and step_study.png. Runs that are there already are not repeated.

    scripts/step_study.py v_funnel
    scripts/step_study.py v_funnel --steps 4e-5,2e-5 --ranks 1 --seeds 2
    scripts/step_study.py l_box --measure trough --steps 4e-5,2e-5,1e-5"""
import argparse
import json
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

from democles import expect, mpi, places  # noqa: E402

SHARES = (0.1, 0.5, 0.9)  # of all elements; the times at which they have passed are compared


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("case", metavar="CASE")
    parser.add_argument(
        "--steps",
        default="4e-5,2e-5,1e-5,5e-6,2e-6",
        help="time steps [s], comma separated (default: %(default)s)",
    )
    parser.add_argument(
        "--measure", default="outflow", help="the count to compare (default: %(default)s)"
    )
    parser.add_argument(
        "--seeds",
        type=int,
        default=3,
        help="random starts that show the scatter (default: %(default)s)",
    )
    parser.add_argument(
        "--seeds-step", help="time step of the further starts (default: the second of --steps)"
    )
    parser.add_argument("--ranks", default="2", help="MPI ranks (default: %(default)s)")
    parser.add_argument("--end", help="simulated time of all runs (default: the scene's)")
    parser.add_argument("--program", default=places.program())
    return parser.parse_args()


def run(options, folder, settings):
    if (folder / "run.json").is_file() and json.loads((folder / "run.json").read_text())[
        "exit"
    ] == 0:
        return
    command = mpi.command(
        "-n",
        options.ranks,
        options.program,
        "run",
        str(places.CASES / options.case / "scene.yaml"),
        "-o",
        str(folder),
        "--force",
        "--quiet",
        "--set",
        "output.every=0",
    )
    for setting in settings:
        command += ["--set", setting]
    print("step_study:", *command, flush=True)
    code = subprocess.run(
        command, env=mpi.environment(), stdin=subprocess.DEVNULL, check=False
    ).returncode
    if code:
        sys.exit(f"step_study: exit code {code}")


class Curve:
    def __init__(self, label, folder, measure):
        self.label, self.record = label, expect.record(folder)
        s = expect.series(folder, measure)
        self.time, self.count, self.n = s["time"], s["count"], self.record["elements"]

    def at(self, share):
        """Time at which this share of all elements has passed [s]; NaN: never."""
        reached = numpy.flatnonzero(self.count >= share * self.n)
        return self.time[reached[0]] if len(reached) else numpy.nan

    def apart(self, other):
        """Largest distance of the curves, in shares of all elements."""
        return (
            float(numpy.abs(numpy.interp(self.time, other.time, other.count) - self.count).max())
            / self.n
        )


def table(curves, finest):
    times = [f"{share:.0%} out [s]" for share in SHARES]
    titles = [
        "run",
        "step [s]",
        "first [s]",
        *times,
        "out at end [1]",
        "largest distance from finest [1]",
        "wall [s]",
    ]
    rows = [
        [
            c.label,
            c.record["dt"],
            c.at(1 / c.n),
            *(c.at(share) for share in SHARES),
            c.count[-1] / c.n,
            c.apart(finest),
            c.record["wall_s"]["loop"],
        ]
        for c in curves
    ]
    return titles, [
        [cell if isinstance(cell, str) else f"{cell:.5g}" for cell in row] for row in rows
    ]


def draw(path, title, steps, seeds, finest):
    figure, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(8, 8), layout="constrained")
    for k, c in enumerate(steps):
        colour = plt.get_cmap("viridis")(k / max(len(steps) - 1, 1) * 0.9)
        top.plot(c.time, c.count, color=colour, label=c.label)
        bottom.plot(
            c.time,
            (c.count - numpy.interp(c.time, finest.time, finest.count)) / c.n * 100,
            color=colour,
        )
    for c in seeds:
        top.plot(c.time, c.count, color="0.6", lw=0.8, ls="--", label=c.label)
        bottom.plot(
            c.time,
            (c.count - numpy.interp(c.time, finest.time, finest.count)) / c.n * 100,
            color="0.6",
            lw=0.8,
            ls="--",
        )
    top.set_ylabel("elements that have passed")
    bottom.set_ylabel("difference from the smallest step\n[% of all elements]")
    bottom.set_xlabel("time [s]")
    for axis in (top, bottom):
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    top.legend(frameon=False)
    top.set_title(title)
    figure.savefig(path, dpi=120)


def main():
    options = arguments()
    values = options.steps.split(",")
    out = places.OUT / (options.case + "_steps")
    extra = [f"time.end={options.end}"] if options.end else []
    seeds_step = options.seeds_step or values[min(1, len(values) - 1)]
    group = expect.first_group(places.CASES / options.case / "scene.yaml")
    plan = [(f"dt = {v} s", out / f"step_{v}", [f"time.step={v}"]) for v in values]
    plan += [
        (
            f"seed {k}, dt = {seeds_step} s",
            out / f"seed_{k}_{seeds_step}",
            [f"time.step={seeds_step}", f"elements.{group}.fill.seed={100 + k}"],
        )
        for k in range(1, options.seeds + 1)
    ]
    out.mkdir(parents=True, exist_ok=True)
    for _, folder, settings in plan:
        run(options, folder, settings + extra)
    curves = [Curve(label, folder, options.measure) for label, folder, _ in plan]
    finest = min(curves[: len(values)], key=lambda c: c.record["dt"])
    titles, rows = table(curves, finest)
    with open(out / "step_study.csv", "w") as file:
        file.writelines(
            ",".join(row) + "\n"
            for row in [titles, *([cell.replace(",", ";") for cell in row] for row in rows)]
        )
    times = numpy.linspace(0, finest.time[-1], 201)
    columns = [times, *(numpy.interp(times, c.time, c.count) for c in curves)]
    numpy.savetxt(
        out / "curves.csv",
        numpy.transpose(columns),
        fmt="%.6g",
        delimiter=",",
        comments="",
        header=",".join(["time [s]", *(c.label.replace(",", ";") for c in curves)]),
    )
    draw(
        out / "step_study.png",
        f"{options.case}: {options.measure}",
        curves[: len(values)],
        curves[len(values) :],
        finest,
    )
    print("| " + " | ".join(titles) + " |\n|" + "---|" * len(titles))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(out / "step_study.png")
