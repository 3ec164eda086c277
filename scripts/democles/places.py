"""Where the tools find the program and the cases, and where they put results:
in a checkout, and as installed."""
import pathlib
import shutil

ROOT = pathlib.Path(__file__).resolve().parents[2]  # the checkout, or PREFIX/share/democles
CASES = ROOT / "cases"
IS_CHECKOUT = (ROOT / "meson.build").is_file()
OUT = ROOT / "out" if IS_CHECKOUT else pathlib.Path("out")


def program():
    """The program of this checkout, the one installed with the tools,
    or the one that the shell finds."""
    own = ROOT / "build" / "democles" if IS_CHECKOUT else ROOT.parents[1] / "bin" / "democles"
    return str(own) if own.is_file() else shutil.which("democles") or str(own)
