# Divisions in the path of the tick, from listings as objdump writes them.
# SPDX-License-Identifier: Apache-2.0
import unittest

import stack_bound
from stack_bound_test import listing
from tick_divisions import Forbidden, tick_divisions

TICK = """
100 _kz_tick
jsr @0x200:24
jsr @0x300:24
rts
200 _ramps
divxu.w r1,er2
divxs.b r1l,r2
rts
300 _loop
mulxs.w r1,er2
rts
400 _never_in_a_tick
divxu.w r1,er2
rts
"""


class TickDivisions(unittest.TestCase):
    def check(self, text, allowed):
        return tick_divisions(stack_bound.parse(listing(text)), "_kz_tick", allowed)

    def test_allowed_ones_are_listed(self):
        self.assertEqual(self.check(TICK, {"_ramps": 2}), {"_ramps": 2})

    def test_more_than_allowed(self):
        with self.assertRaisesRegex(Forbidden, "_ramps.* has 2 divisions, of which 1 are allowed"):
            self.check(TICK, {"_ramps": 1})

    def test_in_a_function_not_listed(self):
        with self.assertRaisesRegex(Forbidden, "_ramps"):
            self.check(TICK, {})

    def test_library(self):
        text = TICK.replace("mulxs.w r1,er2", "jsr @0x500:24") + "500 ___udivsi3\nrts\n"
        with self.assertRaisesRegex(Forbidden, "___udivsi3 of a library"):
            self.check(text, {"_ramps": 2})

    def test_no_tick(self):
        with self.assertRaisesRegex(Forbidden, "no function _kz_tick"):
            self.check("100 _other\nrts", {})


if __name__ == "__main__":
    unittest.main()
