#!/usr/bin/python3
"""Runs that cannot be: each has one message, its exit code, leaves nothing half-done, and no rank
waits for ever. Own argument: results_tool."""
import os
import pathlib
import resource
import shutil
import subprocess

import numpy

import parallel_runs
import scene_parts
import robust_jobs


class Failures(robust_jobs.Case):
    def fails(self, scene, ranks, code, says, *args, **more):
        """Exit code and message of a failed run, once for all ranks."""
        run = self.run_scene(scene, ranks, *args, **more)
        errors = [line for line in run.err.splitlines() if line.startswith("democles: error: ")]
        self.assertEqual((run.code, len(errors)), (code, 1), run.err)
        self.assertRegex(errors[0], says)
        self.assertEqual(self.leftovers(run.dir), [])
        return run

    def failed_record(self, run, code):
        record = run.record()
        self.assertEqual((record["exit"], record["digest"]), (code, None))
        return record


class Numerics(Failures):
    """Most with the same features, whose kernels are compiled once: one law, walls if only far
    away, the account of energy if only of the start."""

    FAR = [scene_parts.box("far", (-5, -5, -5), (5, 5, 5))]
    AT_THE_START = [{"name": "energy", "every": 1e3, "energy": "all"}]

    def test_step_over_limit(self):
        """Two spheres that touch may take 2/sqrt(2k/m) = 5.7e-4 s, with a damping ratio of 0.1
        4.7e-4 s, a bed that has come to rest less: the first is refused at once, the other
        then."""
        contact = {"normal": {**scene_parts.LINEAR, "damping_ratio": 0}}
        pair = scene_parts.scene(
            1000, 6e-4, contact, [{"name": "pair", "file": "pair.csv"}], self.FAR
        )
        with open(os.path.join(self.dir, "pair.csv"), "w") as file:
            file.write("x,y,z,radius\n0,0,0,0.0025\n0.004999,0,0,0.0025\n")
        fall = scene_parts.scene(
            2000,
            4.5e-4,
            {"normal": scene_parts.LINEAR},
            [scene_parts.block("balls", (0, 0, 0), (0.02, 0.02, 0.03), 0.005)],
            [scene_parts.box("room", (0, 0, 0), (0.02, 0.02, 0.1))],
        )
        fall["measure"] = self.AT_THE_START  # the budget of energy would find it first
        for scene, ranks, when in ((pair, 1, r"0, t = 0 s"), (fall, 3, r"[1-9]\d*, t = \S+ s")):
            run = self.fails(
                self.put(scene),
                ranks,
                5,
                r"step "
                + when
                + r": the time step 0\.000\d+ s exceeds the critical time step .* element \d+",
            )
            record = self.failed_record(run, 5)
            self.assertGreater(record["dt"], record["dt_limit"])
            self.whole(run.dir)

    def test_energy_runs_away(self):
        """The same, seen by the budget of energy long before numbers end."""
        contact = {"normal": {**scene_parts.LINEAR, "damping_ratio": 0}}
        room = [scene_parts.box("room", (0, 0, 0), (0.03, 0.03, 0.03))]
        packed = scene_parts.scene(
            200,
            1.5e-3,
            contact,
            [scene_parts.block("packed", (0, 0, 0), (0.03, 0.03, 0.03), 0.005, velocity=(1, 1, 1))],
            room,
            observe=50,
        )
        packed["time"]["allow_unstable"] = True
        run = self.fails(
            self.put(packed),
            3,
            5,
            r"step \d+, .*: the energy is not a number, or too large to measure",
        )
        self.failed_record(run, 5)

    def test_nan_in_the_last_step(self):
        """Too few steps for the flags of the drift to be read:
        1e-41 kg are no mass in single precision."""
        dust = scene_parts.scene(
            3,
            1e-5,
            {"normal": scene_parts.LINEAR},
            [{"name": "dust", "file": "dust.csv", "velocity": [0, 0, 1]}],
        )
        dust["measure"], dust["precision"] = [], "single"
        with open(os.path.join(self.dir, "dust.csv"), "w") as file:
            file.write("x,y,z,radius\n0,0,0,1e-18\n0,0,0.1,0.001\n")
        run = self.fails(self.put(dust), 3, 5, "step 0, t = 0 s: the last state holds NaN")
        self.failed_record(run, 5)
        self.assertEqual(run.frames(), [])

    def test_state_without_numbers_is_no_frame(self):
        """Far over its limit, a frame in each step: those before stay, and `resume` takes one."""
        contact = {"normal": {**scene_parts.LINEAR, "damping_ratio": 0}}
        room = [scene_parts.box("room", (0, 0, 0), (0.03, 0.03, 0.03))]
        block = scene_parts.block("b", (0, 0, 0), (0.03, 0.03, 0.03), 0.005, velocity=(1, 1, 1))
        scene = scene_parts.scene(2000, 1, contact, [block], room)
        scene["time"]["allow_unstable"], scene["measure"] = True, self.AT_THE_START
        scene["output"] = {"every": 1}
        run = self.run_scene(self.put(scene), 1)
        self.assertEqual(run.code, 5, run.err)
        self.failed_record(run, 5)
        self.assertGreater(self.whole(run.dir), 1)
        for path in run.frames():
            self.assertTrue(numpy.isfinite(parallel_runs.frames.Frame(path).points).all(), path)
        log = pathlib.Path(run.dir, "log.txt").read_text()
        self.assertRegex(log, r"error: step \d+, .* not numbers")
        again = subprocess.run(
            [parallel_runs.DEMOCLES, "resume", run.dir], capture_output=True, text=True
        )
        self.assertEqual(again.returncode, 5)
        self.assertIn(f"resumes from step {len(run.frames()) - 1},", again.stdout)

    def test_lost_element(self):
        free = scene_parts.scene(
            10**4,
            1e-4,
            {"normal": scene_parts.LINEAR},
            [scene_parts.block("free", (0, 0, 0), (0.02, 0.02, 0.02), 0.005, velocity=(1, 0, 0))],
            self.FAR,
            domain={"box": {"min": [-0.1, -0.1, -1], "max": [0.1, 0.1, 1]}},
        )
        run = self.fails(self.put(free), 3, 5, r"step \d+, t = .*: .*element \d+ .*domain")
        self.failed_record(run, 5)
        self.whole(run.dir)


class Unstable(Failures):
    def test_blow_up(self):
        """Some times the stable step: the run finds out by itself,
        and the frames until then stay."""
        contact = {"normal": {**scene_parts.LINEAR, "damping_ratio": 0}}
        room = [scene_parts.box("room", (0, 0, 0), (0.03, 0.03, 0.03))]
        packed = scene_parts.scene(
            10**5,
            1.5e-3,
            contact,
            [scene_parts.block("packed", (0, 0, 0), (0.03, 0.03, 0.03), 0.005, velocity=(1, 1, 1))],
            room,
        )
        packed["time"]["allow_unstable"] = True
        packed["output"] = {"every": 0.015}
        packed["measure"] = []
        for ranks, domain in ((1, {}), (3, {"remove_outside": True})):
            with self.subTest(ranks=ranks, domain=domain):
                packed["domain"] = domain
                run = self.run_scene(self.put(packed), ranks, "--steps", "2000")
                record = run.record()
                if domain and run.code == 0:
                    self.assertEqual(
                        (record["exit"], record["elements_removed"]), (0, record["elements"])
                    )
                else:
                    self.assertEqual(run.code, 5, run.err)
                    self.assertRegex(run.err, r"(?m)^democles: error: step \d+, .*not numbers")
                    self.failed_record(run, 5)
                self.assertEqual(self.leftovers(run.dir), [])
                self.assertGreater(self.whole(run.dir), 0)


class Environment(Failures):
    def test_no_device(self):
        scene = self.put(robust_jobs.bed())
        run = self.fails(
            scene, 3, 4, "no OpenCL device was found", env={"OCL_ICD_VENDORS": self.dir}
        )
        self.assertFalse(os.path.exists(os.path.join(run.dir, "run.json")))
        self.fails(scene, 1, 4, "no such thing", "--device", "no such thing")

    def test_kernel_that_does_not_build(self):
        """Sources from a folder, one of them broken: options,
        log and place of the source are said."""
        folder = os.path.join(self.dir, "kernels")
        shutil.copytree(os.path.join(os.path.dirname(parallel_runs.CASES), "kernels"), folder)
        with open(os.path.join(folder, "particle", "gather.cl"), "a") as file:
            file.write("\nthis is no kernel\n")
        run = self.run_scene(
            self.put(robust_jobs.bed()), 3, env={"DEMOCLES_KERNELS": folder, "TMPDIR": self.dir}
        )
        self.assertEqual(run.code, 4, run.err)
        self.assertRegex(
            run.err, r"(?m)^democles: error: .*does not build on .*options: .*source: "
        )
        self.assertRegex(run.err, r"gather\.cl:\d+:\d+: unknown type name 'this'")

    has_kernels = False

    def bed_with_kernels(self):
        """A scene whose kernels are there: pocl writes files too, where it compiles them."""
        scene = self.put(robust_jobs.bed(frame_every=50))
        if not Environment.has_kernels:
            self.good_run(scene, 3, "--steps", "1500", name="before")
            Environment.has_kernels = True
        return scene

    def test_file_size_limit(self):
        """As a disk that fills up while the run is under way: what was written before stays.
        Ranks that write a frame together may find it together."""
        job = self.job(self.bed_with_kernels(), 3)
        job.wait_frames(2)
        limit = os.path.getsize(job.frames()[0]) // 2
        for pid in job.pids().values():
            resource.prlimit(pid, resource.RLIMIT_FSIZE, (limit, limit))
        self.assertEqual(job.end(), 6, job.err())
        self.assertGreater(len(job.errors()), 0, job.err())
        for error in job.errors():
            self.assertRegex(error, r"(frame_\d+\.hdf|energy\.csv|log\.txt).*: File too large")
        self.assertEqual(self.leftovers(job.dir), [])
        self.assertGreaterEqual(self.whole(job.dir), 2)

    def told_by_the_last(self, job, code, says):
        """What only the last rank meets stands in log.txt and run.json, too."""
        self.assertEqual(job.end(), code, job.err())
        self.assertEqual(len(job.errors()), 1, job.err())
        text = job.errors()[0].removeprefix("democles: error: ")
        self.assertRegex(text, f"^rank {job.ranks - 1}: .*{says}")
        log = pathlib.Path(job.dir, "log.txt").read_text()
        self.assertTrue(log.startswith("democles "), log)
        self.assertIn(f"error: {text}\nexit code {code}\n", log)
        record = parallel_runs.Run(job.dir, code, "").record()
        self.assertEqual((record["error"], record["exit"]), (text, code))
        self.assertEqual(self.leftovers(job.dir), [])

    def test_error_of_another_rank(self):
        """In the set-up, where its kernels are missing; later, where its files may not grow."""
        scene, path = self.bed_with_kernels(), os.path.join(self.dir, "last")
        with open(path, "w") as file:
            file.write(
                f'#!/bin/sh\n[ "${parallel_runs.mpi.rank_variable()}" = 2 ] &&'
                f' export DEMOCLES_KERNELS=/nowhere\nexec "{parallel_runs.DEMOCLES}" "$@"\n'
            )
        os.chmod(path, 0o755)
        job = self.job(scene, 3, name="kernels", program=path)
        self.told_by_the_last(job, 4, "DEMOCLES_KERNELS: cannot read")

        job = self.job(scene, 2, name="files")
        job.wait_frames(1)
        resource.prlimit(job.pids()[1], resource.RLIMIT_FSIZE, (2000, 2000))
        self.told_by_the_last(job, 6, "cannot write .*File too large")

    def test_folder_that_cannot_be(self):
        self.put(robust_jobs.bed())
        with open(os.path.join(self.dir, "file"), "w"):
            pass
        for ranks in (1, 3):
            run = subprocess.run(
                parallel_runs.command(ranks, "run", "scene.yaml", "-o", "file/out"),
                cwd=self.dir,
                capture_output=True,
                text=True,
                timeout=parallel_runs.HANG,
            )
            self.assertEqual(run.returncode, 6, run.stderr)
            self.assertEqual(run.stderr.count("democles: error: "), 1)


class Disk(Failures):
    def test_full_disk(self):
        """Where a small file system may be mounted."""
        disk, scene = os.path.join(self.dir, "disk"), self.put(robust_jobs.bed(frame_every=50))
        os.mkdir(disk)
        if subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", disk], capture_output=True
        ).returncode:
            self.skipTest("no right to mount")
        try:
            run = self.fails(scene, 3, 6, "No space left on device", name="disk/out")
            self.assertGreaterEqual(self.whole(run.dir), 1)
            record = run.record()
            self.assertEqual((record["exit"], record["ranks"]), (6, 3))
            self.assertIn("No space left on device", record["error"])
            log = pathlib.Path(run.dir, "log.txt").read_text()
            self.assertRegex(log, "error: .*No space left on device")
        finally:
            subprocess.run(["umount", "-l", disk], check=True)


if __name__ == "__main__":
    parallel_runs.main(1)
