"""Error against run time of a scene of one's own: which settings are accurate enough, and which of
those is the cheapest. Runs the scene with every combination of the settings that are named,
compares what it measures with a reference, and advises.

    scripts/accuracy.py v_funnel --vary time.step=4e-5,2e-5,1e-5,5e-6 --starts 3 --by rate
    scripts/accuracy.py my/scene.yaml --vary time.step=2e-6,1e-6,5e-7 --reference richardson
    scripts/accuracy.py plate --vary precision=double,mixed,single --vary time.scheme=leapfrog,pefrl
    scripts/accuracy.py my.yaml --vary materials.a.young,materials.b.young=1e7,1e8 --target 2%

Each measure of the scene has an error: the largest difference of each column from the reference,
and its root mean square over the times that both have, over the scale of the column: how far it
goes up and down in the reference, or the farthest column of its unit. Scenes whose details are
chaotic, as flows are, need --starts: runs that differ in nothing but their random numbers show how
far apart equally good runs are; an error below that is called not distinguishable.

Writes accuracy.csv (a line per run and column), accuracy.md, accuracy.png and curves.png into
out/accuracy/NAME, beside the runs, which are kept: what has run is not repeated unless the scene,
its files or the program change. Settings that fail stand there with their reason;
runs that say that they are not to be trusted (trust in run.json) are marked and not advised."""
import argparse
import math
import pathlib
import sys

from democles import accuracy_errors, accuracy_figure, accuracy_report, accuracy_runs
from democles import places, study


def share(text):
    """Turns "1%" or "0.01" into 0.01."""
    try:
        value = float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"'{text}' is no number, as 1% or 0.01")
    return value


def above_zero(text):
    """A share, or a number, that something can be measured by."""
    value = share(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not above 0")
    return value


def count(least):
    """The type of whole numbers from this one on."""
    return lambda text: accuracy_runs.whole(text, least)


def scale(text):
    """MEASURE.COLUMN=VALUE"""
    name, value = accuracy_runs.fixed(text)
    return name, above_zero(value)


def crossing(text):
    """MEASURE[.COLUMN]=VALUE: the value is a number, or a share of the reference's largest."""
    name, equals, value = text.rpartition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"'{text}' is not MEASURE.COLUMN=VALUE")
    return name, value.endswith("%"), share(value)


def add_runs(parser):
    """The options that say what runs."""
    parser.add_argument("scene", metavar="CASE|SCENE", help="a folder of cases/, or a scene")
    parser.add_argument(
        "--vary",
        action="append",
        required=True,
        type=accuracy_runs.vary,
        metavar="KEY[,KEY]=V1,V2",
        help="a key that --set takes, `ranks` or `device`, and its values; several keys take the "
        "same value; may be repeated: all combinations run",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        type=accuracy_runs.setting,
        metavar="KEY=VALUE",
        help="a key of all runs; may be repeated",
    )
    parser.add_argument(
        "--repeats",
        type=count(1),
        help="runs whose median is the run time "
        "(default: 3 where it is below 10 s, or twice that of others for the same work; else 1)",
    )
    parser.add_argument(
        "--starts",
        type=count(0),
        default=0,
        help="further runs of one setting with other random numbers (default: none)",
    )
    parser.add_argument(
        "--starts-at",
        type=accuracy_runs.settings,
        metavar="KEY=V,...",
        help="the setting that they have (default: the second of the list)",
    )
    parser.add_argument(
        "--starts-key",
        action="append",
        metavar="KEY",
        help="the key that they count up (default: every `seed` of the scene)",
    )


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_runs(parser)
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--reference",
        default="finest",
        metavar="finest|richardson|KEY=V,...",
        help="the finest of the runs; what the finest three extrapolate to, where their order is "
        "clean; or a run of its own with these settings (default: finest)",
    )
    group.add_argument(
        "--reference-file",
        type=pathlib.Path,
        metavar="CSV",
        help="columns `time [s]` and MEASURE.COLUMN; or lines of MEASURE.COLUMN,NUMBER,VALUE with "
        "NUMBER: final, rate or crossing",
    )
    parser.add_argument(
        "--measure",
        action="append",
        metavar="NAME[.COLUMN]",
        help="only this one; may be repeated (default: all of the scene)",
    )
    parser.add_argument(
        "--scale",
        action="append",
        default=[],
        type=scale,
        metavar="MEASURE.COLUMN=VALUE",
        help="what its error is relative to; may be repeated",
    )
    parser.add_argument(
        "--crossing",
        action="append",
        default=[],
        type=crossing,
        metavar="MEASURE.COLUMN=VALUE",
        help="looks when this value is crossed; 50%% is that of the reference's largest",
    )
    parser.add_argument(
        "--by",
        choices=accuracy_errors.KINDS,
        default="largest",
        help="the error that figure and advice go by (default: largest)",
    )
    parser.add_argument(
        "--target", type=above_zero, default=0.01, help="the error that is asked for (default: 1%%)"
    )
    parser.add_argument("--no-figures", action="store_true", help="writes the tables alone")
    parser.add_argument("--out", type=pathlib.Path, help="folder for the results")
    parser.add_argument(
        "--program", default=places.program(), help="path of democles (default: %(default)s)"
    )
    return parser.parse_args()


def main():
    options = arguments()
    scene, name = study.find_scene("accuracy", options.scene)
    out = options.out or pathlib.Path("out/accuracy") / name
    study.end_by_signals()
    with study.take_folder("accuracy", out, scene, options.out is not None):
        compare(options, scene, name, out)


def compare(options, scene, name, out):
    """Runs and results, in a folder that nobody else writes into."""
    runner = accuracy_runs.Runner(options.program, scene, out / "runs", dict(options.set))
    plan = accuracy_runs.plan(options, runner)
    runner.run_all(plan, options.repeats, options.reference_file is not None)
    if not any(run.is_done for run in plan.runs):
        accuracy_report.write_failures(plan)
        sys.exit("accuracy: no run has come to its end")
    result = accuracy_errors.Study(options, plan)
    accuracy_report.write(out, options, result)
    if not options.no_figures:
        print(*accuracy_figure.draw(out, name, options, result), sep="\n")
    print(accuracy_report.advice(options, result))
