"""Plots of what a run measured: one PNG per time series, DIR/NAME.csv -> DIR/NAME.png.
Columns of one unit share an axis.

    scripts/plot.py DIR [NAME...]            all series, or those named"""
import argparse
import csv
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402


DASHES = ("-", "--", "-.", ":")


def read(path):
    """Titles [(name, unit)] and values [n_row][n_column].
    A last line that a crash has cut short is left out."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    if not rows or not rows[0] or not rows[0][0].startswith("time ["):
        return None, None
    titles = [
        re.fullmatch(r"(.*?)(?: \[(.*)\])?", title, re.DOTALL).groups(default="")
        for title in rows[0]
    ]
    values = [[float(v) for v in row] for row in rows[1:] if len(row) == len(titles) and all(row)]
    return titles, numpy.array(values).reshape(len(values), len(titles))


def axis_label(names, unit):
    """The unit with the name, where there is one name only."""
    shown = "" if unit in ("", "1") else f"[{unit}]"
    return " ".join(
        part for part in (names[0].replace("_", " ") if len(names) == 1 else "", shown) if part
    )


def draw(path, titles, values):
    units = list(dict.fromkeys(unit for _, unit in titles[1:]))
    figure, axes = plt.subplots(
        len(units),
        1,
        sharex=True,
        squeeze=False,
        figsize=(8, 1 + 3.5 * len(units)),
        layout="constrained",
    )
    for axis, unit in zip(axes[:, 0], units):
        columns = [k for k in range(1, len(titles)) if titles[k][1] == unit]
        names = [titles[k][0] for k in columns]
        # ten colours that are easily told apart;
        # more lines take theirs from a scale and differ by dashes
        colours = (
            plt.get_cmap("tab10").colors
            if len(columns) <= 10
            else plt.get_cmap("turbo")(numpy.linspace(0.05, 0.95, len(columns)))
        )
        for n, (k, name) in enumerate(zip(columns, names)):
            style = DASHES[n % len(DASHES)] if len(columns) > 10 else "-"
            marker = "o" if len(values) < 2 else None
            axis.plot(
                values[:, 0],
                values[:, k],
                color=colours[n],
                ls=style,
                label=name.replace("_", " "),
                lw=1.4,
                marker=marker,
            )
        axis.set_ylabel(axis_label(names, unit), size=12)
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
        axis.margins(x=0.01)
        if len(columns) > 1:
            axis.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    axes[-1, 0].set_xlabel(f"time [{titles[0][1]}]", size=12)
    figure.suptitle(path.stem.replace("_", " "), size=14, weight="bold")
    out = path.with_suffix(".png")
    figure.savefig(out, dpi=120)
    plt.close(figure)
    print(out)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dir", metavar="DIR", type=pathlib.Path, help="folder of results")
    parser.add_argument("name", metavar="NAME", nargs="*", help="name of a measure")
    options = parser.parse_args()
    if not options.dir.is_dir():
        sys.exit(f"plot: there is no folder {options.dir}")
    paths = [options.dir / (name + ".csv") for name in options.name] or sorted(
        options.dir.glob("*.csv")
    )
    for path in paths:
        if not path.is_file():
            sys.exit(f"plot: there is no {path}")
        titles, values = read(path)
        if titles is None or len(titles) < 2:
            if options.name:
                sys.exit(f"plot: {path} is not a time series")
            continue  # a CSV of the user's own
        draw(path, titles, values)
