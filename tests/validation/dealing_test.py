#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of the simulated dealing of pings (validation/scaling/dealing.py)."""
import pathlib
import sys
import unittest

import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "validation/scaling"))
from dealing import REST_S, Costs, Dealing, correlation, predict, resampled  # noqa: E402

SEED = 20240611


class DealingLaws(unittest.TestCase):
    def setUp(self):
        self.seconds = numpy.random.default_rng(SEED).gamma(4, 0.005, 3000)  # 20 ms in the mean

    def test_a_rank_alone_takes_the_sum(self):
        self.assertAlmostEqual(Dealing(self.seconds, 1, 1, Costs(result=1, request=1)).end, self.seconds.sum(), places=6)

    def test_no_rank_gains_more_than_its_share_nor_loses_more_than_waiting(self):
        for ranks in (2, 7, 40):
            for threads in (1, 3):
                end = Dealing(self.seconds, ranks, threads, Costs()).end
                share = self.seconds.sum() / (ranks * threads)
                self.assertGreaterEqual(end, share)
                # Of greedy dealing (Graham 1969), and a request now and then.
                self.assertLess(end, share + self.seconds.max() + 30 * REST_S + 0.03 * share, f"{ranks} of {threads}")

    def test_nobody_ends_with_many(self):
        cheap = self.seconds / 20  # a tenth of a second's worth for 40 ranks is more than there is
        self.assertLess(Dealing(cheap, 40, 1, Costs()).end, 1.5 * cheap.sum() / 40 + 10 * REST_S)

    def test_rank_0_bounds_what_comes_in(self):
        result = 0.002  # with 40 ranks pings end every half a millisecond: rank 0 gets one in two
        dealing = Dealing(self.seconds, 40, 1, Costs(result=result, request=1e-5))
        self.assertGreater(dealing.lead_busy / dealing.end, 0.97)
        self.assertLessEqual(dealing.lead_busy / dealing.end, 1)
        by_others = dealing.lead_busy / result
        self.assertGreater(by_others, 0.9 * len(self.seconds))
        self.assertLessEqual(by_others, 1.1 * len(self.seconds))

    def test_parts_add_up(self):
        costs = Costs(load=3, result=1e-4, request=5e-5, write=0.001, finish=2, launch=1)
        found = predict(self.seconds, 10, 1, costs)
        self.assertAlmostEqual(found["total"], 4 + Dealing(self.seconds, 10, 1, costs).end + 3 + 2, places=6)
        self.assertAlmostEqual(found["parts"]["pings"], self.seconds.sum() / 10, places=9)

    def test_drawn_pings_are_the_measured_ones_and_stay_beside_their_neighbours(self):
        slow = numpy.repeat(numpy.arange(1.0, 21), 50)  # neighbours alike
        drawn = resampled(slow, 20000, 25, SEED)
        self.assertEqual(len(drawn), 20000)
        self.assertTrue(set(drawn) <= set(slow))
        self.assertAlmostEqual(drawn.mean() / slow.mean(), 1, delta=0.05)
        self.assertGreater(correlation(drawn), 0.9)
        self.assertLess(abs(correlation(resampled(slow, 20000, 1, SEED))), 0.05)


if __name__ == "__main__":
    print(f"seed {SEED}")
    unittest.main()
