#!/usr/bin/python3
"""The list of frames that ParaView and films read. Own argument: results_tool."""
import json
import os

import parallel_runs
import resume_runs
import robust_jobs
from parallel_runs import frames


class Listed(resume_runs.Case):
    """frames.hdf.series: frames of output.every with their times, whatever has happened."""

    def steps(self, folder):
        with open(os.path.join(folder, "frames.hdf.series")) as file:
            content = json.load(file)
        self.assertEqual(content["file-series-version"], "1.0")
        for entry in content["files"]:
            self.assertEqual(frames.Frame(os.path.join(folder, entry["name"])).time, entry["time"])
        self.assertEqual(
            [path.name for path in frames.shown(folder)], [e["name"] for e in content["files"]]
        )
        return [round(entry["time"] / 2e-5) for entry in content["files"]]

    def test_checkpoints(self):
        content = robust_jobs.bed(frame_every=60)
        content["output"]["checkpoint_every"] = 40 * 2e-5
        run = self.good_run(self.put(content), 3, "--steps", "130")
        self.assertEqual(len(run.frames()), 6)
        self.assertEqual(self.steps(run.dir), [0, 60, 120])
        self.resume(run.dir, 1, "--steps", "200")
        self.assertEqual(self.steps(run.dir), [0, 60, 120, 180])
        # as a run leaves it that is killed between its frame and the list
        for path in run.frames()[5:]:
            path.unlink()
        with open(os.path.join(run.dir, "frames.hdf.series")) as file:
            lines = file.read().splitlines()
        with open(os.path.join(run.dir, "frames.hdf.series"), "w") as file:
            file.write("\n".join([*lines[:2], lines[2].rstrip(","), "]}"]))
        self.assertEqual(self.steps(run.dir), [0, 60])
        self.resume(run.dir, 3, "--steps", "190")
        self.assertEqual(self.steps(run.dir), [0, 60, 120, 180])

    def test_ends(self):
        content = robust_jobs.bed(frame_every=0)
        run = self.good_run(self.put(content), 1, "--steps", "50")
        self.assertEqual(self.steps(run.dir), [0, 50])


if __name__ == "__main__":
    parallel_runs.main(1)
