"""What a study of accuracy found, in words and tables."""
import csv
import math

from democles import accuracy_errors, study

MOST_COLUMNS = 6  # of errors, in the table that people read
CLOCK = 0.01  # [s] by which runs of the same work may differ, however short
NO_TRUST = "not to be trusted"


def machine(result):
    """Device, its driver, and the program."""
    record = result.finest.record
    device = record["devices"][0]
    return (
        f"{device['name']}, {device['platform_version'].split('  ')[0]}; "
        f"democles {record['version']} ({record['git']}); {study.cores()} cores"
    )


def cell(value):
    return None if value is None or math.isnan(value) else value


def csv_rows(options, result):
    """Titles, and a row for each run and column."""
    keys = list(dict.fromkeys(key for run in result.plan.runs for key in run.setting))
    kinds = accuracy_errors.KINDS
    yield [
        *("role", "state", *keys, "ranks", "precision", "scheme", "step [s]", "steps"),
        *("force evaluations", "run time [s]", "repeats", "measure", "unit", "scale"),
        *("largest difference", "rms difference", *(f"error: {kind} [1]" for kind in kinds)),
        *("order", "final", "rate [1/s]", "crossing [s]"),
        *(f"scatter: {options.by} [1]", "verdict", "folder"),
    ]
    for run in result.plan.runs + [result.plan.reference] * bool(result.plan.reference):
        head = [run.role, run.reason or "done", *(run.setting.get(key) for key in keys)]
        if not run.is_done:
            yield head
            continue
        r = run.record
        head += [r["ranks"], r["precision"], r["scheme"], r["dt"], r["steps"]]
        head += [r["force_evaluations"], run.seconds, len(run.records)]
        for name in result.columns:
            yield head + csv_cells(options, result, run, name)


def csv_cells(options, result, run, name):
    error, numbers = result.errors[run][name], result.numbers[run][name]
    values = [
        *(result.scales[name], *result.absolute[run][name]),
        *(error[kind] for kind in accuracy_errors.KINDS),
        result.order.get(run, {}).get(name),
        *(numbers[what] for what in ("final", "rate", "crossing")),
        result.scatter.get(name, {}).get(options.by),
    ]
    return [
        *(name, result.values[run][name].unit, *map(cell, values)),
        verdict(result, run, name),
        str(run.folders[0]),
    ]


def verdict(result, run, name):
    if run is result.reference_run:
        return "reference" + f"; {NO_TRUST}" * bool(run.doubts)
    alike = "" if result.is_distinguishable(run, name) else "not distinguishable"
    return "; ".join(filter(None, [alike, NO_TRUST * bool(run.doubts)]))


def shown_columns(result):
    """The measures: for each the errors of its worst column are shown."""
    return list(dict.fromkeys(name.split(".")[0] for name in result.columns))[:MOST_COLUMNS]


def table_rows(result):
    """What people read: a row for each run."""
    measures = shown_columns(result)
    titles = ["run", "step [s]", "force evaluations", "run time [s]"]
    titles += [f"{measure}: error [%]" for measure in measures] + ["order", ""]
    rows = []
    for run in result.plan.runs:
        if not run.is_done:
            rows.append([run.label, *[None] * (len(titles) - 2), run.reason])
            continue
        r = run.record
        worst = [result.worst(run, measure) for measure in measures]
        name = result.worst(run)[1]
        order = result.order.get(run, {}).get(name, math.nan)
        if run is result.reference_run:
            name = ""
            order = max(
                (p for p in result.order.get(run, {}).values() if not math.isnan(p)),
                default=math.nan,
            )
        alike = name and not result.is_distinguishable(run, name)
        note = (
            "reference" if run is result.reference_run else "not distinguishable" if alike else ""
        )
        note = "; ".join(filter(None, [note, NO_TRUST * bool(run.doubts)]))
        errors = [None if math.isnan(error) else 100 * error for error, _ in worst]
        rows.append(
            [run.label, r["dt"], r["force_evaluations"], run.seconds, *errors, cell(order), note]
        )
    return titles, rows


def notes(options, result):
    lines = [
        f"Reference: {result.reference_text}. Errors: {options.by}, of the worst column of each "
        "measure, in per cent of its scale.",
        f"{machine(result)}.",
    ]
    if result.scatter:
        starts = [run for run in result.plan.starts if run.is_done]
        limits = ", ".join(
            f"{measure} {100 * limit:.3g} %"
            for measure in shown_columns(result)
            if (limit := result.largest_scatter(measure)) > 0
        )
        lines.append(
            f"{len(starts)} starts with {starts[0].label} differ by up to: {limits} (the worst "
            "column of each); an error that is smaller in its column is not distinguishable."
        )
    for run in [*result.runs, *filter(None, [result.plan.reference])]:
        if run.doubts:
            role = "The reference, " * (run in (result.reference_run, result.plan.reference))
            lines.append(f"{role}{run.label}{',' * bool(role)} is {NO_TRUST}: {doubts(run)}.")
    return lines + result.notes


def write(out, options, result):
    """accuracy.csv, accuracy.md; prints the latter."""
    with open(out / "accuracy.csv", "w", newline="") as file:
        csv.writer(file).writerows(csv_rows(options, result))
    text = study.table(*table_rows(result), notes(options, result))
    (out / "accuracy.md").write_text(text + "\n" + advice(options, result) + "\n")
    print(text)


def doubts(run):
    return ", ".join(run.doubts)


def write_failures(plan):
    for run in plan.runs:
        print(f"{run.label}: {run.reason}")


def advice(options, result):
    """One sentence: the cheapest setting within the target."""
    if not result.can_advise:
        return "No measure changes: there is nothing to advise by."
    target = f"{100 * options.target:.3g} %"
    runs = [run for run in result.runs if run is not result.reference_run]
    good = [run for run in runs if result.is_good(run) and not run.doubts]
    if not good:
        return none_good(result, runs, target)
    reference = result.reference_run or result.plan.reference
    rivals = [reference] if reference and not reference.doubts else []
    best = cheapest(good + rivals)
    if best is reference:
        return (
            f"The reference itself, {best.label}, is the cheapest setting within {target}: "
            f"{best.seconds:.3g} s."
        )
    return praise(options, result, best, reference, target)


def praise(options, result, best, reference, target):
    error, name = result.worst(best)
    what = f"its error ({options.by}) is {100 * error:.2g} % ({name}) in {best.seconds:.3g} s"
    if error <= options.target:
        text = f"{best.label} is the cheapest setting within {target}: {what}"
    else:
        text = f"{best.label} is the cheapest setting that cannot be told from other starts: {what}"
        scatter = 100 * result.scatter[name][options.by]
        text += f", random starts differ by {scatter:.2g} %, and less than that nobody can promise"
    if reference and best.seconds > 0:
        text += f"; the reference takes {reference.seconds / best.seconds:.3g} times as long"
    if is_coarsest(result, best):
        text += "; it is the coarsest that has run, and a coarser one may do"
    return text + "."


def cheapest(runs):
    """By time; of runs that differ by no more than clocks do, the one that computes least."""
    least = min(run.seconds for run in runs)
    near = [run for run in runs if run.seconds <= 1.1 * least + CLOCK]
    return min(
        near,
        key=lambda run: (run.record["force_evaluations"] * run.record["elements"], run.seconds),
    )


def is_coarsest(result, best):
    """Whether nothing that was tried would be cheaper in the graded key, failures included."""
    group = result.plan.group(best)
    failed = any(not run.is_done for run in result.plan.runs)
    return bool(result.plan.graded) and len(group) > 1 and group[0] is best and not failed


def none_good(result, runs, target):
    known = [run for run in runs if not math.isnan(result.worst(run)[0])]
    if not known:
        return "Nothing but the reference has run to its end: there is no error to advise by."
    trusted = [run for run in known if not run.doubts]
    if not trusted:
        return (
            f"No setting can be advised: all that are compared are {NO_TRUST}, for the reasons "
            "above; try finer ones."
        )
    best = min(trusted, key=lambda run: result.worst(run)[0])
    error, name = result.worst(best)
    return (
        f"No setting but the reference stays within {target}"
        f"{' and can be trusted' * (len(trusted) < len(known))}: the best, {best.label}, is off "
        f"by {100 * error:.2g} % ({name}); try finer ones."
    )
