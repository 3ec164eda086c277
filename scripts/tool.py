#!/usr/bin/python3
"""Starts the tool that this file is called as:
scripts/plot.py and democles-plot are links to it, and run democles/plot.py."""
import importlib
import os
import pathlib
import sys

os.environ.setdefault("DEMOCLES_MPIRUN", "mpirun")  # installed: that of the program's MPI
NAME = pathlib.Path(sys.argv[0]).stem.removeprefix("democles-").replace("-", "_")
try:
    importlib.import_module("democles." + NAME).main()
except BrokenPipeError:
    os._exit(1)  # who read has gone; nothing to say, and nowhere
except OSError as error:
    sys.exit(f"{NAME}: {error.filename or 'a file'}: {error.strerror or error}")
