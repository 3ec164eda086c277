"""Predicts the time of a step on a described machine from measured runs: strong scaling (the same
elements on more devices) and weak scaling (as many on each). What it assumes is printed with the
result.

    scripts/scaling.py l_box --profile --ranks 1,2,8,64
    scripts/model.py out/scaling/l_box/geometric_* --machine cluster.yaml --ranks 1,2,4,8,16,32,64
    scripts/model.py --check out/scaling/l_box/geometric_1 out/scaling/l_box/geometric_2

A run is a folder of results or its run.json. That on fewest ranks gives the rates (best with
--profile); those on more ranks give imbalance, bytes and messages at their number of ranks. A
machine is a YAML file with any of these keys, or the options of the same names:

    bandwidth: 10                    # of a device's memory, relative to that of the measured runs
    launch_s: 8e-6                   # of one kernel; default: as measured
    network_bytes_per_s: 1.2e10      # of one rank
    network_latency_s: 2e-6          # of one message
    link_bytes_per_s: 2e10           # between device and host; default: no cost, they share memory

--check takes rates from the first run and predicts the second, and itself, on the machine that
measured them."""
import argparse
import dataclasses
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import yaml  # noqa: E402

from democles import places, study  # noqa: E402


@dataclasses.dataclass
class Machine:
    bandwidth: float = 1.0  # relative
    launch_s: float = None
    network_bytes_per_s: float = 1e10
    network_latency_s: float = 2e-6
    link_bytes_per_s: float = None


@dataclasses.dataclass
class Rates:
    """Of one step on the measured device."""

    kernel_s: float  # per element
    regroup_s: float  # per element
    launches: float  # per rank
    launch_s: float  # what the host and the device need for each, besides the kernel itself


@dataclasses.dataclass
class Traffic:
    """Of one rank and step, means over ranks; imbalance of the run."""

    messages: float
    bytes: float
    boundary: float  # elements that are sent, each time
    imbalance: float
    exchanges: float  # per step: messages over neighbours
    launches: float
    source: str


def rates_of(record):
    """From a run, best on one rank.
    Kernels that do not run in each step belong to the regroup. Without kernel times launches are
    part of them."""
    compute, mine = record.per_step("compute"), record.elements / record.ranks
    plain = record.raw["plain_steps"]
    launches = plain["launches"] / max(plain["steps"], 1) / record.ranks
    kernels = record.of("kernels")  # of rank 0
    of_steps = (
        [k["seconds"] for k in kernels.values() if k["launches"] >= record.steps] if kernels else []
    )
    kernel = min(sum(of_steps) / record.steps, compute) if kernels else compute
    return Rates(
        kernel / mine,
        record.per_step("regroup") / mine,
        launches,
        (compute - kernel) / launches if launches > 0 else 0,
    )


def faces(ranks):
    """Mean number of a subdomain's faces that have a neighbour:
    of a cube cut into p x p x p, p = ranks^(1/3), 6 (1 - 1/p)."""
    return 6 * (1 - ranks ** (-1 / 3))


def neighbours(ranks):
    """The same with edges and corners: (3 - 2/p)^3 - 1, at most all others."""
    return min(ranks - 1, (3 - 2 * ranks ** (-1 / 3)) ** 3 - 1)


def measured_traffic(record):
    sent, plain = record.raw["exchange"], record.raw["plain_steps"]
    n = sent["neighbours"]["mean"]
    return Traffic(
        sent["messages"]["mean"],
        sent["bytes"]["mean"],
        sent["elements"]["mean"],
        record.imbalance(),
        sent["messages"]["mean"] / n if n else 1,
        plain["launches"] / max(plain["steps"], 1) / record.ranks,
        "measured",
    )


def traffic_at(ranks, per_rank, records, rates):
    """Measured, where a run on so many ranks had as many elements on each; else by the surface of a
    cube, from the run that is next in ranks."""
    if ranks == 1:
        return Traffic(0, 0, 0, 0, 1, rates.launches, "none")
    many = [r for r in records if r.ranks > 1]
    for r in many:
        if r.ranks == ranks and abs(r.elements / r.ranks / per_rank - 1) < 0.01:
            return measured_traffic(r)
    if not many:
        raise SystemExit(
            "model: more than one rank can be predicted only from a run on more than one, which "
            "tells what is sent"
        )
    near = min(many, key=lambda r: abs(math.log(r.ranks / ranks)))
    known = measured_traffic(near)
    grown = (per_rank / (near.elements / near.ranks)) ** (2 / 3) * faces(ranks) / faces(near.ranks)
    return Traffic(
        known.exchanges * neighbours(ranks),
        known.bytes * grown,
        known.boundary * grown,
        known.imbalance,
        known.exchanges,
        known.launches,
        f"surface, from {near.ranks}",
    )


def step_time(per_rank, traffic, rates, machine):
    """Parts of a step [s] on the rank with most work: launches, kernels,
    what of the exchange is not hidden, regroup."""
    launch = machine.launch_s if machine.launch_s is not None else rates.launch_s
    kernels = rates.kernel_s * per_rank * (1 + traffic.imbalance) / machine.bandwidth
    link = 2 * traffic.bytes / machine.link_bytes_per_s if machine.link_bytes_per_s else 0
    exchange = (
        traffic.messages * machine.network_latency_s
        + traffic.bytes / machine.network_bytes_per_s
        + link
    )
    interior = kernels * (1 - min(1, traffic.boundary / per_rank))
    return {
        "launches": traffic.launches * launch,
        "kernels": kernels,
        "exchange": max(0, exchange - interior),
        "regroup": rates.regroup_s * per_rank / machine.bandwidth,
    }


def assumptions(rates, machine, records):
    launch = machine.launch_s if machine.launch_s is not None else rates.launch_s
    link = f"{machine.link_bytes_per_s:.3g} B/s" if machine.link_bytes_per_s else "no cost"
    device, first = records[0].raw["devices"][0]["name"], records[0].ranks
    without = (
        "" if records[0].of("kernels") else ", without kernel times: launches are in the kernels"
    )
    return [
        f"Rates: {rates.kernel_s * 1e9:.3g} ns of kernels and {rates.regroup_s * 1e9:.3g} ns "
        "of regroup per element and step, "
        f"{rates.launches:.3g} launches per step, "
        f"{rates.launch_s * 1e6:.3g} us each besides the kernel; "
        f"from {device}, {first} rank{'s' if first > 1 else ''}{without}.",
        f"Machine: memory {machine.bandwidth:.3g} times as fast, {launch * 1e6:.3g} us per "
        f"launch, network {machine.network_bytes_per_s:.3g} B/s "
        f"and {machine.network_latency_s * 1e6:.3g} us per message for each rank, device to host "
        f"{link}.",
        "Assumed: kernels and regroup take time in proportion to elements and to memory; the "
        "slowest rank, 1 + U times the mean, sets the pace;",
        "messages leave one after the other and hide under the kernels of the interior, the share "
        "of elements that nobody else needs;",
        "where no run has measured it, what is sent goes with the surface of a cubic subdomain, "
        "neighbours with its faces, edges, corners, and U",
        "stays that of the run next in ranks. Not in it: collectives, output, a network that "
        "slows when all send.",
    ]


TITLES = [
    "scaling",
    "ranks",
    "elements per rank",
    "U [1]",
    "sent per rank [kB]",
    "messages per rank",
    "traffic",
    "launches [us]",
    "kernels [us]",
    "exchange not hidden [us]",
    "regroup [us]",
    "step [us]",
    "speed-up",
    "efficiency [%]",
]


def predict(kind, ranks, elements, records, rates, machine):
    """Rows of a table. elements: of all ranks (strong), or of each (weak)."""
    rows, alone = [], sum(
        step_time(elements, traffic_at(1, elements, records, rates), rates, machine).values()
    )
    for n in ranks:
        per_rank = elements / n if kind == "strong" else elements
        t = traffic_at(n, per_rank, records, rates)
        parts = step_time(per_rank, t, rates, machine)
        step = sum(parts.values())
        speed = alone / step * (1 if kind == "strong" else n)
        rows.append(
            [
                kind,
                n,
                per_rank,
                t.imbalance,
                t.bytes / 1e3,
                t.messages,
                t.source,
                *(1e6 * p for p in parts.values()),
                1e6 * step,
                speed,
                100 * speed / n,
            ]
        )
    return rows


def check(paths, machine):
    """Rows: predicted and measured time of a step of each run, with the rates of the first."""
    records = [study.Record(p) for p in paths]
    rates, rows = rates_of(records[0]), []
    for r in records:
        per_rank = r.elements / r.ranks
        step = sum(
            step_time(
                per_rank, traffic_at(r.ranks, per_rank, records, rates), rates, machine
            ).values()
        )
        rows.append(
            [
                r.ranks,
                r.elements,
                1e6 * step,
                1e6 * r.loop / r.steps,
                100 * (step * r.steps / r.loop - 1),
            ]
        )
    return records, rates, rows


def draw(path, rows):
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    ranks = sorted({r[1] for r in rows})
    for kind, marker in (("strong", "o-"), ("weak", "s--")):
        mine = [r for r in rows if r[0] == kind]
        axes[0].plot([r[1] for r in mine], [r[11] for r in mine], marker, label=kind)
        axes[1].plot([r[1] for r in mine], [r[13] for r in mine], marker, label=kind)
    axes[0].set_yscale("log")
    axes[0].set_ylabel("step [us]")
    axes[1].set_ylabel("efficiency [%]")
    axes[1].set_ylim(0)
    for axis in axes:
        axis.set_xscale("log", base=2)
        axis.set_xticks(ranks, [str(r) for r in ranks])
        axis.minorticks_off()
        axis.set_xlabel("ranks")
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].legend(frameon=False)
    figure.suptitle("predicted, not measured")
    figure.savefig(path, dpi=120)


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("runs", nargs="*", metavar="RUN", help="folders of results, or run.json")
    parser.add_argument(
        "--check", nargs="+", metavar="RUN", help="predict these from the first, and compare"
    )
    parser.add_argument("--machine", type=pathlib.Path, metavar="FILE", help="YAML, see above")
    parser.add_argument(
        "--ranks",
        type=study.numbers,
        default=[1, 2, 4, 8, 16, 32, 64, 128],
        help="(default: 1,2,4,...,128)",
    )
    parser.add_argument(
        "--elements",
        type=float,
        help="strong scaling: of all ranks (default: as measured); weak: the same on each",
    )
    for field in dataclasses.fields(Machine):
        parser.add_argument(
            "--" + field.name.replace("_", "-"), type=float, metavar="X", help="of the machine"
        )
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=places.OUT / "model",
        help="folder of the results (default: out/model)",
    )
    options = parser.parse_args()
    if bool(options.runs) == bool(options.check):
        parser.error("either RUN..., or --check RUN...")
    return options


def machine_of(options):
    given = yaml.safe_load(options.machine.read_text()) or {} if options.machine else {}
    names = [f.name for f in dataclasses.fields(Machine)]
    wrong = [key for key in given if key not in names]
    if wrong:
        sys.exit(
            f"model: {options.machine}: unknown key '{wrong[0]}'; there are {', '.join(names)}"
        )
    given.update({n: getattr(options, n) for n in names if getattr(options, n) is not None})
    return Machine(
        **{name: float(value) for name, value in given.items()}
    )  # YAML 1.1 takes 2e-6 for text


def main():
    options = arguments()
    machine = machine_of(options)
    options.out.mkdir(parents=True, exist_ok=True)
    if options.check:
        records, rates, rows = check(options.check, machine)
        titles = ["ranks", "elements", "predicted step [us]", "measured step [us]", "off by [%]"]
        study.write_table(options.out / "check", titles, rows, assumptions(rates, machine, records))
        return
    records = sorted((study.Record(p) for p in options.runs), key=lambda r: r.ranks)
    rates = rates_of(records[0])
    elements = options.elements or records[0].elements
    rows = [
        row
        for kind in ("strong", "weak")
        for row in predict(kind, options.ranks, elements, records, rates, machine)
    ]
    study.write_table(options.out / "model", TITLES, rows, assumptions(rates, machine, records))
    draw(options.out / "model.png", rows)
    print(options.out / "model.png")
