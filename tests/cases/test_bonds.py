#!/usr/bin/python3
"""Binding: how fast two spheres may meet and still stick,
and how fast they leave where they do not. Argument: democles."""
import math

import bodies

R, M, K, PULL = 5e-3, 2e-3, 1e3, 0.01  # [m], [kg], [N/m], [N]
M_STAR = M / 2
SPEED = PULL / math.sqrt(K * M_STAR)  # elastic threshold of the relative speed [m/s]
CONTACT = math.pi * math.sqrt(M_STAR / K)  # [s]
DAMPING = {("a", "a"): 0.0, ("a", "b"): 0.1, ("b", "b"): 0.3}  # damping ratio by pairing
GAP = 1e-6  # at the start [m]


def threshold(z):
    """In closed form: the oscillation with friction reaches the pull
    at its first swing outwards."""
    return SPEED * math.exp(z * (math.pi + math.acos(z)) / math.sqrt(1 - z * z))


class Bonds(bodies.Case):
    def run_pairs(self, speeds, steps):
        """speeds: [(pairing, relative speed)].
        Gap [m] and relative speed [m/s] of each at the end, in the order given."""
        rows, place = {"a": [], "b": []}, []
        for k, (pairing, speed) in enumerate(speeds):
            for side, name in zip((-1, 1), pairing):
                place.append((name, len(rows[name])))
                rows[name].append(
                    ([side * (R + GAP / 2), 0.02 * k, 0], [-side * speed / 2, 0, 0], R, [0, 0, 0])
                )
        used = [name for name in rows if rows[name]]
        state = self.run_scene(
            {
                "time": {
                    "end": GAP / min(speed for _, speed in speeds) + 8 * CONTACT,
                    "step": CONTACT / steps,
                },
                "materials": {name: {"density": bodies.density_of(M, R)} for name in used},
                "contacts": [
                    {
                        "between": list(pairing),
                        "normal": {"law": "linear", "stiffness": K, "damping_ratio": z},
                        "binding": {"force": PULL},
                    }
                    for pairing, z in DAMPING.items()
                    if set(pairing) <= set(used)
                ],
                "elements": [
                    {
                        "name": name,
                        "material": name,
                        "file": self.spheres(name + ".csv", rows[name]),
                    }
                    for name in used
                ],
            }
        )
        number = [i + (len(rows["a"]) if name == "b" else 0) for name, i in place]
        ends = list(zip(number[::2], number[1::2]))
        return [
            (state.x[j, 0] - state.x[i, 0] - 2 * R, state.v[j, 0] - state.v[i, 0]) for i, j in ends
        ]

    def test_threshold(self):
        """0.999 of it sticks, 1.001 of it does not."""
        speeds = [
            (pairing, factor * threshold(z))
            for pairing, z in DAMPING.items()
            for factor in (0.999, 1.001)
        ]
        for k, (gap, _) in enumerate(self.run_pairs(speeds, 1000)):
            sticks = gap < PULL / K
            print(f"{speeds[k]}: gap {gap:.3g} m, {'sticks' if sticks else 'apart'}")
            self.assertEqual(sticks, k % 2 == 0)
            if not sticks:
                self.assertGreater(gap, 1.5 * PULL / K)

    def test_speed_of_leaving(self):
        """Breaking takes F_b^2/(2 k): v'^2 = v^2 - F_b^2/(k m*).
        The bond breaks up to one step late, so the step is small here."""
        speeds = [(("a", "a"), factor * SPEED) for factor in (1.5, 2, 4)]
        for (_, before), (_, after) in zip(speeds, self.run_pairs(speeds, 8000)):
            error = abs(after / math.sqrt(before**2 - SPEED**2) - 1)
            self.below(
                f"{before / SPEED:g} times the threshold: error of the speed of leaving, relative",
                error,
                1e-3,
            )


if __name__ == "__main__":
    bodies.main()
