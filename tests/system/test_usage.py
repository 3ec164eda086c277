#!/usr/bin/python3
"""Commands that only print, and refusals of the command line: exit code and text,
once on any number of ranks."""
import os
import pathlib
import re
import sys

import cli

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from democles import mpi  # noqa: E402


class Usage(cli.Case):
    """test_options.c has the words of all refusals."""

    def test_once_for_all_ranks(self):
        for ranks in (1, 3):
            for args, message in (
                (
                    "run a.yaml --stpes 5",
                    "`democles run` has no option '--stpes'; did you mean '--steps'?",
                ),
                ("explain gravty", "no key 'gravty'; did you mean 'gravity'?"),
            ):
                run = self.call(*args.split(), ranks=ranks)
                self.assertEqual(
                    (run.code, run.out, run.err), (2, "", ["democles: error: " + message])
                )
        self.assertEqual(os.listdir(self.dir), [])

    def test_help(self):
        run = self.call("--help")
        self.assertEqual((run.code, run.err), (0, []))
        self.assertEqual(
            re.findall(r"^    democles ([a-z]+)", run.out, re.M),
            ["run", "resume", "check", "devices", "explain"],
        )
        run = self.call("run", "--help", ranks=3)
        self.assertEqual(
            (run.code, run.err, run.out.count("usage: democles run SCENE [OPTION]...")), (0, [], 1)
        )

    def test_version(self):
        run = self.call("--version")
        self.assertEqual((run.code, run.err), (0, []))
        self.assertRegex(run.out, r"\Ademocles \d+\.\d+\.\d+ \(\S+\)\n\Z")

    def test_other_mpirun(self):
        """The mpirun of another MPI gives a job its size, but the ranks do not find each other."""
        run = self.call(
            "--version", env={"PMI_SIZE" if mpi.is_open_mpi() else "OMPI_COMM_WORLD_SIZE": "2"}
        )
        said = [
            line
            for line in run.err
            if "mpirun is not of the MPI that democles is built with" in line
        ]
        self.assertEqual((run.code, run.out, len(said)), (2, "", 1))


class Printed(cli.Case):
    def test_explain(self):
        run = self.call("explain")
        self.assertEqual((run.code, run.err), (0, []))
        for key in (
            "time.end",
            "contacts[].normal.stiffness",
            "walls[].motion.remove_at",
            "measure[].count.below.z",
        ):
            self.assertRegex(run.out, "(?m)^" + re.escape(key) + " ")
        run = self.call("explain", "contacts.normal", ranks=3)
        keys = [line.split()[0] for line in run.out.splitlines()]
        self.assertEqual(
            (run.code, keys),
            (
                0,
                ["key"]
                + [
                    "contacts[].normal" + part
                    for part in (
                        "",
                        ".law",
                        ".stiffness",
                        ".damping_ratio",
                        ".restitution",
                        ".attraction",
                    )
                ],
            ),
        )

    def test_devices(self):
        run = self.call("devices", "--ranks", "3")
        self.assertEqual((run.code, run.err), (0, []))
        self.assertEqual(
            re.findall(r"(?m)^rank (\d+) of a node takes (\d+:\d+)  \S", run.out),
            [(r, "0:0") for r in "012"],
        )
        run = self.call("devices", ranks=2)  # those that run
        self.assertEqual((run.code, re.findall(r"(?m)^rank (\d+)", run.out)), (0, ["0", "1"]))

    def test_no_device(self):
        for ranks in (1, 3):
            run = self.call("devices", ranks=ranks, env={"OCL_ICD_VENDORS": self.dir})
            self.assertEqual((run.code, run.out), (4, ""))
            self.assertEqual(len(run.err), 1)
            self.assertIn("democles: error: no OpenCL device was found", run.err[0])

    def test_output_that_is_lost(self):
        with open("/dev/full", "w") as full:
            run = self.call("explain", stdout=full)
        self.assertEqual(
            (run.code, run.err), (6, ["democles: error: cannot write to the standard output"])
        )


if __name__ == "__main__":
    cli.main(2)
