"""A field of a frame as colours, for the pictures of render.py."""
import matplotlib
import matplotlib.pyplot as plt
import numpy


class Colours:
    """A field as numbers for colours: its magnitude, name, unit, ends and map."""

    def __init__(self, samples, name, ends):
        names = samples[0].names
        preferred = [n for n in ("von_mises", "velocity") if n in names] + names + ["radius"]
        self.name = name or preferred[0]
        values = [self.of(frame) for frame in samples if len(frame.points)] or [numpy.zeros(1)]
        everything = numpy.concatenate(values)
        everything = everything[numpy.isfinite(everything)]
        self.unit = samples[0].unit(self.name)
        self.is_vector = samples[0].field(self.name).ndim > 1
        self.levels, self.is_cut = 256, False
        self.words = []  # what the whole numbers from 0 on are called; none: their digits
        self.low, self.high = (
            self.ends(
                everything, numpy.issubdtype(samples[0].field(self.name).dtype, numpy.integer)
            )
            if not ends
            else ends
        )

    def ends(self, values, is_integer):
        """Whole numbers get a colour each where they are few;
        else the fastest half per cent share the last colour."""
        if not len(values):
            return 0.0, 1.0
        low, high = float(values.min()), float(values.max())
        if is_integer and high - low <= 20:
            self.levels = int(high - low) + 1
            return low - 0.5, high + 0.5
        if self.is_vector:
            low = 0.0
        high = float(numpy.percentile(values, 99.5))
        self.is_cut = 1.05 * high < float(values.max())  # what lies below that cannot be seen
        if not high > low:
            high = low + max(abs(low), 1.0) * 1e-3 if not self.is_vector else 1.0
        return low, high

    def of(self, frame):
        values = numpy.asarray(frame.field(self.name), float)
        return numpy.linalg.norm(values, axis=1) if values.ndim > 1 else values

    def map(self):
        """viridis without its darkest part, in which spheres would lose their shading."""
        return matplotlib.colors.ListedColormap(
            plt.get_cmap("viridis")(numpy.linspace(0.16, 1, self.levels))
        )

    def prefix(self):
        """(1e6, "M") for millions of pascals, (1e-3, "m") for small speeds: the prefix that leaves
        the largest value between 1 and 1000. Kilograms have one already; numbers without a unit
        take none."""
        large = max(abs(self.low), abs(self.high))
        if not self.unit or self.unit.startswith("kg") or 0.1 <= large < 1000:
            return 1, ""
        prefixes = (
            (1e9, "G"),
            (1e6, "M"),
            (1e3, "k"),
            (1, ""),
            (1e-3, "m"),
            (1e-6, "\u00b5"),
            (1e-9, "n"),
        )
        return next((p for p in prefixes if large >= p[0]), prefixes[-1])

    def label(self, prefix=""):
        known = {
            "von_mises": "von Mises stress",
            "velocity": "speed",
            "angular_velocity": "angular speed",
        }
        name = known.get(self.name, self.name.replace("_", " "))
        share = ", largest 0.5 % in the last colour" if self.is_cut else ""
        return (f"{name} [{prefix}{self.unit}]" if self.unit else name) + share
