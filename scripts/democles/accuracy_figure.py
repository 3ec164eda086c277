"""Pictures of a study of accuracy: errors against run time, and the curves themselves."""
import math
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib import ticker  # noqa: E402
import numpy  # noqa: E402

from democles import accuracy_report as report  # noqa: E402
from democles import accuracy_runs  # noqa: E402

MOST_PANELS, MOST_CURVES = 6, 4
LEAST = 1e-16  # an error of 0 has no place on a logarithmic axis


def errors_of(result, run, measure):
    error = result.worst(run, measure)[0]
    return max(error, LEAST) if math.isfinite(error) else math.nan


def group_label(plan, run):
    rest = [f"{accuracy_runs.short(k)}={v}" for k, v in run.setting.items() if k != plan.graded]
    return " ".join(rest) or accuracy_runs.short(plan.graded)


def draw_panel(axis, result, measure, target):
    plan = result.plan
    for n, group in enumerate(plan.groups()):
        runs = [run for run in group if run is not result.reference_run]
        points = [(run.seconds, errors_of(result, run, measure)) for run in runs]
        points = [(time, error) for time, error in points if not math.isnan(error)]
        style = "o-" if plan.graded else "o"
        axis.plot(*zip(*points) if points else ([], []), style, color=f"C{n % 10}", ms=5)
        axis.lines[-1].set_label(group_label(plan, group[0]))
        for run in runs:
            error = errors_of(result, run, measure)
            if plan.graded in run.setting and not math.isnan(error):
                axis.annotate(
                    run.setting[plan.graded],
                    (run.seconds, error),
                    xytext=(5, 4 if n % 2 == 0 else -11),
                    color=f"C{n % 10}",
                    textcoords="offset points",
                    size=8,
                )
    scatter = result.largest_scatter(measure)
    if scatter > 0:
        axis.axhline(scatter, color="0.5", ls="--", lw=1, label="scatter of starts")
    axis.axhline(target, color="0.5", ls=":", lw=1, label=f"target {100 * target:.3g} %")
    failed = [run for run in plan.runs if not run.is_done]
    for n, run in enumerate(failed):  # they have neither error nor time: at the upper edge
        at = (n + 0.5) / max(len(failed), 8)
        axis.plot(at, 0.97, "rx", ms=8, transform=axis.transAxes, clip_on=False)
        axis.text(at + 0.015, 0.97, str(n + 1), transform=axis.transAxes, size=8, va="center")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axis.xaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axis.xaxis.set_minor_formatter(ticker.NullFormatter())
    axis.margins(x=0.15, y=0.2)
    axis.set_title(measure or "worst of all measures", size=11)
    axis.grid(color="0.9", which="both")
    axis.spines[["top", "right"]].set_visible(False)


def failures(plan):
    """What the crosses stand for."""
    failed = [run for run in plan.runs if not run.is_done]
    lines = [f"{n + 1}: {run.label}: {run.reason}" for n, run in enumerate(failed)]
    return [part for line in lines for part in textwrap.wrap(line, 110)]


def draw_errors(path, name, options, result):
    measures = report.shown_columns(result)
    panels = [None, *(measures if len(measures) > 1 else [])][:MOST_PANELS]
    columns = 2 if len(panels) in (2, 4) else min(len(panels), 3)
    rows = -(-len(panels) // columns)
    lines = failures(result.plan)
    figure, axes = plt.subplots(
        rows,
        columns,
        squeeze=False,
        figsize=(max(4.2 * columns, 7), 3.6 * rows + 0.9 + 0.16 * len(lines)),
        layout="constrained",
    )
    for axis, measure in zip(axes.flat, panels):
        draw_panel(axis, result, measure, options.target)
    for axis in axes.flat[len(panels) :]:
        axis.set_visible(False)
    for axis in axes[:, 0]:
        axis.set_ylabel(f"error: {options.by} [1]")
    for axis in axes[-1]:
        axis.set_xlabel("run time [s]")
    axes[0, 0].legend(frameon=False, fontsize=8, loc="lower left")
    figure.suptitle(
        f"{name}: {result.finest.record['elements']} elements; "
        f"reference: {result.reference_text}\n{report.machine(result)}",
        size=9,
    )
    if lines:
        figure.supxlabel("\n".join(lines), size=7, x=0.02, ha="left", color="C3")
    figure.savefig(path, dpi=120)
    plt.close(figure)


def curves(result):
    """The columns that differ most, one of each measure."""
    found = []
    for measure in report.shown_columns(result):
        names = [name for name in result.columns if name.split(".")[0] == measure]
        names = [name for name in names if name in result.reference]
        errors = {
            name: max((result.errors[run][name][result.by] for run in result.runs), default=0)
            for name in names
        }
        if errors:
            found.append(max(errors, key=lambda name: numpy.nan_to_num(errors[name], nan=-1)))
    return found[:MOST_CURVES]


def draw_curves(path, name, result):
    names = curves(result)
    if not names:
        return False
    figure, axes = plt.subplots(
        2,
        len(names),
        sharex="col",
        squeeze=False,
        figsize=(max(4.5 * len(names), 7), 6.5),
        layout="constrained",
    )
    starts = [run for run in result.plan.starts[1:] if run.is_done]
    for (top, bottom), column in zip(axes.T, names):
        for run in starts:
            draw_curve(top, bottom, result, run, column, {"color": "0.7", "lw": 0.8})
        for k, run in enumerate(result.runs):
            colour = plt.get_cmap("viridis")(k / max(len(result.runs) - 1, 1) * 0.9)
            draw_curve(top, bottom, result, run, column, {"color": colour, "label": run.label})
        top.set_title(column, size=11)
        top.set_ylabel(f"[{result.reference[column].unit}]")
        bottom.set_ylabel("difference from the reference\n[% of the scale]")
        bottom.set_xlabel("time [s]")
        for axis in (top, bottom):
            axis.grid(color="0.9")
            axis.spines[["top", "right"]].set_visible(False)
    if starts:
        axes[0, 0].plot([], [], color="0.7", lw=0.8, label=f"{len(starts)} other starts")
    axes[0, 0].legend(frameon=False, fontsize=8)
    figure.suptitle(f"{name}; reference: {result.reference_text}", size=9)
    figure.savefig(path, dpi=120)
    plt.close(figure)
    return True


def draw_curve(top, bottom, result, run, column, style):
    own, reference = result.values[run][column], result.reference[column]
    top.plot(own.time, own.value, **style)
    inside = (own.time >= reference.time[0]) & (own.time <= reference.time[-1])
    wanted = numpy.interp(own.time[inside], reference.time, reference.value)
    scale = result.scales[column] or 1
    bottom.plot(own.time[inside], (own.value[inside] - wanted) / scale * 100, **style)


def draw(out, name, options, result):
    """accuracy.png and, where there are curves, curves.png; returns their paths."""
    draw_errors(out / "accuracy.png", name, options, result)
    has_curves = draw_curves(out / "curves.png", name, result)
    return [out / "accuracy.png", *[out / "curves.png"] * has_curves]
