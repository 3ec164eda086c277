"""Frames that somebody has made to harm: changed in their contents, with checksums that are right
(src/results/h5_check.h). CRAFTS are named changes of an open file: those of the structure, which
the check of frames finds, and those of the contents, which the reader finds."""
import h5py
import numpy

G = numpy.uint64(0x9E3779B97F4A7C15)


def mix(z):
    """The finaliser of splitmix64 (src/results/digest.h)."""
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        z = (z ^ (z >> numpy.uint64(shift))) * numpy.uint64(factor)
    return z ^ (z >> numpy.uint64(31))


def checksum(values):
    flat = numpy.frombuffer(
        numpy.ascontiguousarray(values).tobytes(), values.dtype.newbyteorder("=")
    )
    if flat.dtype.kind == "S":
        flat = numpy.frombuffer(flat.tobytes(), numpy.uint8)
    bits = flat.view(f"u{flat.dtype.itemsize}").astype(numpy.uint64)
    with numpy.errstate(over="ignore"):
        return mix(mix(numpy.arange(len(bits), dtype=numpy.uint64) + G) ^ bits).sum(
            dtype=numpy.uint64
        )


def sign(dataset):
    values = dataset[()]
    dataset.attrs.modify("checksum", checksum(values))


def replace(file, path, values, **how):
    """Another dataset under the name, with a checksum as good as there is one."""
    del file[path]
    dataset = file.create_dataset(path, data=values, **how)
    try:
        sum_of_it = checksum(numpy.asarray(values))
    except (TypeError, ValueError):
        sum_of_it = numpy.uint64(0)
    dataset.attrs["checksum"] = sum_of_it


def edit(path, row, value):
    """One row of a column, or the first number of it."""

    def change(file):
        dataset = file[path]
        values = dataset[()]
        values[row] = value
        dataset[...] = values
        sign(dataset)

    return change


def attribute(name, value):
    def change(file):
        del file["democles"].attrs[name]
        file["democles"].attrs[name] = value

    return change


def make(name, value, **how):
    """A column in another shape or type."""
    return lambda file: replace(file, name, value(file[name][()]), **how)


def group(change):
    return lambda file: change(file["democles"])


def link_to(path, link):
    def change(file):
        del file[path]
        file[path] = link

    return change


def cycle(state):
    state["loop"] = state


def deep(state):
    for _ in range(100):
        state = state.create_group("deeper")


def many(state):
    for k in range(12000):
        state.create_group(f"group{k}")


def outside(file):
    """Rows that lie in another file."""
    path = "democles/rows/" + next(iter(file["democles/rows"]))
    n = len(file[path])
    del file[path]
    space, plist = h5py.h5s.create_simple((n,)), h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plist.set_external(b"/etc/passwd", 0, 8 * n)
    h5py.h5d.create(file.id, path.encode(), h5py.h5t.STD_I64LE, space, plist)
    file[path].attrs["checksum"] = numpy.uint64(0)


def twice(path):
    def change(file):
        values = file[path][()]
        values[-1] = values[0]
        file[path][...] = values
        sign(file[path])

    return change


STRUCTURE = {
    **{
        f"{name} as a thousand": attribute(name, numpy.full(1000, 1))
        for name in ("step", "dt", "format_version", "n_dataset", "inputs", "n_removed")
    },
    "step as a text": attribute("step", "one"),
    "step below 0": attribute("step", numpy.int64(-1)),
    "dt of 0": attribute("dt", 0.0),
    "dt not a number": attribute("dt", float("nan")),
    "looks before the start": attribute("limit_at", numpy.int64(-5)),
    "lists rebuilt too often": attribute("n_rebuild", numpy.int64(2**63 - 1)),
    "fifty texts": make(
        "democles/resolved", lambda v: numpy.array([b"x" * 4000] * 50)[:, None, None]
    ),
    "text of any length": lambda f: replace(
        f, "democles/resolved", ["x"], dtype=h5py.string_dtype()
    ),
    "cycle": group(cycle),
    "deep": group(deep),
    "many": group(many),
    "rows elsewhere": outside,
    "link to itself": link_to("democles/resolved", h5py.SoftLink("/democles/resolved")),
    "link to a device": link_to("democles/resolved", h5py.ExternalLink("/dev/zero", "/x")),
    "group for a column": lambda f: (
        f.pop("democles/resolved"),
        f.create_group("democles/resolved"),
    ),
    "points in three dimensions": make("VTKHDF/Points", lambda v: v[:, :, None]),
    "compound": make("VTKHDF/Types", lambda v: numpy.zeros(len(v), [("a", "i4"), ("b", "f8")])),
    "compressed": make("VTKHDF/Points", lambda v: v, chunks=True, compression="gzip"),
    "sum as a thousand": lambda f: f["VTKHDF/Points"].attrs.create(
        "checksum", numpy.zeros(1000, numpy.uint64)
    ),
}
STRUCTURE["fifty texts"] = make("democles/resolved", lambda v: numpy.array([b"x" * 4000] * 50))

BAD_IDS, BAD_REALS = (-1, 10**9, 2**40, -(2**63)), (float("nan"), float("inf"))


def contents(tables):
    """Named changes of the rows;
    tables: table -> its columns of numbers of elements and of reals."""
    found = {}
    for table, (ids, reals) in tables.items():
        for column in ids:
            path = f"democles/{table}/{column}"
            for value in BAD_IDS:
                found[f"{path} = {value}"] = edit(path, 0, value)
        for column in reals:
            path = f"democles/{table}/{column}"
            for value in BAD_REALS:
                found[f"{path} = {value}"] = edit(path, -1, value)
        first = f"democles/{table}/{(ids + reals)[-1]}"
        found[first + " too short"] = make(first, lambda v: v[:-1])
        found[first + " too long"] = make(first, lambda v: numpy.concatenate([v, v]))
        found[first + " too wide"] = make(first, lambda v: numpy.zeros((len(v), 50)))
    return found


PARTICLES = {
    "twice the same": twice("democles/elements/id"),
    "lists built later": attribute("built_at", numpy.int64(2**62)),
    "lists built earlier": attribute("built_at", numpy.int64(-(2**62))),
    "skin not a number": attribute("skin", float("nan")),
    "flag too large": attribute("stale", numpy.int64(2**40)),
    **contents(
        {
            "elements": (["id"], ["position", "velocity", "reference", "reach"]),
            "pairs": (["id", "partner"], ["history"]),
            "wall_contacts": (["id"], ["history"]),
        }
    ),
}
LATTICE = {
    "twice the same": twice("democles/cells/id"),
    "links of a corner": edit("democles/cells/links", slice(None), 63),
    "links below 0": edit("democles/cells/links", 0, -1),
    "fate of all modes": edit("democles/cells/fate", 0, 0x1FF),
    "fate below 0": edit("democles/cells/fate", -1, -1),
    "fresh links": edit("democles/cells/fresh", 0, -1),
    **contents({"cells": (["id"], ["displacement", "rotation", "velocity", "released"])}),
    **{f"totals = {v}": edit("democles/totals/number", -4, v) for v in (*BAD_REALS, -1, 1e300)},
}


ODD = (0, -1, 1, 2**31 - 1, 2**31, 2**53, 2**63 - 1, -(2**63), 1e-300, 1e300, -1e300, 0.5)


def odd(random):
    """Some numbers of some column, or an attribute, that are odd; the sums are right."""

    def number(values, dtype):
        with numpy.errstate(all="ignore"):
            return numpy.array(random.choice(values)).astype(dtype)

    def change(file):
        state, paths = file["democles"], []
        state.visititems(lambda name, item: paths.append(name) if hasattr(item, "dtype") else None)
        paths = [name for name in paths if name != "resolved" and len(state[name])]
        if random.random() < 0.2:
            name = random.choice(sorted(state.attrs))
            state.attrs.modify(name, number(ODD, state.attrs[name].dtype))
            return
        dataset = state[random.choice(paths)]
        values = dataset[()]
        for _ in range(random.choice((1, 1, 3, 30))):
            at = tuple(random.randrange(n) for n in values.shape)
            values[at] = number((*ODD, *BAD_REALS), values.dtype)
        dataset[...] = values
        sign(dataset)

    return change


def craft(path, change):
    with h5py.File(path, "r+") as file:
        change(file)
