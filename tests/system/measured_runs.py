#!/usr/bin/python3
"""What a frame and a measure say of contacts, against closed forms; the same bits on any number of ranks. Own arguments: names of tests."""
import os

import numpy
import yaml

import parallel_runs
import parallel_scenes
from parallel_runs import frames

COLUMN_STEPS = 600


class Measured(parallel_runs.Case):
    def put(self, scene):
        path = os.path.join(self.dir, "scene.yaml")
        with open(path, "w") as file:
            yaml.safe_dump(scene, file)
        return path

    def test_overlap(self):
        """A column that falls: the largest overlap of each element, found here among all pairs."""
        scene, _ = parallel_scenes.column(parallel_runs.CASES)
        scene["output"] = {"fields": ["overlap", "radius", "id"]}
        alone = None
        for n in (1, 3):
            run = self.good_run(self.put(scene), n, "--steps", str(COLUMN_STEPS))
            frame = frames.Frame(run.frames()[-1])
            order = numpy.argsort(frame.field("id"))
            x, radius, found = frame.points[order], frame.field("radius")[order], frame.field("overlap")[order]
            distance = numpy.linalg.norm(x[:, None] - x[None, :], axis=2)
            numpy.fill_diagonal(distance, numpy.inf)
            expected = ((radius[:, None] + radius[None, :] - distance) / radius[:, None]).max(axis=1).clip(0)
            self.assertLess(abs(found - expected).max(), 1e-12)  # roundings of places of 0.1 m, in units of 4 mm
            self.assertGreater((found > 0).sum(), 50)
            alone = found.tobytes() if n == 1 else alone
            self.assertEqual(found.tobytes(), alone)


if __name__ == "__main__":
    parallel_runs.main(0)
