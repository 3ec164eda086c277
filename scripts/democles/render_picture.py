"""The page that render.py writes: panels of frames, colour bar, scale; pictures and films."""
import math
import os
import pathlib
import subprocess
import sys
import shutil

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

from democles import frames, render_walls  # noqa: E402
from democles.render_colours import Colours  # noqa: E402
from democles.render_view import View, corners_of, view_axes  # noqa: E402

SAMPLES = 8  # frames that the ends of the colour bar and the extent of the picture are taken from
PANELS = 4


def spread(items, n):
    """Up to n items, evenly spaced, first and last among them."""
    if len(items) <= n:
        return list(items)
    return [items[round(k * (len(items) - 1) / (n - 1))] for k in range(n)]


def words(scene, field):
    """Names of materials or bodies in the order of their numbers in a frame."""
    if field == "material":
        return list(scene["materials"])
    return [body["name"] for body in scene.get("bodies") or []] if field == "body" else []


def magnification(samples):
    """Round factor that makes the largest displacement of a solid a twelfth of its size;
    1 for what moves farther by itself."""
    solids = [frame for frame in samples if frame.corners is not None]
    largest = max(
        (numpy.linalg.norm(frame.displacement, axis=2).max() for frame in solids), default=0
    )
    if not largest > 0:
        return 1.0
    size = max(numpy.ptp(solids[0].corners.reshape(-1, 3), axis=0))
    if largest >= size / 12:
        return 1.0
    power = 10.0 ** math.floor(math.log10(size / 12 / largest))
    return max(m * power for m in (1, 2, 5) if m * power <= size / 12 / largest)


def extent(samples, walls, warp):
    """Lowest and highest corner of all that has an end: elements of the sampled frames,
    and walls."""
    low, high = numpy.full(3, numpy.inf), numpy.full(3, -numpy.inf)
    for frame in samples:
        if frame.corners is not None:
            placed = (frame.corners + warp * frame.displacement).reshape(-1, 3)
            low, high = numpy.minimum(low, placed.min(axis=0)), numpy.maximum(
                high, placed.max(axis=0)
            )
        elif len(frame.points):
            r = frame.field("radius")[:, None]
            low, high = numpy.minimum(low, (frame.points - r).min(axis=0)), numpy.maximum(
                high, (frame.points + r).max(axis=0)
            )
        for wall in walls:
            points = (
                render_walls.vertices(wall) if render_walls.is_there(wall, frame.time) else None
            )
            if points is not None:
                rotation, translation = render_walls.pose(wall, frame.time)
                placed = points @ rotation.T + translation
                low, high = numpy.minimum(low, placed.min(axis=0)), numpy.maximum(
                    high, placed.max(axis=0)
                )
    if not numpy.all(numpy.isfinite(low)):
        low, high = -numpy.ones(3), numpy.ones(3)
    margin = 0.02 * max(high - low)
    return low - margin, high + margin


def time_text(time, end):
    """In the unit that suits the length of the run."""
    for unit, factor in (("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9)):
        if end * factor >= 1 or unit == "ns":
            digits = max(0, 3 - math.floor(math.log10(max(end * factor, 1e-9))) - 1)
            return f"t = {time * factor:.{digits}f} {unit}"
    return ""


class Layout:
    """A page in pixels: title above, n panels, colour bar and scale below.
    All panels have the same scale. plain: the panels alone."""

    def __init__(self, size, n, title, colours, axes, low, high, plain):
        width, height = size
        self.figure = plt.figure(figsize=(width / 100, height / 100), dpi=100, facecolor="white")
        self.width, self.height, self.plain, self.text = (
            width,
            height,
            plain,
            max(min(width / 100, height / 42), 8),
        )
        self.line = self.text / 72 * 100 / height  # of text, as a share of the page
        self.top, self.bottom = (
            (0, 0) if plain else (2.6 * self.line if title else 0.02, 5.4 * self.line)
        )
        spans = numpy.ptp(corners_of(low, high) @ numpy.array(axes[:2]).T, axis=0)
        label = 0 if plain else 2.2 * self.text / 72 * 100  # pixels above each panel, for its time
        area_w, area_h = width, height * (1 - self.top - self.bottom)
        scales = []
        for columns in (c for c in range(1, n + 1) if n % c == 0):  # full rows
            rows = -(-n // columns)
            panel = area_w / columns, area_h / rows - label
            scales.append(
                (min(panel[0] * 0.96 / spans[0], panel[1] * 0.98 / spans[1]), -rows, columns, panel)
            )
        self.pixels_per_metre, _, columns, panel = max(scales)
        self.panel = int(panel[0]), int(panel[1])
        self.images, self.labels = [], []
        for k in range(n):
            left, top = (k % columns) * area_w / columns, height * self.top + (k // columns) * (
                panel[1] + label
            )
            self.labels.append(
                self.figure.text(
                    (left + panel[0] / 2) / width,
                    1 - (top + 0.75 * label) / height,
                    "",
                    size=self.text,
                    ha="center",
                )
            )
            axis = self.figure.add_axes(
                (
                    left / width,
                    1 - (top + label + panel[1]) / height,
                    panel[0] / width,
                    panel[1] / height,
                )
            )
            axis.axis("off")
            self.images.append(
                axis.imshow(
                    numpy.full((2, 2, 3), 255, numpy.uint8),
                    extent=(0, 1, 0, 1),
                    aspect="auto",
                    interpolation="antialiased",
                )
            )
        if plain:
            return
        if title:
            self.figure.text(
                0.02, 1 - self.top / 2, title, size=1.35 * self.text, va="center", weight="bold"
            )
        self.colour_bar(colours)
        self.scale_bar()

    def colour_bar(self, colours):
        axis = self.figure.add_axes((0.3, 3.6 * self.line, 0.4, 0.8 * self.line))
        factor, prefix = colours.prefix()
        norm = matplotlib.colors.Normalize(colours.low / factor, colours.high / factor)
        bar = self.figure.colorbar(
            matplotlib.cm.ScalarMappable(norm, colours.map()), cax=axis, orientation="horizontal"
        )
        bar.set_label(colours.label(prefix), size=self.text)
        if colours.levels < 256:
            ticks = range(
                math.ceil(colours.low), math.floor(colours.high) + 1, max(1, colours.levels // 10)
            )
            bar.set_ticks(
                ticks,
                labels=[colours.words[t] if t < len(colours.words) else str(t) for t in ticks],
            )
        bar.ax.tick_params(labelsize=0.9 * self.text)

    def scale_bar(self):
        """A round length of at most an eighth of the page."""
        longest = self.width / 8 / self.pixels_per_metre
        power = 10.0 ** math.floor(math.log10(longest))
        length = max(m * power for m in (1, 2, 5) if m * power <= longest)
        factor, unit = next(
            (f, u)
            for f, u in ((1, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm"))
            if length * f >= 0.999 or u == "nm"
        )
        pixels = length * self.pixels_per_metre / self.width
        height = 4 * self.line
        line = matplotlib.lines.Line2D(
            (0.02, 0.02 + pixels),
            (height, height),
            color="black",
            lw=self.text / 6,
            solid_capstyle="butt",
        )
        self.figure.add_artist(line)
        self.figure.text(
            0.02,
            height - 0.5 * self.line,
            f"{length * factor:g} {unit}",
            size=0.9 * self.text,
            va="top",
        )

    def put(self, k, image, text):
        self.images[k].set_data(image)
        self.labels[k].set_text("" if self.plain else text)

    def pixels(self):
        """[height][width][3] bytes."""
        self.figure.canvas.draw()
        return numpy.asarray(self.figure.canvas.buffer_rgba())[:, :, :3]


class Picture:
    """One page of n panels of a run, drawn again and again for films."""

    def __init__(self, options, paths, n, samples, size, sharpness):
        scene = frames.scene(options.dir)
        self.walls = scene.get("walls") or []
        self.end = max(frames.Frame(paths[-1]).time, 1e-12)
        ends = options.range
        self.colours = Colours(samples, options.field, ends)
        self.colours.words = words(scene, self.colours.name)
        warp = options.warp if options.warp is not None else magnification(samples)
        low, high = extent(samples, self.walls, warp)
        axes = view_axes(low, high, scene.get("gravity"), options.view)
        title = scene.get("title") or pathlib.Path(options.dir).resolve().name
        if warp != 1 and any(frame.corners is not None for frame in samples):
            title += f" (displacements \u00d7 {warp:g})"
        self.layout = Layout(size, n, title, self.colours, axes, low, high, options.plain)
        colour_table = self.colours.map()(numpy.linspace(0, 1, self.colours.levels))
        self.view = View(
            self.layout.panel,
            sharpness,
            axes,
            (low, high),
            self.layout.pixels_per_metre,
            self.walls,
            colour_table,
            warp,
        )

    def draw(self, chosen):
        for k, frame in enumerate(chosen):
            values = self.colours.of(frame) if len(frame.points) else numpy.zeros(0)
            image = self.view.draw(frame, values, (self.colours.low, self.colours.high))
            self.layout.put(k, image, time_text(frame.time, self.end))
        return self.layout.pixels()


def write_film(options, paths, size):
    if not shutil.which("ffmpeg"):
        sys.exit("render: a film needs ffmpeg (scripts/setup installs it)")
    samples = [frames.Frame(path) for path in spread(paths, SAMPLES)]
    picture = Picture(options, paths, 1, samples, size, 1)
    fps = options.fps[0] if options.fps else min(25, max(5, len(paths) / 8))
    out = options.out or os.path.join(options.dir, "film.mp4")
    command = [
        "ffmpeg",
        "-y",
        "-loglevel",
        "error",
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-s",
        f"{size[0]}x{size[1]}",
        "-r",
        str(fps),
        "-i",
        "-",
        "-c:v",
        "libx264",
        "-preset",
        "veryfast",
        "-crf",
        "20",
        "-pix_fmt",
        "yuv420p",
        "-movflags",
        "+faststart",
        out,
    ]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as film:
        for k, path in enumerate(paths):
            try:
                film.stdin.write(picture.draw([frames.Frame(path)]).tobytes())
            except BrokenPipeError:  # its own reason stands above
                sys.exit(f"render: ffmpeg could not write {out}")
            if sys.stdout.isatty():
                print(f"\rframe {k + 1} of {len(paths)}", end="", flush=True)
        film.stdin.close()
        if sys.stdout.isatty():
            print()
        if film.wait():
            sys.exit(f"render: ffmpeg could not write {out}")
    return out


def with_elements(paths):
    """Without the frames at the end in which hardly any elements are left
    (a twentieth of those of the first frame)."""
    n, least = len(paths), len(frames.Frame(paths[0]).points) / 20
    while n > 1 and len(frames.Frame(paths[n - 1]).points) < least:
        n -= 1
    return paths[:n]


def write_picture(options, paths, size):
    if options.frame is None:
        chosen, name = spread(with_elements(paths), PANELS), "overview.png"
    else:
        if options.frame in ("first", "last"):
            path = paths[0 if options.frame == "first" else -1]
        else:
            path = pathlib.Path(options.dir) / f"frame_{int(options.frame):06d}.hdf"
            if path not in paths:
                sys.exit(f"render: there is no {path}; the last is {paths[-1].name}")
        chosen, name = [path], path.stem + ".png"
    chosen = [frames.Frame(path) for path in chosen]
    picture = Picture(options, paths, len(chosen), chosen, size, 2)
    out = options.out or os.path.join(options.dir, name)
    plt.imsave(out, picture.draw(chosen))
    return out


def draw(options):
    """The picture or film that the options ask for; returns its path."""
    paths = (frames.shown if options.film else frames.paths)(options.dir)
    if not paths:
        sys.exit(f"render: no frames in {options.dir}")
    size = options.size or ([1280, 720] if options.film else [1600, 1000])
    size = [v - v % 2 for v in size]  # films want even numbers
    return write_film(options, paths, size) if options.film else write_picture(options, paths, size)
