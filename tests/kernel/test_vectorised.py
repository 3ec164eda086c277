#!/usr/bin/python3
"""test_vectorised COMPILE_FORCE COMPILE_LATTICE some|all: pocl turns the loop over work-items
around the contact law into SIMD code, in full width.

The force kernels have three loops (load, law, store); the middle one is where the time goes and
the only one without vector types, so one loop that LLVM reports as vectorised is that one. The
lattice has one loop in link_force, and with volume one in link_volume; with shares two in each.
Skipped (77) where the platform is not pocl or its LLVM says nothing about loops."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

EQUAL = ["spin", "linear", "tangential", "damping"]
CASES = [
    ("pair_force", "double", EQUAL + ["periodic"]),
    ("pair_force", "single", EQUAL + ["binding"]),
    ("pair_force", "mixed", EQUAL + ["cdt"]),
    ("pair_force", "double", EQUAL + ["materials"]),
    (
        "pair_force",
        "double",
        ["spin", "hertz", "tangential", "damping", "epsd", "binding", "sizes"],
    ),
    ("wall_force", "double", EQUAL + ["plane"]),
    ("wall_force", "double", EQUAL + ["binding", "rectangle", "triangle"]),
    ("wall_force", "single", EQUAL + ["plane", "rectangle"]),
    ("wall_force", "single", EQUAL + ["cylinder", "triangle", "moving"]),
    ("wall_force", "mixed", EQUAL + ["plane", "rectangle", "cylinder", "triangle", "moving"]),
    ("lattice", "double", ["small"]),
    ("lattice", "single", ["small"]),
    ("lattice", "double", ["small", "volume", "shares"]),
    ("lattice", "single", ["turn", "volume", "shares"]),
    ("lattice", "double", ["turn", "volume"]),
    ("lattice", "single", ["turn", "volume"]),
    ("lattice", "double", ["small", "volume", "rk4"]),
    ("lattice", "double", ["small", "energy"]),
    ("lattice", "double", ["turn", "volume", "rk4", "energy"]),
    ("lattice", "single", ["turn", "volume", "rk4", "energy"]),
    ("lattice", "mixed", ["turn", "volume", "rk4", "energy"]),
    ("lattice", "double", ["small", "rkn4", "energy"]),
    ("lattice", "single", ["turn", "rkn4", "energy"]),
    ("pair_force", "double", ["spin", "hertz", "tangential", "damping", "jkr", "sizes"]),
]
# One of each kernel and scheme, each precision.
SOME = [CASES[1], CASES[8], CASES[12], CASES[20], CASES[21]]


def vector_bytes():
    """Of what LLVM prefers on this machine: 32 with AVX (also AVX-512), else 16."""
    try:
        return (
            32
            if re.search(r"^flags.*\bavx\b", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
            else 16
        )
    except OSError:
        return 16


def remarks(kernel, precision, features):
    with tempfile.TemporaryDirectory() as cache:
        environment = dict(os.environ, POCL_VECTORIZER_REMARKS="1", POCL_CACHE_DIR=cache)
        program = sys.argv[2 if kernel == "lattice" else 1]
        done = subprocess.run(
            [program, kernel, precision, *features], env=environment, capture_output=True, text=True
        )
    if done.returncode == 77:
        print(done.stdout.strip() + ": not pocl, or no doubles")
        sys.exit(77)
    if done.returncode != 0:
        sys.exit(f"{kernel} {precision} {features}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout + done.stderr


failed = 0
for kernel, precision, features in CASES if sys.argv[3] == "all" else SOME:
    text = remarks(kernel, precision, features)
    if "vectorized" not in text:
        print("this pocl's LLVM gives no remarks about loops")
        sys.exit(77)
    widths = [int(w) for w in re.findall(r"vectorized loop \(vectorization width: (\d+)", text)]
    # mixed: positions and distances are double, and a loop has one width
    wanted = vector_bytes() // (4 if precision == "single" else 8)
    loops = 2 if "volume" in features else 1
    if "shares" in features:
        loops *= 2  # runs with cut cells, and without
    good = sum(w >= wanted for w in widths) >= loops
    failed += not good
    print(
        f"{'ok    ' if good else 'FAILED'} {kernel} {precision} {' '.join(features)}: widths "
        f"{widths}, wanted {wanted}"
    )
sys.exit(1 if failed else 0)
