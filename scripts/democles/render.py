"""Pictures and animations of a run: particles as spheres coloured by a field, translucent walls; a
solid with its displacements magnified.

    scripts/render.py DIR                    DIR/overview.png: up to four moments, side by side
    scripts/render.py DIR --frame last       DIR/frame_000123.png: one, by number, `first`, `last`
    scripts/render.py DIR --film             DIR/film.mp4: the frames of output.every

Works without a display (it starts one, Xvfb)."""
import argparse
import math
import sys


def numbers(n, separator, kind, is_good, what):
    """Type of an option of n numbers; what: how it looks, for the message."""

    def read(text):
        try:
            values = [kind(word) for word in text.split(separator)]
        except ValueError:
            values = []
        if len(values) != n or not all(map(math.isfinite, values)) or not is_good(values):
            raise argparse.ArgumentTypeError(f"'{text}': expected {what}")
        return values

    return read


def frame_name(text):
    if text not in ("first", "last") and not text.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}': expected a number, first, or last")
    return text


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dir", metavar="DIR", help="folder of results")
    parser.add_argument(
        "--frame", metavar="N", type=frame_name, help="draws one frame: its number, first, or last"
    )
    parser.add_argument(
        "--film",
        action="store_true",
        help="draws the frames of output.every, as an MP4 animation (needs ffmpeg)",
    )
    parser.add_argument(
        "--field",
        metavar="NAME",
        help="field that gives the colour; a vector by its magnitude (default: velocity)",
    )
    parser.add_argument(
        "--range",
        metavar="LOW,HIGH",
        type=numbers(2, ",", float, lambda v: v[0] < v[1], "two numbers, as 0,1.5"),
        help="ends of the colour bar (default: from the frames)",
    )
    parser.add_argument(
        "--warp",
        metavar="FACTOR",
        type=float,
        help="factor by which the displacements of a solid are magnified (default: to a twelfth "
        "of its size, if they are smaller)",
    )
    parser.add_argument(
        "--view",
        metavar="X,Y,Z",
        type=numbers(3, ",", float, any, "a direction, as 1,0,0.5"),
        help="direction from which to look (default: along the thinnest extent, slightly turned)",
    )
    parser.add_argument(
        "--size",
        metavar="WxH",
        type=numbers(
            2, "x", int, lambda v: min(v) >= 100, "pixels, as 1600x1000, at least 100 each"
        ),
        help="size in pixels (default: 1600x1000, animation 1280x720)",
    )
    parser.add_argument(
        "--fps",
        type=numbers(1, None, float, lambda v: v[0] > 0, "a number above 0"),
        help="frames per second of the animation (default: such that it lasts about 8 s, 5 to 25 "
        "per second)",
    )
    parser.add_argument(
        "--plain", action="store_true", help="leaves out title, times, colour bar and scale"
    )
    parser.add_argument("-o", metavar="FILE", dest="out", help="file for the picture or animation")
    return parser.parse_args()


def main():
    options = arguments()
    from democles import display, render_picture  # nothing heavy before the arguments are read

    missing = display.ensure()
    if missing:
        sys.exit("render: " + missing)

    print(render_picture.draw(options))
