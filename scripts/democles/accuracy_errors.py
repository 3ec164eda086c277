"""Errors of the runs of a study against its reference, their order, and the scatter of starts."""
import math
import sys

import numpy

from democles import accuracy_series as series

KINDS = ("largest", "rms", "final", "rate", "crossing")
FLOOR = 1e-11  # of the scale: below it there is no order, rounding is part of the error


class Study:
    """plan with its runs done -> errors.

    columns        MEASURE.COLUMN, in the order of the reference
    errors[run]    column -> {kind: error [1]}
    absolute[run]  column -> (largest, rms) in the column's unit
    numbers[run]   column -> {final, rate, crossing}
    order[run]     column -> observed order with the next coarser ones
    scatter        column -> {kind: largest between two starts [1]}"""

    def __init__(self, options, plan):
        self.options, self.plan, self.by = options, plan, options.by
        self.runs = [run for run in plan.runs if run.is_done]
        self.values, self.order, self.notes, self.unknown = {}, {}, [], set()
        for run in [*self.runs, *filter(None, [plan.reference]), *plan.starts]:
            if run.is_done:
                self.values[run] = self.load(run)
        self.finest = min(self.runs, key=lambda run: run.fineness())
        self.reference_run, self.fixed, self.clean = None, {}, None
        self.reference, self.reference_text = self.find_reference()
        self.choose_columns()
        self.can_advise = self.leave_out_unchanging()
        if self.clean is not None:
            self.take_extrapolated()
        self.scales = {name: self.scale(name) for name in self.columns}
        self.levels = {name: self.level(name) for name in self.columns}
        self.compare_all()
        self.scatter = self.find_scatter()

    def load(self, run):
        folder = run.folders[0]
        found = series.load(folder, sorted(p.stem for p in folder.glob("*.csv")))
        if not found:
            sys.exit(
                "accuracy: the scene measures nothing; `democles explain measure` says what it can"
            )
        return found

    def find_reference(self):
        """Columns of the reference, and a word for it."""
        options, plan = self.options, self.plan
        if options.reference_file:
            columns, self.fixed = series.load_file(options.reference_file)
            if not columns and not self.fixed:
                sys.exit(f"accuracy: {options.reference_file} has no columns and no values")
            return columns, str(options.reference_file)
        if plan.reference:
            if not plan.reference.is_done:
                sys.exit(
                    f"accuracy: the reference, {plan.reference.label}: {plan.reference.reason}"
                )
            return self.values[plan.reference], plan.reference.label
        self.reference_run = self.finest
        if options.reference == "richardson":
            self.clean = self.extrapolated()
        return dict(self.values[self.finest]), f"{self.finest.label}, the finest"

    def take_extrapolated(self):
        """Of the chosen columns those that are clean; of the others the finest run stands, whose
        own error is then not known."""
        clean = {name: column for name, column in self.clean.items() if name in self.columns}
        rest = [name for name in self.columns if name not in clean]
        if not clean:
            self.notes.append("No order is clean: nothing is extrapolated, the finest run stands.")
            return
        if rest:
            self.notes.append(
                f"Not extrapolated, since their order is not clean: {', '.join(rest)}. There the "
                "finest run is the reference."
            )
        self.reference.update(clean)
        self.unknown = {(self.finest, name) for name in rest}
        self.reference_run, self.reference_text = None, "Richardson's extrapolation"

    def extrapolated(self):
        """Of the columns whose order is clean in the finest group."""
        group = self.plan.group(self.finest)
        found = {}
        if len(group) < 3:
            return found
        sizes = [run.size(self.plan.graded) for run in group]
        for name, fine in self.values[self.finest].items():
            orders = [
                self.three(name, group[k - 2 : k + 1], sizes[k - 2 : k + 1])
                for k in range(2, len(group))
            ]
            if series.is_clean(orders):
                middle = self.values[group[-2]][name]
                column = series.extrapolate(middle, fine, sizes[-2] / sizes[-1], orders[-1])
                if column:
                    found[name] = column
        return found

    def three(self, name, runs, sizes):
        """Order that the differences of three runs show."""
        a, b, c = (self.values[run].get(name) for run in runs)
        if not (a and b and c) or not all(sizes):
            return math.nan
        far, near = series.distance(a, b)[1], series.distance(b, c)[1]
        if near <= FLOOR * c.extent():
            return math.nan
        return series.order_of_three(far, near, sizes)

    def choose_columns(self):
        """Those that are asked for, and that the reference has."""
        known = list(self.reference) + [name for name, _ in self.fixed]
        own = self.values[self.runs[0]]
        self.columns = [name for name in dict.fromkeys(known) if name in own]
        for word in self.options.measure or []:
            if not any(self.is_part(name, word) for name in self.columns):
                sys.exit(f"accuracy: there is no {word}; there are {', '.join(self.columns)}")
        if self.options.measure:
            self.columns = [
                name
                for name in self.columns
                if any(self.is_part(name, word) for word in self.options.measure)
            ]
        if not self.columns:
            sys.exit(f"accuracy: the reference has none of {', '.join(own)}")
        for word, _, _ in self.options.crossing:
            if not any(self.is_part(name, word) for name in self.columns):
                sys.exit(f"accuracy: --crossing: there is no {word}")

    def leave_out_unchanging(self):
        """Measures that tell nothing, since no run changes them; returns whether one is left."""
        still = [name for name in self.columns if self.is_unchanging(name)]
        of = {name: name.split(".")[0] for name in self.columns}
        moving = {of[name] for name in self.columns if name not in still}
        for measure in dict.fromkeys(of.values()):
            if measure not in moving:
                self.notes.append(f"{measure} does not change: nothing is compared.")
        if moving:
            self.columns = [name for name in self.columns if of[name] in moving]
        return bool(moving)

    def is_unchanging(self, name):
        """The same at all times, in all runs and in the reference."""
        if any(name == other for other, _ in self.fixed):
            return False
        columns = [self.values[run][name] for run in self.runs] + [self.reference[name]]
        values = numpy.concatenate([column.value for column in columns])
        largest = float(abs(values).max()) if len(values) else 0.0
        return not len(values) or float(numpy.ptp(values)) <= series.NOISE * largest

    @staticmethod
    def is_part(name, word):
        return name == word or name.startswith(word + ".")

    def scale(self, name):
        """What an error is relative to: the farthest column of the measure in its unit."""
        for word, value in self.options.scale:
            if self.is_part(name, word):
                return float(value)
        source = self.reference if name in self.reference else self.values[self.runs[0]]
        measure = name.split(".")[0]
        return max(
            column.extent()
            for other, column in source.items()
            if other.split(".")[0] == measure and column.unit == source[name].unit
        )

    def level(self, name):
        """The value whose crossing is looked for, or None."""
        for word, relative, value in self.options.crossing:
            if self.is_part(name, word):
                if not relative:
                    return value
                source = self.reference.get(name) or self.values[self.finest][name]
                return value * float(source.value.max())
        return None

    def derived(self, name, column):
        level = self.levels[name]
        return {
            "final": column.final(),
            "rate": column.rate(),
            "crossing": math.nan if level is None else column.crossing(level),
        }

    def wanted(self, name):
        """Derived numbers of the reference."""
        found = dict.fromkeys(("final", "rate", "crossing"), math.nan)
        if name in self.reference:
            found = self.derived(name, self.reference[name])
        return {what: self.fixed.get((name, what), value) for what, value in found.items()}

    def relative(self, name, column, reference, wanted):
        """{kind: error [1]} and (largest, rms) in the column's unit."""
        scale = self.scales[name]
        far = series.distance(column, reference) if reference else (math.nan, math.nan)
        own, span = self.derived(name, column), float(column.time[-1] - column.time[0])
        unit = {"final": scale, "rate": scale / span if span > 0 else math.nan}
        unit["crossing"] = wanted["crossing"]
        numbers = {what: series.apart(own[what], wanted[what]) for what in own}
        for what in own:
            if (name, what) in self.fixed:
                unit[what] = abs(self.fixed[name, what])
        return {
            "largest": series.over(far[0], scale),
            "rms": series.over(far[1], scale),
            **{what: series.over(value, unit[what]) for what, value in numbers.items()},
        }, far

    def compare_all(self):
        self.errors, self.absolute, self.numbers = {}, {}, {}
        for run in [*self.runs, *filter(None, [self.plan.reference])]:
            own, pairs = self.values[run], {}
            for name in self.columns:
                reference = self.reference.get(name)
                pairs[name] = self.relative(name, own[name], reference, self.wanted(name))
                if (run, name) in self.unknown:
                    pairs[name] = dict.fromkeys(KINDS, math.nan), (math.nan, math.nan)
            self.errors[run] = {name: pair[0] for name, pair in pairs.items()}
            self.absolute[run] = {name: pair[1] for name, pair in pairs.items()}
            self.numbers[run] = {name: self.derived(name, own[name]) for name in self.columns}
        for group in self.plan.groups():
            self.find_orders(group)
        if any(not self.has_same_times(run) for run in self.runs):
            self.notes.append(
                "Where runs have no times in common the reference is interpolated, which is an "
                "error of its own: steps that divide `every` of the measures avoid it."
            )

    def has_same_times(self, run):
        return all(
            series.meet(self.values[run][name], self.reference[name])[2]
            for name in self.columns
            if name in self.reference
        )

    def find_orders(self, group):
        """Errors tell the order where their reference is another one than the finest of the group;
        else the differences of three runs do."""
        graded = self.plan.graded
        for k, run in enumerate(group):
            self.order[run] = dict.fromkeys(self.columns, math.nan)
            sizes = [r.size(graded) for r in group[max(k - 2, 0) : k + 1]] if graded else []
            for name in self.columns if k > 0 and all(sizes) else []:
                if self.reference_run in group or (self.finest, name) in self.unknown:
                    if k > 1:
                        self.order[run][name] = self.three(name, group[k - 2 : k + 1], sizes)
                    continue
                two = [self.errors[r][name]["rms"] for r in group[k - 1 : k + 1]]
                if two[1] > FLOOR and sizes[-2] > sizes[-1]:
                    self.order[run][name] = series.order_of_two(*two, sizes[-2] / sizes[-1])

    def find_scatter(self):
        starts = [run for run in self.plan.starts if run.is_done]
        if len(starts) < 2:
            return {}
        found = {}
        for name in self.columns:
            pairs = [
                self.relative(
                    name,
                    self.values[a][name],
                    self.values[b][name],
                    self.derived(name, self.values[b][name]),
                )[0]
                for k, a in enumerate(starts)
                for b in starts[:k]
            ]
            found[name] = {kind: series.highest(pair[kind] for pair in pairs) for kind in KINDS}
        return found

    def largest_scatter(self, measure=None):
        """Of the columns of a measure, or of all; NaN: none is known."""
        return series.highest(
            limit[self.by]
            for name, limit in self.scatter.items()
            if measure in (None, name.split(".")[0])
        )

    def is_distinguishable(self, run, name):
        """Whether the error is above what two starts differ by."""
        limit = self.scatter.get(name, {}).get(self.by, math.nan)
        return not self.errors[run][name][self.by] <= limit

    def worst(self, run, measure=None):
        """Largest error of all columns, or of a measure's, and its column. What can be told from
        the scatter comes first. NaN: none has one."""
        names = [name for name in self.columns if measure in (None, name.split(".")[0])]
        names = [name for name in names if not math.isnan(self.errors[run][name][self.by])]
        told = [name for name in names if self.is_distinguishable(run, name)]
        pairs = [(self.errors[run][name][self.by], name) for name in told or names]
        return max(pairs) if pairs else (math.nan, "")

    def is_good(self, run):
        """Within the target, or not distinguishable, in every column that has an error."""
        return not math.isnan(self.worst(run)[0]) and all(
            math.isnan(error[self.by])
            or error[self.by] <= self.options.target
            or not self.is_distinguishable(run, name)
            for name, error in self.errors[run].items()
        )
