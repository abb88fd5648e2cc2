# The scoring of photographs.py.
# SPDX-License-Identifier: Apache-2.0
import pathlib
import struct
import tempfile
import unittest

from photographs import Ball, Find, balls_of, learning_balls, match, on_a_ball, region_of, tables


def ball(u=100, v=100, side=40, visible="whole", pale=False, picture="p"):
    return Ball(picture, 0, u, v, side, side, visible, pale)


class Scoring(unittest.TestCase):
    def test_a_find_needs_center_and_diameter(self):
        for u, diameter, found in ((100, 40, 1), (119, 40, 1), (121, 40, 0), (100, 29, 1), (100, 27, 0),
                                   (100, 51, 1), (100, 53, 0)):
            pairs, rest = match([ball()], [Find(u, 100, diameter)])
            self.assertEqual((len(pairs), len(rest)), (found, 1 - found), (u, diameter))

    def test_a_ball_is_found_once_and_by_the_nearest(self):
        pairs, rest = match([ball()], [Find(110, 100, 40), Find(101, 100, 40)])
        self.assertEqual(pairs, {0: Find(101, 100, 40)})
        self.assertEqual(rest, [Find(110, 100, 40)])
        self.assertTrue(on_a_ball(rest[0], [ball()]))
        self.assertFalse(on_a_ball(Find(130, 100, 40), [ball()]))

    def test_two_balls_need_two_finds(self):
        pairs, rest = match([ball(), ball(u=130)], [Find(116, 100, 40)])
        self.assertEqual((len(pairs), rest), (1, []))

    def test_the_color_is_learned_at_other_places(self):
        def of(place):
            return {f"{place}/{n}": [ball(side=n, picture=f"{place}/{n}", pale=n == 99,
                                          visible="cut" if n == 98 else "whole")]
                    for n in (99, 98, *range(20, 30))}
        chosen = learning_balls({place: of(place) for place in "abc"}, "b")
        self.assertEqual(len(chosen), 10)
        self.assertEqual({b.picture[0] for b in chosen}, {"a", "c"})
        self.assertEqual({b.width for b in chosen}, set(range(25, 30)))
        self.assertEqual(region_of(ball()), "90,90,20,20")

    def test_tables_count_whole_balls_apart(self):
        places = {"a": {"a/1": [ball(), ball(u=300, visible="cut")], "a/2": []}}
        finds = {"a/1": [Find(100, 100, 40), Find(300, 100, 10)], "a/2": [Find(5, 5, 9)]}
        rows, falses, _ = tables(places, finds)
        self.assertEqual(rows[:2], [("a", ">= 20 px", "whole", 1, 1),
                                    ("a", ">= 20 px", "cut off or hidden", 1, 0)])
        self.assertEqual(falses[0], ("a", 2, 3, 2, 1))

    def test_labels_are_in_pixels(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            header = b"\xff\xd8\xff\xe0\x00\x04ab\xff\xc0" + struct.pack(">HBHH", 11, 8, 80, 60) + bytes(9)
            (folder / "p.jpg").write_bytes(header)
            (folder / "p.txt").write_text("1 0 0 1 1\n0 0.5 0.5 0.2 0.1\n")
            notes = {("p", "0"): {"visible": "hidden", "almost_white": "1"}}
            self.assertEqual(balls_of(folder, "p", notes), [Ball("p", 0, 29.5, 39.5, 12, 8, "hidden", True)])


if __name__ == "__main__":
    unittest.main()
