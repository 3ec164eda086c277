#!/usr/bin/python3
"""run_case.py DEMOCLES SCENE CHECK [ARG...]: runs the scene with these arguments in a new folder
and then the check of the case."""
import pathlib
import shutil
import subprocess
import sys
import tempfile


def main():
    democles, scene, check, *more = sys.argv[1:]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="democles_case_"))
    try:
        code = subprocess.run(
            [democles, "run", scene, "-o", folder / "out", "--quiet", *more], check=False
        ).returncode
        if code:
            sys.exit(f"democles run {scene}: exit code {code}")
        sys.exit(subprocess.run([check, folder / "out"], check=False).returncode)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
