"""Scaling of a scene over numbers of ranks and partitioners: time, speed-up, efficiency, where the
time goes, load imbalance U = max/mean - 1, edge cut, communication. Where ranks outnumber the
machine's cores, times mean nothing and are left out; the rest holds.

    scripts/scaling.py l_box --ranks 1,2,4,8,16 --steps 500
    scripts/scaling.py my/scene.yaml --methods geometric --ranks 1,2,128 --set output.every=0
    scripts/scaling.py out/l_box --steps 1000                  # from the latest frame of a run

Writes scaling.md, scaling.csv and scaling.png into out/scaling/NAME, beside the runs. Exit code 1
if a run fails or if digests differ."""
import argparse
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from democles import places, study  # noqa: E402

TITLES = [
    "partition",
    "ranks",
    "time [s]",
    "speed-up",
    "efficiency [%]",
    "reference: speed-up",
    "reference: efficiency [%]",
    "compute [%]",
    "exchange [%]",
    "wait [%]",
    "regroup [%]",
    "U mean [1]",
    "U max [1]",
    "cut",
    "sent per step, all ranks [kB]",
    "sent per step, largest [kB]",
    "messages per step, largest",
    "neighbours mean",
    "neighbours max",
    "digest",
]


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "scene",
        metavar="CASE|SCENE|DIR",
        help="a folder of cases/, a scene, or a folder of results",
    )
    parser.add_argument(
        "--ranks",
        type=study.numbers,
        default=[1, 2, 4, 8, 16],
        help="numbers of ranks (default: 1,2,4,8,16)",
    )
    parser.add_argument(
        "--methods",
        default="geometric,interactions,graph",
        help="partitioners; unknown ones are left out (default: %(default)s)",
    )
    parser.add_argument(
        "--steps", type=int, default=500, help="number of steps of each run (default: %(default)s)"
    )
    parser.add_argument(
        "--rounds",
        type=int,
        default=1,
        help="repetitions of the timed runs, round robin; "
        "the fastest counts (default: %(default)s)",
    )
    parser.add_argument(
        "--profile",
        action="store_true",
        help="measures the time of each kernel too, for model.py, at a small cost",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="changes a key of the scene; may be repeated",
    )
    parser.add_argument(
        "--cores",
        type=int,
        default=study.cores(),
        help="largest number of ranks whose times are given (default: %(default)s)",
    )
    parser.add_argument("--out", type=pathlib.Path, help="folder for the results")
    parser.add_argument(
        "--program", default=places.program(), help="path of democles (default: %(default)s)"
    )
    return parser.parse_args()


def first_step(scene):
    """The step at which the runs begin: 0, or that of the frame from which they resume."""
    if scene.is_file():
        return 0
    from democles import frames  # only here, since h5py takes a second

    return frames.Frame(frames.paths(scene)[-1]).step()


def run_all(options, scene, first):
    """(method, ranks) -> record; the fastest of all rounds."""
    found = {}
    for turn in range(options.rounds):
        for method in options.methods.split(","):
            for ranks in options.ranks:
                if turn > 0 and (ranks > options.cores or (method, ranks) not in found):
                    continue
                args = ["--steps", str(first + options.steps), *["--profile"] * options.profile]
                for setting in ["output.every=0", f"partition.method={method}", *options.set]:
                    args += ["--set", setting]
                folder = options.out / f"{method}_{ranks}"
                print(f"scaling: {method}, {ranks} ranks", file=sys.stderr, flush=True)
                code, err = study.run(options.program, scene, folder, ranks, *args)
                if code == 3 and not any(m == method for m, _ in found):
                    print(f"scaling: {method} is left out: {err.strip()}", file=sys.stderr)
                    break
                if code:
                    sys.exit(f"scaling: {method}, {ranks} ranks: exit code {code}\n{err}")
                record = study.Record(folder)
                if turn == 0 or record.loop < found[method, ranks].loop:
                    found[method, ranks] = record
    if not found:
        sys.exit("scaling: nothing has run")
    return found


def row(method, record, base, reference, cores):
    timed = record.ranks <= cores
    speed = base.loop * base.ranks / record.loop if timed and base and record.loop > 0 else None
    speed_reference, efficiency_reference = reference.get(method, {}).get(
        record.ranks, (None, None)
    )
    sent, shares = record.raw["exchange"], record.shares() if timed else [None] * len(study.PARTS)
    return [
        method,
        record.ranks,
        record.loop if timed else None,
        speed,
        speed and 100 * speed / record.ranks,
        speed_reference,
        efficiency_reference,
        *shares,
        record.imbalance(),
        record.of("imbalance", "max"),
        record.cut(),
        record.raw["halo_bytes_per_step"] / 1e3,
        sent["bytes"]["max"] / 1e3,
        sent["messages"]["max"],
        sent["neighbours"]["mean"],
        sent["neighbours"]["max"],
        record.digest,
    ]


def notes(options, found, base, has_reference):
    first = next(iter(found.values()))
    since = f" from t = {first.raw['resumed']['time']:.4g} s on" if "resumed" in first.raw else ""
    device, cores = (
        first.raw["devices"][0],
        f"{options.cores} core{'s' if options.cores > 1 else ''}",
    )
    lines = [
        f"{first.raw['title']}: {first.elements} elements, {first.raw['interactions']} "
        f"interactions, {options.steps} steps{since}, "
        f"{first.raw['precision']}; {device['name']}, {device['platform_version']}; {cores}.",
        "Time is that of all steps, without set-up and output. Shares are means over ranks; "
        "exchange is without wait.",
    ]
    if base and base.ranks > 1:
        lines.append(f"Speed-up is relative to {base.ranks} ranks, which count as {base.ranks}.")
    if max(options.ranks) > options.cores:
        lines.append(
            "More ranks than cores share them: their times would say nothing and are not given. "
            "The rest holds."
        )
    if has_reference:
        lines.append(f"Reference: {study.REFERENCE_SOURCE}.")
    return lines


def shown(rows, has_reference):
    """Titles and rows, without the columns of the reference where there is none."""
    keep = [
        k for k, title in enumerate(TITLES) if has_reference or not title.startswith("reference: ")
    ]
    return [TITLES[k] for k in keep], [[r[k] for k in keep] for r in rows]


def draw(path, title, rows, reference, cores):
    figure, axes = plt.subplots(2, 2, figsize=(10, 8), layout="constrained")
    column = {name: k for k, name in enumerate(TITLES)}
    shown = [
        (axes[0, 0], "speed-up", "speed-up"),
        (axes[0, 1], "U mean [1]", "imbalance U, mean over the run"),
        (axes[1, 0], "sent per step, all ranks [kB]", "sent per step, all ranks [kB]"),
        (axes[1, 1], "neighbours mean", "neighbours, mean"),
    ]
    ranks = sorted({r[1] for r in rows})
    for k, method in enumerate(dict.fromkeys(r[0] for r in rows)):
        for axis, name, label in shown:
            points = [
                (r[1], r[column[name]])
                for r in rows
                if r[0] == method and r[column[name]] is not None
            ]
            axis.plot(*zip(*points) if points else ([], []), "o-", color=f"C{k}", label=method)
            axis.set_ylabel(label)
        if method in reference:
            axes[0, 0].plot(
                list(reference[method]),
                [s for s, _ in reference[method].values()],
                "x:",
                color=f"C{k}",
                label=f"reference, {method}",
            )
    axes[0, 0].plot(ranks, ranks, color="0.8", lw=1, label="ideal", zorder=0)
    axes[0, 0].set_yscale("log", base=2)
    axes[0, 0].set_title(f"measured up to {cores} rank{'s' if cores > 1 else ''}", size=10)
    for axis in axes.flat:
        axis.set_xscale("log", base=2)
        axis.set_xlabel("ranks")
        axis.set_xticks(ranks, [str(r) for r in ranks])
        axis.minorticks_off()
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    axes[0, 0].legend(frameon=False)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)


def main():
    options = arguments()
    scene, name = study.find_scene("scaling", options.scene)
    options.out = options.out or places.OUT / "scaling" / name
    options.out.mkdir(parents=True, exist_ok=True)
    found, reference = run_all(options, scene, first_step(scene)), study.REFERENCE.get(name, {})
    timed = [r for r in found.values() if r.ranks <= options.cores]
    base = min(timed, key=lambda r: (r.ranks, r.loop)) if timed else None
    rows = [
        row(method, record, base, reference, options.cores) for (method, _), record in found.items()
    ]
    study.write_table(
        options.out / "scaling",
        *shown(rows, bool(reference)),
        notes(options, found, base, bool(reference)),
    )
    draw(
        options.out / "scaling.png",
        f"{name}, {options.steps} steps",
        rows,
        reference,
        options.cores,
    )
    print(options.out / "scaling.png")
    if len({r.digest for r in found.values()}) > 1:
        sys.exit("scaling: the digests differ")
