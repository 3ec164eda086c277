"""What a run has measured, column by column, and how far two of these are apart."""
import csv
import math

import numpy

from democles import plot

CLEAN = 0.2  # the order is clean if it is this near to a whole number, or the same twice
NOISE = 1e-12  # of the scale: differences below it are rounding


class Column:
    """A column of a measure over time."""

    def __init__(self, time, value, unit=""):
        self.time, self.value, self.unit = numpy.asarray(time), numpy.asarray(value), unit

    def extent(self):
        """How far it goes up and down; the largest value, of what is constant."""
        if not len(self.value):
            return 0.0
        largest, span = float(abs(self.value).max()), float(numpy.ptp(self.value))
        return span if span > NOISE * largest else largest

    def final(self):
        return float(self.value[-1]) if len(self.value) else math.nan

    def rate(self):
        """Mean over the time that is there [1/s of its unit]."""
        if len(self.time) < 2:
            return math.nan
        return float((self.value[-1] - self.value[0]) / (self.time[-1] - self.time[0]))

    def crossing(self, level):
        """When it first crosses the level, linear between its times [s]; NaN: never."""
        above = self.value >= level
        change = numpy.flatnonzero(above[1:] != above[:-1])
        if not len(change):
            return math.nan
        k = change[0]
        part = (level - self.value[k]) / (self.value[k + 1] - self.value[k])
        return float(self.time[k] + part * (self.time[k + 1] - self.time[k]))


def load(folder, names):
    """MEASURE.COLUMN -> Column, of DIR/MEASURE.csv."""
    found = {}
    for name in names:
        path = folder / (name + ".csv")
        titles, values = plot.read(path) if path.is_file() else (None, None)
        if titles is None:
            continue
        for k, (title, unit) in enumerate(titles[1:], 1):
            found[f"{name}.{title}"] = Column(values[:, 0], values[:, k], unit)
    return found


def load_file(path):
    """A file of values: (columns over time, {(column, number): value})."""
    titles, values = plot.read(path)
    if titles is not None:
        return {
            title: Column(values[:, 0], values[:, k], unit)
            for k, (title, unit) in enumerate(titles[1:], 1)
        }, {}
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row]
    try:
        return {}, {(name.strip(), what.strip()): float(value) for name, what, value in rows[1:]}
    except ValueError:
        return {}, {}


def between(time, value, at):
    """Interpolation by the cubic through four neighbours; linear for counts and short series."""
    if len(time) < 4 or numpy.array_equal(value, numpy.round(value)):
        return numpy.interp(at, time, value)
    first = numpy.clip(numpy.searchsorted(time, at) - 2, 0, len(time) - 4)
    result = numpy.zeros(len(at))
    for k in range(4):
        weight = numpy.ones(len(at))
        for m in range(4):
            if m != k:
                other = time[first + m]
                weight *= (at - other) / (time[first + k] - other)
        result += weight * value[first + k]
    return result


def meet(run, reference):
    """The values of both at the times that both have, and whether these are times of both: where
    they are not, the reference is interpolated to the run's times."""
    if len(reference.time) < 2 or len(run.time) < 2:
        n = min(len(run.time), len(reference.time))
        return run.value[:n], reference.value[:n], True
    slack = 1e-6 * float(numpy.diff(reference.time).min())
    near = numpy.searchsorted(reference.time, run.time - slack)
    near = numpy.minimum(near, len(reference.time) - 1)
    both = abs(reference.time[near] - run.time) <= slack
    if both.sum() >= max(2, 0.5 * min(len(run.time), len(reference.time))):
        return run.value[both], reference.value[near[both]], True
    inside = (run.time >= reference.time[0]) & (run.time <= reference.time[-1])
    return (
        run.value[inside],
        between(reference.time, reference.value, run.time[inside]),
        False,
    )


def root_mean_square(difference):
    return float(numpy.sqrt(numpy.mean(difference**2))) if len(difference) else math.nan


def distance(run, reference):
    """Largest and root mean square difference of two columns."""
    a, b, _ = meet(run, reference)
    if not len(a):
        return math.nan, math.nan
    return float(abs(a - b).max()), root_mean_square(a - b)


def order_of_two(coarse, fine, ratio):
    """p of errors c h^p at two sizes in this ratio."""
    return math.log(coarse / fine) / math.log(ratio) if coarse > 0 and fine > 0 else math.nan


def order_of_three(far, near, sizes):
    """p of errors c h^p whose differences between three sizes, the coarsest first, are these:
    far/near = (h1^p - h2^p)/(h2^p - h3^p), which grows with p. NaN: there is none up to 12."""
    h1, h2, h3 = (size / sizes[0] for size in sizes)
    if not (far > 0 and near > 0 and h1 > h2 > h3):
        return math.nan

    def ratio(p):
        return (h1**p - h2**p) / (h2**p - h3**p)

    low, high = 1e-3, 12.0
    if not ratio(low) < far / near < ratio(high):
        return math.nan
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if ratio(middle) < far / near else (low, middle)
    return low


def extrapolate(middle, fine, ratio, p):
    """Richardson: what the error c h^p of two sizes in this ratio leaves at h = 0."""
    a, b, same = meet(fine, middle)
    if not same or len(a) != len(fine.time):
        return None
    return Column(fine.time, a + (a - b) / (ratio**p - 1), fine.unit)


def is_clean(orders):
    """The last of them: near to a whole number, or the same as the one before."""
    if not orders[-1] > 0.5:
        return False
    near = [round(orders[-1]), *orders[-2:-1]]
    return any(abs(orders[-1] - other) <= CLEAN for other in near)


def over(value, scale):
    """value/scale; what does not differ has no error, whatever the scale."""
    if value == 0:
        return 0.0
    return value / abs(scale) if scale else math.nan


def apart(value, wanted):
    """Infinite where the reference has a value, as the time of a crossing, and the run has none."""
    return math.inf if math.isnan(value) and not math.isnan(wanted) else abs(value - wanted)


def highest(values):
    known = [value for value in values if not math.isnan(value)]
    return max(known) if known else math.nan
