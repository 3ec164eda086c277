#!/usr/bin/python3
"""The same bits on any number of ranks: state, contacts with their histories, measures.
Own arguments: `some` or `all`, the scenes."""
import parallel_runs

# With `some` one precision for each scene: that in which resume_runs.py runs it too, if it does, so
# that kernels are compiled once for both.
SOME = {
    "funnel": "mixed",
    "gas_x": "mixed",
    "gas_xyz": "single",
    "shear": "mixed",
    "thin": "single",
}
SOME_RANKS = (1, 3)
# With `all` everything for the scenes that stand for whole cases; the rest takes turns.
FULL = {"double": (1, 2, 3, 4, 8), "single": (1, 2, 3, 4, 8), "mixed": (1, 3)}
PART = {"double": (1, 3, 8), "single": (1, 4), "mixed": (1, 2)}
RANKS = {"funnel": FULL, "column": FULL, "hertz": FULL}


def runs(name):
    """precision -> numbers of ranks."""
    if parallel_runs.OWN[0] == "some":
        return {SOME.get(name, "double"): SOME_RANKS}
    return RANKS.get(name, PART)


def of_all(run):
    """What must not depend on ranks."""
    record = run.record()
    same = {
        key: record[key]
        for key in (
            "digest",
            "steps",
            "dt",
            "dt_limit",
            "elements",
            "elements_removed",
            "rebuilds",
            "energy",
            "momentum",
            "trust",
        )
    }
    return same, run.series(), run.contacts()


class Digest(parallel_runs.Case):
    def test_ranks(self):
        for name in parallel_runs.OWN[1:]:
            scene = self.scene(name)
            for precision, ranks in runs(name).items():
                alone, moved = None, 0
                for n in ranks:
                    with self.subTest(scene=name, precision=precision, ranks=n):
                        run = self.good_run(scene, n, "--precision", precision)
                        found = of_all(run)
                        record = run.record()
                        alone = alone or found
                        self.assertEqual(found[0], alone[0])
                        self.assertEqual(found[1], alone[1])
                        self.assertEqual(found[2], alone[2])
                        self.assertEqual((record["ranks"], record["precision"]), (n, precision))
                        self.assertGreater(record["rebuilds"], 2)
                        if name != "apart":  # there is something to get wrong
                            self.assertGreater(record["energy"]["end"]["dashpot_normal"], 0)
                            self.assertGreater(record["energy"]["end"]["sliding"], 0)
                        moved += record["migrations"]
                if name != "three":
                    self.assertGreater(
                        moved, 0, "nothing has changed hands: the test tests nothing"
                    )


if __name__ == "__main__":
    parallel_runs.main()
