# kaz.figures: each figure shows its run, a recording gives the same figure, and wrong options are refused.
# SPDX-License-Identifier: Apache-2.0
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

try:
    from matplotlib.image import imread
except ImportError:
    imread = None

import kaz

HANG_S = 1200  # of a busy machine


def figures(*arguments):
    return subprocess.run([sys.executable, "-B", "-m", "kaz.figures", *map(str, arguments)],
                          capture_output=True, text=True, timeout=HANG_S)


def red(r, g, b):
    return (r > g + 60) & (r > b + 60)


def green(r, g, b):
    return (g > r + 40) & (g > b + 20)


def blue(r, g, b):
    return (b > r + 60) & (b > g)


def gray(r, g, b):
    return (numpy.abs(r - g) < 3) & (numpy.abs(g - b) < 3)


def black(r, g, b):
    return gray(r, g, b) & (r < 80)


def unseen(r, g, b):
    return gray(r, g, b) & (numpy.abs(r - 128) < 3)


def share(picture, left, top, right, bottom, color):
    """Returns the share of the pixels with a color, in a part of the picture given in shares of its sides."""
    height, width = picture.shape[:2]
    part = picture[int(top * height):int(bottom * height), int(left * width):int(right * width)]
    return color(*numpy.moveaxis(part.astype(int), -1, 0)).mean()


@unittest.skipIf(imread is None, "matplotlib is not installed")
class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.out = cls.folder / "out"
        cls.done = figures("--only", "3,5,6,7", "--goal", "0.4,-0.15", "--mcu", "native", "--seed", "3",
                           "--out", cls.out, "--json")
        if cls.done.returncode == 0:
            cls.facts = json.loads(cls.done.stdout)["figures"]

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.assertEqual((self.done.returncode, self.done.stderr), (0, ""))

    def picture(self, number):
        return numpy.rint(255 * imread(self.out / f"figure{number}.png")[..., :3]).astype(int)

    def test_the_folder_has_the_figures_their_numbers_and_a_page(self):
        self.assertEqual(json.loads((self.out / "result.json").read_text()), json.loads(self.done.stdout))
        names = {f"figure{number}.{ending}" for number in (3, 5, 6, 7) for ending in ("png", "jpg")}
        self.assertEqual({path.name for path in self.out.iterdir()}, names | {
            "figures.html", "result.json", "navigate", "sweep", "track-ball"})
        page = (self.out / "figures.html").read_text()
        self.assertIn("figure3.png", page)
        self.assertNotIn("figure8.png", page)

    def test_a_scene_has_ball_depth_and_flow(self):
        facts, picture = self.facts["3"], self.picture(3)
        self.assertGreater(picture.shape[1], 800)
        self.assertGreater(facts["ball_moved_px"], 1)
        self.assertGreater(facts["depth_known"], 0.3)
        self.assertGreater(facts["flow_known"], 0.3)
        disc = math.pi * facts["ball_radius_px"] ** 2
        self.assertAlmostEqual(facts["ball_pixels"], disc, delta=0.3 * disc)
        self.assertTrue(0.0005 < share(picture, 0.5, 0, 1, 0.5, red) < 0.05)
        self.assertGreater(share(picture, 0.5, 0, 1, 0.45, gray), 0.9)
        self.assertLess(share(picture, 0, 0.55, 0.5, 0.9, gray), 0.6)  # depth in colors
        self.assertGreater(share(picture, 0.5, 0.5, 1, 1, blue), 0.01)  # arrows of flow

    def test_a_recording_gives_the_same_figure_and_no_other(self):
        recorded = self.out / "track-ball"
        again = figures("--recording", recorded, "--only", "3", "--out", self.folder / "again")
        self.assertEqual(again.returncode, 0, again.stderr)
        name = "figure3.png"
        self.assertEqual((self.folder / "again" / name).read_bytes(), (self.out / name).read_bytes())
        other = figures("--recording", recorded / "recording.mcap", "--only", "6",
                        "--out", self.folder / "other")
        self.assertEqual(other.returncode, 2)
        self.assertIn("a run of track-ball shows figures [3, 5]", other.stderr)
        self.assertFalse((self.folder / "other").exists())

    def test_setup_map_and_path_are_those_of_the_walk(self):
        for found, true, delta in zip(self.facts["5"]["ball_m"], (1.4, 0.1), (0.03, 0.01)):
            self.assertAlmostEqual(found, true, delta=delta)  # of sim/worlds/boxes.sdf
        self.assertGreater(self.picture(5).shape[1], 800)
        self.assertGreater(share(self.picture(5), 0, 0, 0.49, 0.9, blue), 0.003)  # a box
        facts, picture = self.facts["6"], self.picture(6)
        self.assertEqual(len(facts["frames"]), 5)
        for frame, pan in zip(facts["frames"], (60, 30, 0, -30, -60)):
            self.assertAlmostEqual(frame["pan_deg"], pan, delta=4)
            self.assertGreater(frame["floor_m2"], 0.1)
            self.assertLess(1.5 * frame["floor_m2"], facts["floor_m2"])  # merged from several
        self.assertGreater(facts["obstacle_m2"], 0.01)
        self.assertAlmostEqual(facts["path_m"][-1][0], 0.4, delta=0.01)
        self.assertAlmostEqual(facts["path_m"][-1][1], -0.15, delta=0.01)
        self.assertGreaterEqual(facts["path_length_m"], math.hypot(0.4, 0.15) - 0.01)
        walk = json.loads((self.out / "navigate/result.json").read_text())
        self.assertEqual(walk["outcome"], "done")
        self.assertLess(facts["planned_s"], kaz.Recording(self.out / "navigate/recording.mcap").duration_s)
        self.assertGreater(picture.shape[0], 700)
        self.assertGreater(share(picture, 0, 0, 1, 0.18, red), 0.1)  # planes
        for top in (0.22, 0.5):
            self.assertGreater(share(picture, 0, top, 1, top + 0.15, unseen), 0.02)
            self.assertGreater(share(picture, 0, top, 1, top + 0.15, black), 0.001)
        self.assertGreater(share(picture, 0.5, 0.5, 1, 1, red), 0.001)  # the path
        self.assertLess(share(picture, 0, 0.5, 0.49, 1, red), 1e-6)  # no path

    def test_frame_information_keeps_the_floor_out_of_the_boxes(self):
        facts, picture = self.facts["7"], self.picture(7)
        self.assertGreater(facts["pictures"], 100)
        self.assertGreater(picture.shape[0], 600)
        boxes = facts["boxes_m2"]
        yard = 0.06 * 0.30 + 0.30 * 0.06 + 0.12 * 0.24  # sim/worlds/yard.sdf
        self.assertAlmostEqual(boxes, yard, delta=0.002)
        self.assertLess(facts["with_frame_information"]["floor_in_boxes_m2"], 0.05 * boxes)
        self.assertGreater(facts["without"]["floor_in_boxes_m2"], 0.3 * boxes)
        for left in (0.35, 0.67):
            self.assertGreater(share(picture, left, 0.02, left + 0.3, 0.27, green), 0.5)
            self.assertGreater(share(picture, left, 0.02, left + 0.3, 0.27, red), 0.01)
            self.assertGreater(share(picture, left, 0.02, left + 0.3, 0.27, black), 0.001)  # the true boxes


@unittest.skipIf(imread is None, "matplotlib is not installed")
class Refused(unittest.TestCase):
    def test_before_anything_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out"
            for arguments, why in (
                    (["--only", "4"], "--only 4: give 3, 5, 6, 7 or 8"),
                    (["--only", "3,x"], "--only x: give 3, 5, 6, 7 or 8"),
                    (["--seed", "-1"], "--seed -1: give a number from 0"),
                    (["--world", "moon"], "moon"),
                    (["--only", "6", "--goal", "there"], "X,Y or X,Y,HEADING or ball"),
                    (["--recording", "none.mcap", "--mcu", "native"], "--mcu is set by the recording"),
                    (["--only", "7", "--yard", "empty"], "has no box"),
                    (["--out", "/proc/x"], "/proc/x"),
                    (["--recording", "none.mcap"], "none.mcap")):
                with self.subTest(arguments):
                    done = figures("--out", out, *arguments)
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertIn(why, done.stderr)
                    self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                    self.assertNotIn("Traceback", done.stderr)
                    self.assertFalse(out.exists())

    def test_a_failed_run_gives_the_figures_that_it_can(self):
        with tempfile.TemporaryDirectory() as folder:
            report = kaz.run_behavior("catch-ball", mcu="native", world="empty", settings={"seconds": 10},
                                      out=folder + "/run")
            self.assertFalse(report["success"])
            out = pathlib.Path(folder) / "out"
            done = figures("--recording", folder + "/run", "--out", out)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("figure 3: no picture of the run has the ball", done.stderr)
            self.assertEqual(set(json.loads((out / "result.json").read_text())["not_drawn"]), {"3"})
            self.assertTrue((out / "figure5.png").exists() and (out / "figure8.png").exists())
            self.assertIn("Figure 3 is missing", (out / "figures.html").read_text())


if __name__ == "__main__":
    unittest.main()
