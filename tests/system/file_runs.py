#!/usr/bin/python3
"""Files of results: how many there are, whose they are, and what becomes of a user's own."""
import glob
import json
import os
import shutil
import signal
import subprocess
import time

import cli

SCENE = """title: two balls over a floor
method: particles
time: {end: 1e-3, step: 1e-5}
gravity: [0, 0, -9.81]
materials: {a: {density: 2500}}
contacts:
  - between: [a, a]
    normal: {law: linear, stiffness: 1e4, damping_ratio: 0.1}
    tangential: {stiffness_ratio: 0.5, friction: 0.3}
walls: [{name: f, material: a, surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}}]
elements: [{name: e, material: a, file: e.csv}]
output: {every: 5e-4}
measure: [{name: m, energy: all, every: 1e-4}]
"""
LATTICE = """method: lattice
time: {end: 1e-4, step: 1e-6}
materials: {a: {density: 2500, young: 1e9, poisson: 0.2}}
bodies: [{name: b, material: a, cell: 0.01,
  shape: {box: {min: [0, 0, 0], max: [0.03, 0.03, 0.03]}}}]
output: {every: 5e-5}
measure: [{name: m, energy: all, every: 1e-5}]
"""


class Files(cli.Case):
    def setUp(self):
        super().setUp()
        self.put("s.yaml", SCENE)
        self.put("e.csv", "x,y,z,radius\n0,0,0.1,0.05\n0.1,0.1,0.3,0.05\n")

    def text(self, name):
        with open(os.path.join(self.dir, name)) as file:
            return file.read()

    def names(self, folder, pattern="*"):
        return sorted(map(os.path.basename, glob.glob(os.path.join(self.dir, folder, pattern))))

    def good(self, *args, **more):
        run = self.call(*args, "--quiet", **more)
        self.assertEqual((run.code, run.err), (0, []))


class Often(Files):
    """Periods that are longer than any run, and shorter than any step."""

    def test_never(self):
        self.put("l.yaml", LATTICE)
        for scene in ("s.yaml", "l.yaml"):
            for k, (every, ranks) in enumerate((("1e300", 1), ("1e14", 3))):
                change = (
                    f"output={{every: {every}, checkpoint_every: 1e200}}",
                    "measure.m.every=" + every,
                )
                sets = [word for key in change for word in ("--set", key)]
                said = self.call("check", scene, *sets)
                self.assertIn(", 2 in all\n", said.out)
                folder = f"{scene}.{k}"
                self.good("run", scene, "-o", folder, *sets, ranks=ranks)
                self.assertEqual(
                    self.names(folder, "frame_*"), ["frame_000000.hdf", "frame_000001.hdf"]
                )
                self.assertEqual(len(self.text(folder + "/m.csv").splitlines()), 2)

    def test_always(self):
        """No more than one in a step."""
        sets = ["--set", "output.every=1e-300", "--set", "measure.m.every=1e-300", "--steps", "4"]
        self.good("run", "s.yaml", "-o", "d", *sets)
        self.assertEqual(len(self.names("d", "frame_*")), 5)
        self.assertEqual(len(self.text("d/m.csv").splitlines()), 6)


class Owned(Files):
    """Whose a file is: a user's own is neither overwritten nor deleted without --force."""

    def refused(self, what, *args, folder="d"):
        """Code 2, one line that names what is in the way, and nothing changed."""
        before = self.state()
        run = self.call("run", "s.yaml", "-o", folder, *args)
        self.assertEqual((run.code, len(run.err)), (2, 1), run.err)
        self.assertIn(what, run.err[0])
        self.assertIn("--force", run.err[0])
        self.assertEqual(self.state(), before)

    def state(self):
        """Every file and link below the folder, with its content."""
        found = {}
        for at, _, names in os.walk(self.dir):
            for name in names:
                path = os.path.join(at, name)
                with open(path, "rb") as file:
                    found[path] = (os.path.islink(path), file.read())
        return found

    def test_copies_of_frames(self):
        """Names that only resemble those of frames, before `resume` and `run --force`."""
        self.good("run", "s.yaml", "-o", "d")
        frame = os.path.join(self.dir, "d", "frame_000002.hdf")
        copies = [
            "frame_000005_keep.hdf",
            "frame_000004.old.hdf",
            "frame_7.hdf",
            "frame_0000008.hdf",
        ]
        copies += ["frame_000009.hdf.tmp", "frame_-00009.hdf", "frame_000009.hdf~"]
        for name in copies:
            shutil.copy(frame, os.path.join(self.dir, "d", name))
        os.remove(frame)
        open(os.path.join(self.dir, "d", "frame_000009.hdf.4711.tmp"), "w").close()
        frames = [f"frame_{k:06}.hdf" for k in range(3)]
        self.good("resume", "d")
        self.assertEqual(self.names("d", "frame_*"), sorted(copies + frames))
        self.good("run", "s.yaml", "-o", "d", "--force")
        self.assertEqual(self.names("d", "frame_*"), sorted(copies + frames))

    def test_folder_in_the_way(self):
        """--force removes nothing where it cannot replace everything."""
        self.good("run", "s.yaml", "-o", "d")
        for name in ("m.csv", "run.json", "log.txt", "frame_000001.hdf", "frames.hdf.series"):
            path = os.path.join(self.dir, "d", name)
            os.rename(path, path + ".kept")
            os.mkdir(path)
            before = self.state()
            run = self.call("run", "s.yaml", "-o", "d", "--force")
            self.assertEqual(run.code, 6, run.err)
            self.assertIn(f"cannot replace 'd/{name}': Is a directory", run.err[0])
            self.assertEqual(self.state(), before)
            os.rmdir(path)
            os.rename(path + ".kept", path)
        self.good("run", "s.yaml", "-o", "d", "--force")

    def test_pipe_in_the_way(self):
        """Nobody writes into these: who opens them to read waits for ever."""
        self.good("run", "s.yaml", "-o", "d", "--steps", "50")
        for name, code in (
            ("m.csv", 6),
            ("frame_000001.hdf", 0),
            ("frames.hdf.series", 0),
            ("resolved.yaml", 0),
            ("log.txt", 6),
            ("run.json", 0),
        ):
            shutil.copytree(os.path.join(self.dir, "d"), os.path.join(self.dir, "e"))
            os.remove(os.path.join(self.dir, "e", name))
            os.mkfifo(os.path.join(self.dir, "e", name))
            run = self.call("resume", "e", "--steps", "60")
            self.assertEqual(run.code, code, (name, run.err))
            shutil.rmtree(os.path.join(self.dir, "e"))

    def test_scene_from_a_pipe(self):
        """It can be read once only, so by one rank."""
        os.mkfifo(os.path.join(self.dir, "pipe"))
        with open(os.path.join(self.dir, "scene.txt"), "w") as file:
            file.write(SCENE)
        writer = subprocess.Popen(["sh", "-c", "cat scene.txt > pipe"], cwd=self.dir)
        self.good("run", "pipe", "-o", "d", "--steps", "1")
        writer.wait()
        self.assertEqual(self.text("d/scene.yaml"), SCENE)
        run = self.call("run", "pipe", "-o", "e", ranks=2)
        self.assertEqual(run.code, 3)
        self.assertIn("no ordinary file, so one rank alone can read it", "\n".join(run.err))

    def test_signal_while_waiting_for_a_pipe(self):
        """Nobody opens it for writing, or somebody does and writes only a part."""
        os.mkfifo(os.path.join(self.dir, "pipe"))
        for part in (None, SCENE[:40]):
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1):
                words = [cli.DEMOCLES, "run", "pipe", "-o", "d"]
                run = subprocess.Popen(words, cwd=self.dir, stderr=subprocess.PIPE)
                pipe = os.path.join(self.dir, "pipe")
                writer = os.open(pipe, os.O_RDWR) if part else None
                if part:
                    os.write(writer, part.encode())
                self.sleeps_with(run, pipe)
                run.send_signal(number)
                try:
                    self.assertEqual(run.wait(30), -number)
                finally:
                    run.kill()
                    run.communicate()
                if part:
                    os.close(writer)
                self.assertFalse(os.path.exists(os.path.join(self.dir, "d")))

    def sleeps_with(self, run, path):
        """Until the run has opened the file, or is gone."""
        links = f"/proc/{run.pid}/fd"
        while run.poll() is None:
            for fd in os.listdir(links):
                try:
                    if os.readlink(os.path.join(links, fd)) == path:
                        return
                except OSError:
                    pass
            time.sleep(0.01)

    def test_list_of_frames_grows(self):
        """The list is continued in its place, not written anew for each frame."""
        self.good("run", "s.yaml", "-o", "d", "--set", "output.every=1e-5", "--steps", "40")
        with open(os.path.join(self.dir, "d", "frames.hdf.series")) as file:
            listed = json.load(file)["files"]
        self.assertEqual([entry["name"] for entry in listed], self.names("d", "frame_*"))
        self.assertEqual(len(listed), 41)

    def test_resolved_scene_is_no_run(self):
        os.mkdir(os.path.join(self.dir, "d"))
        resolved = self.call("check", "s.yaml", "--resolved").out
        self.put("d/resolved.yaml", resolved)
        self.put("d/scene.yaml", SCENE + "# my edits\n")
        self.refused("another scene.yaml")
        os.remove(os.path.join(self.dir, "d", "scene.yaml"))
        self.put("d/m.csv", "precious\n")
        self.refused("a file m.csv, the name of a measure")
        os.remove(os.path.join(self.dir, "d", "m.csv"))
        self.put("d/resolved.yaml", resolved + "# my edits\n")
        self.refused("another resolved.yaml")
        self.put("d/resolved.yaml", resolved)
        self.good("run", "s.yaml", "-o", "d")

    def test_run_killed_before_its_first_frame(self):
        """Its log says that the folder is ours, whatever scene comes next."""
        self.good("run", "s.yaml", "-o", "d")
        for name in self.names("d", "frame_*") + ["run.json"]:
            os.remove(os.path.join(self.dir, "d", name))
        self.good("run", "s.yaml", "-o", "d", "--set", "title=other")
        self.assertIn("title: other", self.text("d/resolved.yaml"))

    def test_own_files(self):
        for name, args in (
            ("log.txt", []),
            ("run.balance.csv", []),
            ("trace.json", ["--trace"]),
            ("stop", []),
            ("run.json", []),
        ):
            os.makedirs(os.path.join(self.dir, name))
            self.put(f"{name}/{name}", "mine\n")
            self.refused(
                "results already" if name == "run.json" else "a file " + name, *args, folder=name
            )
            self.good("run", "s.yaml", "-o", name, "--force")

    def test_links(self):
        """A link out of the folder is refused where it is in the way, and followed nowhere."""
        pid_names = ["frame_000000.hdf.tmp", "scene.yaml.tmp", "run.json.tmp"]
        for name in ["log.txt", "m.csv", "run.balance.csv", "stop", *pid_names]:
            ranks = 2 if name in ("run.balance.csv", pid_names[0]) else 1
            folder = f"{name}.{ranks}"
            os.mkdir(os.path.join(self.dir, folder))
            self.put("victim", "VICTIM\n")
            os.symlink("../victim", os.path.join(self.dir, folder, name))
            args = ["--profile"] if name == "run.balance.csv" else []
            if name not in pid_names:
                self.refused("a file " + name, *args, folder=folder)
                args.append("--force")
            self.good("run", "s.yaml", "-o", folder, *args, ranks=ranks)
            self.assertEqual(self.text("victim"), "VICTIM\n")
            self.assertFalse(
                any(
                    os.path.islink(os.path.join(self.dir, folder, n))
                    for n in self.names(folder)
                    if n not in pid_names
                )
            )

    def test_links_in_a_folder_that_is_resumed(self):
        for name in ("log.txt", "m.csv"):
            self.good("run", "s.yaml", "-o", "d", "--steps", "50", "--force")
            self.put("victim", self.text("d/" + name))
            os.remove(os.path.join(self.dir, "d", name))
            os.symlink("../victim", os.path.join(self.dir, "d", name))
            before = self.text("victim")
            run = self.call("resume", "d", "--quiet")
            self.assertEqual((run.code, len(run.err)), (6, 1), run.err)
            self.assertIn(name, run.err[0])
            self.assertEqual(self.text("victim"), before)

    def test_link_to_the_scene(self):
        """A link that holds the very scene is left alone."""
        os.mkdir(os.path.join(self.dir, "d"))
        os.symlink("../s.yaml", os.path.join(self.dir, "d", "scene.yaml"))
        self.good("run", "s.yaml", "-o", "d")
        self.assertEqual(os.readlink(os.path.join(self.dir, "d", "scene.yaml")), "../s.yaml")
        self.assertEqual(self.text("s.yaml"), SCENE)


class Piped(Files):
    """Standard output whose reader goes away."""

    def pipe(self, *args, lines=0):
        """Runs with a reader that takes so many lines and then closes the pipe."""
        process = subprocess.Popen(
            [cli.DEMOCLES, *args],
            cwd=self.dir,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            # as a shell has it, not as Python has it
            preexec_fn=lambda: signal.signal(signal.SIGPIPE, signal.SIG_DFL),
        )
        for _ in range(lines):
            process.stdout.readline()
        process.stdout.close()
        err = process.stderr.read()
        process.stderr.close()
        return process.wait(60), err

    def test_run_goes_on(self):
        self.good("run", "s.yaml", "-o", "whole")
        for lines in (0, 1):
            code, err = self.pipe("run", "s.yaml", "-o", "d", "--force", lines=lines)
            self.assertEqual((code, err.count("\n")), (0, 1), err)
            self.assertIn("warning: the standard output is closed; the run goes on", err)
            self.assertEqual(self.names("d"), self.names("whole"))
            record, whole = json.loads(self.text("d/run.json")), json.loads(
                self.text("whole/run.json")
            )
            self.assertEqual((record["exit"], record["digest"]), (0, whole["digest"]))
            log = self.text("d/log.txt").splitlines()
            self.assertEqual(len(log), len(self.text("whole/log.txt").splitlines()) + 1)
            self.assertIn("step 100 of 100", "\n".join(log))

    def test_resume_goes_on(self):
        self.good("run", "s.yaml", "-o", "d", "--steps", "50")
        code, err = self.pipe("resume", "d")
        self.assertEqual((code, err.count("\n")), (0, 1), err)
        self.assertEqual(json.loads(self.text("d/run.json"))["steps"], 100)

    def test_what_prints_is_quiet(self):
        for args in (
            ["check", "s.yaml"],
            ["check", "s.yaml", "--resolved"],
            ["explain"],
            ["devices"],
            ["--help"],
            ["--version"],
        ):
            for lines in (0, 1):
                self.assertEqual(self.pipe(*args, lines=lines), (0, ""), args)

    def test_closed(self):
        """Without standard input, output and error no file or pipe of the program takes their
        place: what is printed would go there. Nor is there a folder of MPI, which all ranks
        without mpirun would share."""
        os.mkdir(os.path.join(self.dir, "tmp"))
        run = subprocess.Popen(
            [
                cli.DEMOCLES,
                "run",
                "s.yaml",
                "-o",
                "d",
                "--set",
                "time.end=1e5",
                "--set",
                "output.every=1e5",
            ],
            cwd=self.dir,
            env={**os.environ, "TMPDIR": os.path.join(self.dir, "tmp")},
            preexec_fn=lambda: os.closerange(0, 3),
        )
        while not os.path.exists(os.path.join(self.dir, "d/log.txt")):
            self.assertIsNone(run.poll())
            time.sleep(0.01)
        held = [os.readlink(f"/proc/{run.pid}/fd/{number}") for number in range(3)]
        self.assertEqual(self.names("tmp", "ompi.*"), [])
        run.send_signal(signal.SIGTERM)
        self.assertEqual((run.wait(60), held), (75, ["/dev/null"] * 3))
        self.assertIn("stopped on request", self.text("d/log.txt"))

    def test_full(self):
        """A disk that is full is another matter: what was asked for is not there."""
        with open("/dev/full", "w") as full:
            run = self.call("check", "s.yaml", stdout=full)
        self.assertEqual(run.code, 6)
        self.assertIn("cannot write to the standard output", run.err[0])


if __name__ == "__main__":
    cli.main(2)
