#!/usr/bin/python3
"""scripts/model.py against numbers computed by hand."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts")
sys.path.insert(1, SCRIPTS)
from democles import model, study  # noqa: E402


def spread(value):
    return {"min": value, "mean": value, "max": value}


def record(
    ranks,
    loop,
    compute,
    regroup,
    exchange=0.0,
    wait=0.0,
    launches=0,
    imbalance=0.0,
    sent=(0, 0, 0, 0),
    kernels=None,
):
    """100 steps of 1,000 elements. sent: bytes, messages, neighbours, elements."""
    timers = {
        "loop": loop,
        "compute": compute,
        "exchange": exchange,
        "wait": wait,
        "regroup": regroup,
    }
    raw = {
        "title": "",
        "ranks": ranks,
        "steps": 100,
        "elements": 1000,
        "wall_s": {"loop": loop},
        "digest": "0",
        "devices": [{"name": "a device"}],
        "timers": {name: spread(value) for name, value in timers.items()},
        "plain_steps": {"steps": 50, "launches": 50 * launches * ranks},
        "imbalance": {"mean": imbalance, "max": imbalance},
        "exchange": {
            name: spread(value)
            for name, value in zip(("bytes", "messages", "neighbours", "elements"), sent)
        },
    }
    if kernels:
        raw["kernels"] = {f"k{i}": {"seconds": s, "launches": 100} for i, s in enumerate(kernels)}
        raw["kernels"]["of_lists"] = {"seconds": 0.1, "launches": 3}
    return raw


ONE = record(1, loop=1.0, compute=0.8, regroup=0.2, launches=5, kernels=[0.4, 0.2])
TWO = record(
    2,
    loop=0.6,
    compute=0.4,
    regroup=0.1,
    exchange=0.1,
    wait=0.06,
    launches=7,
    imbalance=0.1,
    sent=(2000, 1, 1, 50),
)
MACHINE = model.Machine(
    bandwidth=2,
    launch_s=1e-5,
    network_bytes_per_s=1e6,
    network_latency_s=1e-3,
    link_bytes_per_s=4e6,
)


class Model(unittest.TestCase):
    def setUp(self):
        self.records = [study.Record(ONE), study.Record(TWO)]
        self.rates = model.rates_of(self.records[0])

    def test_rates(self):
        r = self.rates
        self.assertAlmostEqual(r.kernel_s, 6e-6)  # 0.6 s / 100 steps / 1,000
        self.assertAlmostEqual(r.regroup_s, 2e-6)
        self.assertEqual(r.launches, 5)
        self.assertAlmostEqual(r.launch_s, 4e-4)  # (0.8 - 0.6) s / 100 / 5
        bare = model.rates_of(study.Record(record(1, 1.0, 0.8, 0.2, launches=5)))
        self.assertAlmostEqual(bare.kernel_s, 8e-6)
        self.assertEqual(bare.launch_s, 0)

    def test_step(self):
        """Two ranks: 500 elements each, 10 % more on one, a tenth of them sent."""
        t = model.traffic_at(2, 500, self.records, self.rates)
        self.assertEqual(
            (t.messages, t.bytes, t.boundary, t.imbalance, t.launches), (1, 2000, 50, 0.1, 7)
        )
        parts = model.step_time(500, t, self.rates, MACHINE)
        self.assertAlmostEqual(parts["launches"], 7e-5)
        self.assertAlmostEqual(parts["kernels"], 1.65e-3)  # 6e-6 * 500 * 1.1 / 2
        self.assertAlmostEqual(parts["exchange"], 2.515e-3)  # 1e-3 + 2e-3 + 1e-3 - 0.9 * 1.65e-3
        self.assertAlmostEqual(parts["regroup"], 5e-4)
        hidden = model.step_time(500, t, self.rates, model.Machine())
        self.assertEqual(hidden["exchange"], 0)

    def test_strong(self):
        rows = model.predict("strong", [1, 2], 1000, self.records, self.rates, MACHINE)
        self.assertAlmostEqual(rows[0][11], 4050)  # 50 + 3,000 + 1,000 us
        self.assertEqual(rows[0][12:], [1, 100])
        self.assertAlmostEqual(rows[1][11], 4735)
        self.assertAlmostEqual(rows[1][12], 4050 / 4735)
        self.assertAlmostEqual(rows[1][13], 50 * 4050 / 4735)

    def test_surface(self):
        """Eight ranks by the surface: cubes of half the edge,
        three faces where two ranks have 6 (1 - 2^(-1/3)) = 1.23780."""
        t = model.traffic_at(8, 125, self.records, self.rates)
        self.assertAlmostEqual(t.bytes, 2000 * 0.39685026 * 3 / 1.2377968, places=3)
        self.assertAlmostEqual(t.boundary, 50 * 0.39685026 * 3 / 1.2377968, places=4)
        self.assertAlmostEqual(t.messages, 7)  # (3 - 1)^3 - 1
        self.assertEqual(model.neighbours(2), 1)
        self.assertAlmostEqual(model.neighbours(64), 2.5**3 - 1)
        weak = model.traffic_at(8, 500, self.records, self.rates)
        self.assertAlmostEqual(weak.bytes, 2000 * 3 / 1.2377968, places=3)

    def test_needs_traffic(self):
        with self.assertRaises(SystemExit):
            model.traffic_at(4, 250, self.records[:1], self.rates)

    def test_shares(self):
        """Exchange is without wait, so that all add up."""
        shares = self.records[1].shares()
        for share, right in zip(
            shares, (100 * 0.4 / 0.6, 100 * 0.04 / 0.6, 100 * 0.06 / 0.6, 100 * 0.1 / 0.6)
        ):
            self.assertAlmostEqual(share, right)
        self.assertAlmostEqual(sum(shares), 100)

    def test_program(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for k, raw in enumerate((ONE, TWO)):
                paths.append(os.path.join(folder, f"{k}.json"))
                with open(paths[k], "w") as file:
                    json.dump(raw, file)
            machine = os.path.join(folder, "machine.yaml")
            with open(machine, "w") as file:
                file.write("bandwidth: 2\nlaunch_s: 1e-5\nnetwork_latency_s: 2e-6\n")
            script, out = os.path.join(SCRIPTS, "model.py"), os.path.join(folder, "out")
            run = subprocess.run(
                [script, *paths, "--machine", machine, "--ranks", "1,2,8", "--out", out],
                capture_output=True,
                text=True,
            )
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            self.assertIn("Assumed:", run.stdout)
            self.assertEqual(sorted(os.listdir(out)), ["model.csv", "model.md", "model.png"])
            run = subprocess.run(
                [script, "--check", *paths, "--out", out], capture_output=True, text=True
            )
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            with open(os.path.join(out, "check.csv")) as file:
                rows = [line.strip().split(",") for line in file][1:]
            # One rank: its parts add up. Two: 7 * 400 us + 3,300 us + 1,000 us;
            # 1 - 2.2 us of exchange are hidden.
            self.assertEqual(
                [[round(float(v), 6) for v in row[2:4]] for row in rows],
                [[10000, 10000], [7100, 6000]],
            )
            with open(machine, "w") as file:
                file.write("bandwith: 2\n")
            run = subprocess.run(
                [script, *paths, "--machine", machine], capture_output=True, text=True
            )
            self.assertEqual(run.returncode, 1)
            self.assertIn("unknown key 'bandwith'", run.stderr)


if __name__ == "__main__":
    unittest.main()
