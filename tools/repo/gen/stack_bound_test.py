# The stack's bound from listings as objdump writes them.
# SPDX-License-Identifier: Apache-2.0
import unittest

import stack_bound


def listing(text):
    """Lines of `address name` open a function, others are instructions."""
    lines, address = [], 0
    for line in text.strip().splitlines():
        words = line.split(None, 1)
        if line[0].isdigit():
            address = int(words[0], 16)
            lines.append(f"{address:016x} <{words[1]}>:")
        else:
            lines.append(f"    {address:x}:\t01 00 \t{words[0]}\t{words[1] if len(words) > 1 else ''}")
            address += 2
    return lines


CHAIN = """
100 _start
mov.l #0xfff000,er7
jsr @0x200:24
200 _outer
stm.l er4-er6,@-sp
add.l #0xffffffec,er7
jsr @0x300:24
bsr .-4 (0x400)
add.l #0x14,er7
ldm.l @sp+,er4-er6
rts
300 _leaf
mov.l er4,@-er7
mov.l @er7+,er4
rts
400 _other
subs #4,er7
adds #4,er7
rts
500 _handler
stm.l er0-er3,@-sp
ldm.l @sp+,er0-er3
rte
"""


class StackBound(unittest.TestCase):
    def bound(self, text, start="_start"):
        functions = stack_bound.parse(listing(text))
        address = next(a for a, f in functions.items() if f.name == start)
        return stack_bound.deepest(functions, address)

    def test_calls_out_of_a_section(self):
        functions = stack_bound.parse(listing(CHAIN))
        self.assertEqual(stack_bound.calls_out_of(functions, 0x200, 0x400), [("_outer", 0x400)])
        self.assertEqual(stack_bound.calls_out_of(functions, 0x200, 0x500), [])

    def test_deepest_path(self):
        # start: return address 4; outer: 12 + 20, return address 4; leaf: 4.
        self.assertEqual(self.bound(CHAIN), (44, ["_start", "_outer", "_leaf"]))

    def test_handler(self):
        functions = stack_bound.parse(listing(CHAIN))
        self.assertTrue(functions[0x500].is_handler)
        self.assertEqual(functions[0x500].frame, 16)

    def test_recursion(self):
        with self.assertRaisesRegex(stack_bound.Unbounded, "calls itself"):
            self.bound("100 _start\njsr @0x100:24")

    def test_pointer(self):
        with self.assertRaisesRegex(stack_bound.Unbounded, "through a pointer"):
            self.bound("100 _start\njsr @er2")

    def test_computed(self):
        with self.assertRaisesRegex(stack_bound.Unbounded, "computes the stack pointer"):
            self.bound("100 _start\nsub.l er0,er7")


if __name__ == "__main__":
    unittest.main()
