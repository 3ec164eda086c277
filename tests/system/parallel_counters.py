#!/usr/bin/python3
"""Within a step the state stays on the device: nothing is allocated, and between host and device go
the two flags and, on several ranks, ghosts."""
import parallel_runs

FLAGS = 8  # [byte] two ints, read after some drifts
BATCH = 1024  # steps whose wall poses are uploaded at once


class Counters(parallel_runs.Case):
    def plain(self, name, ranks, precision):
        record = self.good_run(self.scene(name), ranks, "--precision", precision).record()
        steps = record["plain_steps"]
        self.assertGreater(steps["steps"], record["steps"] // 2)
        self.assertGreaterEqual(steps["launches"], 2 * steps["steps"] * ranks)
        self.assertEqual(steps["allocations"], 0)
        return record, steps

    def test_one_rank(self):
        for name, precision in (("hertz", "double"), ("gas_xyz", "single"), ("moving", "double")):
            with self.subTest(scene=name):
                record, steps = self.plain(name, 1, precision)
                self.assertEqual(steps["from_device_bytes"], FLAGS * steps["from_device"])
                self.assertLessEqual(
                    steps["from_device"], steps["steps"] / 3
                )  # flags are read every fourth step
                self.assertGreater(steps["from_device"], steps["steps"] / 5)
                self.assertLessEqual(
                    steps["to_device"], record["steps"] // BATCH if name == "moving" else 0
                )
                self.assertEqual(record["halo_bytes_per_step"], 0)

    def test_ranks(self):
        """What the ghosts bring to one rank they have taken from another."""
        ranks = 3
        for name, precision, word in (("hertz", "double", 8), ("gas_xyz", "single", 4)):
            with self.subTest(scene=name):
                record, steps = self.plain(name, ranks, precision)
                ghosts = steps["from_device_bytes"] - FLAGS * (
                    steps["from_device"] - steps["to_device"]
                )
                self.assertEqual(ghosts, steps["to_device_bytes"])
                self.assertGreater(ghosts, 0)
                # position and radius, velocity and mass, spin and material; kicks of velocity
                # and of spin, float4 each, where contacts are damped
                features = record["features"]
                row = 12 * word + 16 * (features["kick"] + features["spin_kick"])
                self.assertEqual(ghosts % row, 0)
                self.assertLess(ghosts / steps["steps"], record["elements"] * row * ranks)
                self.assertLessEqual(steps["from_device"], 1.5 * ranks * steps["steps"])
                self.assertLessEqual(steps["to_device"], ranks * steps["steps"])


if __name__ == "__main__":
    parallel_runs.main(0)
