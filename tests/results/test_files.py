#!/usr/bin/python3
"""Results on disk as a user and VTK 9.1 meet them: frames, folders, records; and what is left, said
and returned when the disk does not play along.

Arguments: Frames, Folders or Record (the tests to run), results_tool, mpirun. Called by meson."""
import csv
import json
import math
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

TOOL, MPIRUN = None, None
FRAME = "frame_000007.hdf"


def tool(n_rank, *args):
    """Runs results_tool on n_rank ranks (one: without mpirun);
    no result within a minute is a hang."""
    command = [TOOL, *args] if n_rank == 1 else [MPIRUN, "-n", str(n_rank), TOOL, *args]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


def errors(run):
    return [line for line in run.stderr.splitlines() if "democles: error:" in line]


class Folder(unittest.TestCase):
    def setUp(self):
        self.dir = tempfile.mkdtemp(prefix="democles_results_")
        self.addCleanup(shutil.rmtree, self.dir, True)

    def path(self, *name):
        return os.path.join(self.dir, *name)

    def put(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def get(self, *name):
        with open(self.path(*name)) as file:
            return file.read()


class Frames(Folder):
    def test_vtk_reads_every_part(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOHDF import vtkHDFReader

        for n_rank in (1, 2, 3):  # the second rank has no elements
            self.assertEqual(tool(n_rank, "frame", self.dir).returncode, 0)
            reader = vtkHDFReader()
            self.assertEqual(reader.CanReadFile(self.path(FRAME)), 1)
            reader.SetFileName(self.path(FRAME))
            reader.Update()
            grid = reader.GetOutput()
            n = sum(0 if r == 1 else 3 + 2 * r for r in range(n_rank))
            self.assertEqual((grid.GetNumberOfPoints(), grid.GetNumberOfCells()), (n, n))
            data = {
                grid.GetPointData().GetArrayName(k): vtk_to_numpy(grid.GetPointData().GetArray(k))
                for k in range(grid.GetPointData().GetNumberOfArrays())
            }
            self.assertEqual(sorted(data), ["coordination", "id", "radius", "velocity"])
            x = vtk_to_numpy(grid.GetPoints().GetData())
            for i in range(n):
                self.assertEqual(data["id"][i], i)
                self.assertEqual(data["coordination"][i], i % 5)
                self.assertEqual(grid.GetCellType(i), 1)
                self.assertEqual(grid.GetCell(i).GetPointId(0), i)
                self.assertEqual(list(x[i]), [0.001 * i + 0.1 * k + 1.0 / 3.0 for k in range(3)])
                self.assertEqual(list(data["velocity"][i]), [i * i - 0.7 * k for k in range(3)])
            self.assertEqual(str(data["radius"].dtype), "float32")
            self.assertEqual(grid.GetFieldData().GetArray("TimeValue").GetValue(0), 0.042)

    def test_same_name_is_replaced_whole(self):
        self.assertEqual(tool(1, "frame", self.dir).returncode, 0)
        self.assertEqual(tool(3, "frame", self.dir).returncode, 0)
        self.assertEqual(os.listdir(self.dir), [FRAME])
        self.assertEqual(tool(1, "check", self.path(FRAME)).stdout, "")

    def damaged(self, data):
        with open(self.path("damaged.hdf"), "wb") as file:
            file.write(data)
        run = tool(1, "check", self.path("damaged.hdf"))
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        return run.stdout

    def test_damage_is_found(self):
        self.assertEqual(tool(3, "frame", self.dir).returncode, 0)
        with open(self.path(FRAME), "rb") as file:
            whole = file.read()
        self.assertEqual(self.damaged(whole), "")
        number = struct.pack("<d", 0.001 * 2 + 0.1 + 1.0 / 3.0)
        for what, says in (
            (number, "VTKHDF/Points: its checksum"),
            (b"title: a scene", "democles/resolved: its checksum"),
            (b"contacts of the", "VTKHDF/PointData/coordination"),
        ):
            at = whole.index(what)
            for bit in (0, 7):
                self.assertIn(
                    says,
                    self.damaged(whole[:at] + bytes([whole[at] ^ (1 << bit)]) + whole[at + 1 :]),
                )
        for length in (0, 1, 47, len(whole) // 2, len(whole) - 1):
            self.assertNotEqual(self.damaged(whole[:length]), "")
        self.assertEqual(tool(1, "write", self.path("numbers.hdf"), "0").returncode, 0)
        self.assertIn("no group VTKHDF", tool(1, "check", self.path("numbers.hdf")).stdout)

    def test_file_size_limit(self):
        """The room is asked for first: a message with the reason, one, and nothing left."""
        run = tool(3, "frame", self.dir, "20000")
        self.assertEqual(run.returncode, 6)
        self.assertEqual(len(errors(run)), 1, run.stderr)
        self.assertIn("File too large", errors(run)[0])
        self.assertEqual(os.listdir(self.dir), [])

    def test_write_that_fails_on_one_rank(self):
        """Inside of a collective write the other ranks would wait for ever."""
        for n_rank, limit in ((1, 500000), (3, 500000)):
            run = tool(n_rank, "write", self.path("numbers.hdf"), str(limit))
            self.assertEqual(run.returncode, 6)
            self.assertEqual(len(errors(run)), 1, run.stderr)
            self.assertIn("numbers.hdf", errors(run)[0])
            self.assertEqual(os.listdir(self.dir), [])

    def test_full_disk(self):
        small = self.path("small")
        os.mkdir(small)
        mount = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", small], capture_output=True
        )
        if mount.returncode:
            self.skipTest(
                "may not mount a small disk here; the limits on file sizes above stand for it"
            )
        try:
            run = tool(2, "frame", small)
            self.assertEqual(run.returncode, 6)
            self.assertEqual(len(errors(run)), 1, run.stderr)
            self.assertIn("No space left on device", errors(run)[0])
            self.assertEqual(os.listdir(small), [])
        finally:
            subprocess.run(["umount", small], check=True)

    def test_folder_that_is_gone(self):
        run = tool(2, "frame", self.path("gone"))
        self.assertEqual(run.returncode, 6)
        self.assertEqual(len(errors(run)), 1, run.stderr)
        self.assertIn("No such file or directory", errors(run)[0])


class Folders(Folder):
    def setUp(self):
        super().setUp()
        self.scene = self.put("case/scene.yaml", "title: given\n")

    def test_made_with_parents(self):
        for n_rank, name in ((1, "a/b/c"), (3, "a/d/")):
            self.assertEqual(tool(n_rank, "folder", self.path(name), self.scene).returncode, 0)
            self.assertEqual(self.get(name, "scene.yaml"), "title: given\n")
            self.assertTrue(self.get(name, "resolved.yaml").startswith("title: resolved\n"))

    def test_results_are_refused(self):
        for result in ("frame_000000.hdf", "run.json"):
            self.put("out/" + result, "old")
            run = tool(2 if result == "run.json" else 1, "folder", self.path("out"), self.scene)
            self.assertEqual(run.returncode, 2)
            self.assertEqual(len(errors(run)), 1, run.stderr)
            self.assertIn("--force", errors(run)[0])
            self.assertEqual(os.listdir(self.path("out")), [result])
            shutil.rmtree(self.path("out"))

    def test_force_removes_ours_and_nothing_else(self):
        ours = [
            "frame_000000.hdf",
            "frame_000123.hdf",
            "frame_000124.hdf.4711.tmp",
            "frame_1234567.hdf",
            "run.json",
            "log.txt",
            "stop",
            "outflow.csv",
        ]
        others = [
            "frame.hdf",
            "frame_7.hdf",
            "frame_000001_backup.hdf",
            "frame_000001.old.hdf",
            "frame_0000001.hdf",
            "frame_000001.hdf.tmp",
            "frame_000001.hdf.my.tmp",
            "frame_1x.hdf.4711.tmp",
            "frame_-00001.hdf",
            "frame_+00001.hdf",
            "frame_ 00001.hdf",
            "frame_000001.hdf2",
            "energy.csv",
            "frame_000000.png",
            "notes.txt",
            "analysis.csv",
            "sub/frame_000000.hdf",
        ]
        for name in ours + others:
            self.put("out/" + name, "old")
        self.put("out/before.csv", "time [s],count [1]\n0,1\n")
        self.put("out/scene.yaml", "title: old\n")
        self.put(
            "out/resolved.yaml",
            "measure:\n  - {name: energy}\n  - {name: before}\n  - {name: ../case/secret}\n",
        )
        self.put("case/secret.csv", "mine")
        self.assertEqual(tool(2, "folder", self.path("out"), self.scene, "--force").returncode, 0)
        found = sorted(
            os.path.relpath(os.path.join(at, name), self.path("out"))
            for at, _, names in os.walk(self.path("out"))
            for name in names
        )
        self.assertEqual(found, sorted(others + ["scene.yaml", "resolved.yaml"]))
        self.assertEqual(self.get("out/scene.yaml"), "title: given\n")
        self.assertEqual(self.get("case/secret.csv"), "mine")

    def test_scene_in_the_folder_itself(self):
        self.put("case/run.json", "{}")
        self.assertEqual(tool(1, "folder", self.path("case"), self.scene, "--force").returncode, 0)
        self.assertEqual(self.get("case/scene.yaml"), "title: given\n")

    def test_somebody_elses_scene_is_kept(self):
        self.put("other/scene.yaml", "title: of the user\n")
        run = tool(1, "folder", self.path("other"), self.scene)
        self.assertEqual(run.returncode, 2)
        self.assertEqual(self.get("other/scene.yaml"), "title: of the user\n")

    def test_somebody_elses_series_is_kept(self):
        """It may be what the scene reads: a CSV with the name of a measure,
        in a folder without a run."""
        self.put("data/outflow.csv", "mine")
        run = tool(2, "folder", self.path("data"), self.scene)
        self.assertEqual((run.returncode, len(errors(run))), (2, 1), run.stderr)
        self.assertIn("holds a file outflow.csv, the name of a measure; --force", errors(run)[0])
        self.assertEqual(
            (os.listdir(self.path("data")), self.get("data/outflow.csv")), (["outflow.csv"], "mine")
        )

    def test_run_killed_before_its_first_frame_is_no_result(self):
        self.put("out/scene.yaml", "title: old\n")
        self.put("out/resolved.yaml", "title: old\n")
        self.put("out/stop", "")
        self.put("out/outflow.csv", "time [s],outflow [1]\n")
        run = tool(1, "folder", self.path("out"), self.scene)
        self.assertEqual(run.returncode, 2)
        self.assertIn("holds another scene.yaml", errors(run)[0])
        self.put("out/log.txt", "democles 0.3.0 (abc)\n")
        self.assertEqual(tool(1, "folder", self.path("out"), self.scene).returncode, 0)
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["resolved.yaml", "scene.yaml"])

    def test_cannot_be_made(self):
        self.put("file", "in the way")
        for name in ("file", "file/below", "/proc/democles"):
            run = tool(2 if name == "file" else 1, "folder", self.path(name), self.scene)
            self.assertEqual(run.returncode, 6)
            self.assertEqual(len(errors(run)), 1, run.stderr)


class Record(Folder):
    # What stops the job runs on one rank: mpirun.py may run an aborted job once more, which would
    # then find the files of the first try.

    def test_record(self):
        run = tool(3, "record", self.dir)
        self.assertEqual(run.returncode, 0, run.stderr)
        record = json.loads(self.get("run.json"))
        self.assertEqual(record["title"], 'a "quoted" \\ path\nµ\t\x01')
        self.assertEqual(record["large"], 9007199254740993)
        self.assertEqual(record["third"], 1.0 / 3.0)
        self.assertEqual((record["not_a_number"], record["nothing"]), (None, None))
        self.assertEqual(record["p"], [1.0 / 3.0, 0, None])
        self.assertEqual(math.copysign(1, record["p"][1]), -1)
        self.assertEqual(record["devices"], [{"gpu": False}])
        self.assertEqual(record["timers"]["loop"], {"min": 1, "mean": 2, "max": 3})
        self.assertLess({"compute", "exchange", "wait", "regroup", "output"}, set(record["timers"]))
        self.assertEqual(record["share"], {"min": 0, "mean": 1, "max": 2})
        self.assertEqual(sorted(os.listdir(self.dir)), ["log.txt", "outflow.csv", "run.json"])

    def test_series_reads_back(self):
        self.assertEqual(tool(1, "record", self.dir).returncode, 0)
        with open(self.path("outflow.csv"), newline="") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["time [s]", "below [1]", "a, b [J]"])
        values = [[float(v) for v in row] for row in rows[1:]]
        self.assertEqual(
            [row[2] for row in values], [1.0 / 3.0, 5e-324, 1e23, 0.1, -0.0, 1.7976931348623157e308]
        )
        self.assertEqual([row[0] for row in values], [1e-3 * k for k in range(6)])

    def test_log_holds_what_was_printed(self):
        run = tool(
            2, "record", self.dir
        )  # mpirun gives ranks a terminal of their own: it must not be taken for one
        self.assertEqual(run.stdout, self.get("log.txt"))
        lines = run.stdout.splitlines()
        self.assertEqual(lines[:2], ["before the folder", "17 elements"])
        self.assertEqual(
            [line.split("(")[1].split(" %")[0] for line in lines[2:]],
            ["10", "20", "30", "40", "50", "60", "70", "80", "90", "100"],
        )
        self.assertRegex(lines[-1], r"\Astep 1000 of 1000 \(100 %\)  t = \S+ of 0.01 s\Z")
        self.assertRegex(lines[-2], r" million element updates/s  \S+ s left\Z")

    def test_terminal_gets_one_line(self):
        """On a terminal the progress line is rewritten: wiped before other output,
        never scrolled."""
        for command in (
            [TOOL, "record", self.dir],
            [MPIRUN, "-n", "2", TOOL, "record", self.dir],
        ):
            run = subprocess.run(
                ["script", "-qec", shlex.join(command), "/dev/null"],
                capture_output=True,
                timeout=60,
            )
            self.assertEqual(run.returncode, 0)
            self.assertEqual(run.stdout.replace(b"\r\n", b"\n").count(b"\n"), 3, run.stdout)
            self.assertGreater(run.stdout.count(b"\rstep"), 5)
            self.assertIn("step 900 of 1000", self.get("log.txt"))
            for name in ("log.txt", "outflow.csv"):
                os.remove(self.path(name))

    def test_no_room(self):
        """Each file that takes no more says so and the job ends."""
        for name in ("outflow.csv", "log.txt"):
            run = tool(1, "record", self.dir, name)
            self.assertEqual(run.returncode, 6)
            self.assertEqual(len(errors(run)), 1, run.stderr)
            self.assertIn("File too large", errors(run)[0])
            self.assertIn(name, errors(run)[0])
            for left in os.listdir(self.dir):
                os.remove(self.path(left))

    def test_links_are_not_followed(self):
        """A link of the name that a run makes: nothing behind it is touched."""
        self.put("victim", "mine")
        for name in ("outflow.csv", "log.txt"):
            os.symlink("victim", self.path(name))
            run = tool(1, "record", self.dir)
            self.assertEqual(run.returncode, 6)
            self.assertIn(name, errors(run)[0])
            self.assertEqual(self.get("victim"), "mine")
            for left in ("outflow.csv", "log.txt"):
                if os.path.lexists(self.path(left)):
                    os.remove(self.path(left))


if __name__ == "__main__":
    TOOL, MPIRUN = sys.argv[2:4]
    unittest.main(argv=sys.argv[:2], verbosity=2)
