# The package kaz: a robot is simulated, driven, saved, recorded, and looked at.
# SPDX-License-Identifier: Apache-2.0
import gc
import hashlib
import pathlib
import signal
import tempfile
import threading
import time
import unittest

import numpy

import kaz


def crouched(sim):
    """A robot that stands: motors on, where it was."""
    robot = kaz.Robot(sim)
    robot.enable()
    return robot


class Simulation(unittest.TestCase):
    def test_a_joint_goes_where_it_is_sent_on_chip_and_native(self):
        for mcu in ("h8", "native"):
            with self.subTest(mcu=mcu):
                sim = kaz.Simulation(world="empty", mcu=mcu, suspended=True)
                self.assertEqual(sim.time, 0)
                with kaz.Robot(sim) as robot:
                    robot.enable(["neck_pan"])
                    robot.set_targets({"neck_pan": 0.4}, duration=0.5)
                    robot.sleep(1.2)
                    measured = robot.state()
                    pan = kaz.JOINTS.index("neck_pan")
                    self.assertAlmostEqual(measured.angle[pan], 0.4, delta=0.03)
                    self.assertAlmostEqual(sim.joints()["angle"][pan], 0.4, delta=0.03)
                    self.assertTrue(sim.motors_enabled)
                self.assertFalse(sim.motors_enabled, "the end of `with` switches the motors off")

    def test_what_is_measured_is_close_to_the_truth_and_not_equal(self):
        sim = kaz.Simulation(world="empty")
        robot = crouched(sim)
        robot.sleep(0.3)
        error = robot.state().angle - sim.joints()["angle"]
        self.assertLess(numpy.abs(error).max(), 0.05)
        self.assertGreater(numpy.abs(error).max(), 0)

    def test_the_same_seed_gives_the_same_bytes(self):
        digests = []
        for seed in (1, 1, 2):
            with tempfile.TemporaryDirectory() as folder:
                sim = kaz.Simulation(world="ball", seed=seed, recording=f"{folder}/run.mcap")
                robot = crouched(sim)
                robot.sleep(0.3)
                digest = sim.finish_recording()
                content = pathlib.Path(folder, "run.mcap").read_bytes()
                self.assertEqual(digest, hashlib.sha256(content).hexdigest())
                digests.append(digest)
        self.assertEqual(digests[0], digests[1])
        self.assertNotEqual(digests[0], digests[2])

    def test_a_restored_state_goes_on_the_same(self):
        sim = kaz.Simulation(world="ball", mcu="h8")
        robot = crouched(sim)
        state, at = sim.save(), sim.time
        sim.push("trunk", [0.05, 0, 0])
        sim.step(0.4)
        first = sim.joints()["angle"]
        sim.restore(state)
        self.assertEqual(sim.time, at)
        sim.push("trunk", [0.05, 0, 0])
        sim.step(0.4)
        self.assertTrue(numpy.array_equal(first, sim.joints()["angle"]))
        sim.restore(state)
        sim.step(0.4)
        self.assertFalse(numpy.array_equal(first, sim.joints()["angle"]), "without the push")
        del robot

    def test_the_feet_carry_the_weight(self):
        sim = kaz.Simulation(world="empty")
        robot = crouched(sim)
        robot.sleep(1)
        up = sum(contact["force"][2] if contact["a"].find("::") < 0 else -contact["force"][2]
                 for contact in sim.contacts())
        self.assertAlmostEqual(abs(up), 1.6 * 9.81, delta=2)
        self.assertGreater(sim.link_pose("trunk")[2, 3], 0.1)

    def test_a_fault_begins_now_and_the_board_reacts(self):
        sim = kaz.Simulation(world="empty", suspended=True)
        robot = crouched(sim)
        sim.add_fault("for 8 s link_drop 1")
        with self.assertRaises(kaz.EnvironmentFault) as raised:
            robot.state()
        self.assertGreater(sim.time, 2, "the board is sought for three seconds")
        self.assertTrue(str(raised.exception))

    def test_wrong_values_are_sentences(self):
        for make, part in ((lambda: kaz.Simulation(world="wing"), "no world `wing`"),
                           (lambda: kaz.Simulation(mcu="h9"), "mcu 'h9': give one of h8, native"),
                           (lambda: kaz.Simulation(supply_volts=200), "supply_volts: must be 1 to 20 V"),
                           (lambda: kaz.Simulation(world="empty").step(-1), "must be 0.001 to"),
                           (lambda: kaz.Simulation(world="empty").link_pose("wing"), "link 'wing': must be"),
                           (lambda: kaz.Simulation(world="empty").restore(b"nothing"), "")):
            with self.assertRaises(kaz.UsageError) as raised:
                make()
            self.assertIn(part, str(raised.exception))
        with self.assertRaises(TypeError) as raised:
            kaz.Simulation(word="ball")
        self.assertIn("'word'", str(raised.exception))

    def test_no_step_holds_the_lock_of_the_interpreter(self):
        sim = kaz.Simulation(world="ball", mcu="h8")
        counted, done = 0, threading.Event()

        def run():
            sim.step(2)
            done.set()
        thread = threading.Thread(target=run)
        thread.start()
        while not done.is_set():
            counted += 1
            time.sleep(0.001)
        thread.join()
        self.assertGreater(counted, 10)

    def test_ctrl_c_ends_a_long_step(self):
        sim = kaz.Simulation(world="empty", mcu="h8")
        threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            sim.step(10_000)
        sim.step()  # and it can be used


class Eyes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sim = kaz.Simulation(world="ball", mcu="native")
        cls.robot = crouched(cls.sim)
        cls.robot.set_targets({"neck_pan": 0.8, "neck_tilt": 0.2}, duration=0.3)
        cls.robot.sleep(0.5)
        cls.sim.pairs()
        cls.robot.sleep(0.3)
        cls.pairs = cls.sim.pairs()

    def test_pairs_come_at_thirty_a_second(self):
        self.assertIn(len(self.pairs), range(6, 11))
        first, last = self.pairs[0], self.pairs[-1]
        self.assertEqual(first.left.shape, (240, 320, 3))
        self.assertGreater(last.time, first.time)
        self.assertEqual(last.camera.width, 320)
        self.assertFalse(numpy.array_equal(last.left, last.right))

    def test_pictures_are_not_copied_and_outlive_the_pair(self):
        pair = self.sim and self.pairs[-1]
        picture = pair.left
        self.assertEqual(picture.__array_interface__["data"][0], pair.left.__array_interface__["data"][0])
        self.assertFalse(picture.flags.writeable)
        digest = hashlib.sha256(picture.tobytes()).digest()
        self.pairs.pop()
        del pair
        gc.collect()
        self.assertEqual(hashlib.sha256(picture.tobytes()).digest(), digest)

    def test_depth_agrees_with_the_ball(self):
        pair = self.pairs[0]
        ball = kaz.vision.BallDetector().find(pair.left, pair.camera)
        self.assertIsNotNone(ball)
        truth = self.sim.object_position("ball")
        eye = self.sim.link_pose("left_eye")
        self.assertAlmostEqual(ball["distance_m"], numpy.linalg.norm(truth - eye[:3, 3]), delta=0.03)
        disparity = kaz.vision.DepthFinder().find(pair.left, pair.right, pair.camera)
        self.assertEqual(disparity.shape, (240, 320))
        depth = kaz.vision.depth_of(disparity, pair.camera)
        self.assertGreater(numpy.isfinite(depth).mean(), 0.2)
        segments, label = kaz.vision.PlaneFinder().find(disparity, pair.camera)
        self.assertEqual(label.shape, (240, 320))
        self.assertGreaterEqual(len(segments), 1)

    def test_flow_of_a_shifted_picture_is_the_shift(self):
        pair = self.pairs[0]
        shifted = numpy.roll(pair.left, 3, axis=1)
        flow = kaz.vision.FlowFinder().find(pair.left, shifted, pair.camera)
        known = numpy.isfinite(flow[:, 20:-20, 0])
        self.assertGreater(known.mean(), 0.05)
        self.assertAlmostEqual(float(numpy.median(flow[:, 20:-20, 0][known])), 3, delta=0.3)

    def test_an_onlookers_picture(self):
        picture = self.sim.picture([0.8, -0.6, 0.5], [0, 0, 0.2], width=160, height=120)
        self.assertEqual(picture.shape, (120, 160, 3))
        self.assertGreater(picture.std(), 5)

    def test_what_is_no_picture_is_refused(self):
        camera = self.pairs[0].camera
        with self.assertRaises(kaz.UsageError):
            kaz.vision.BallDetector().find(numpy.zeros((10, 10), numpy.uint8), camera)
        with self.assertRaises(kaz.UsageError):
            kaz.vision.DepthFinder().find(self.pairs[0].left, self.pairs[0].left[:100], camera)


class Robot(unittest.TestCase):
    def test_joints_by_name_or_number_and_refusals(self):
        sim = kaz.Simulation(world="empty", mcu="native", suspended=True)
        with kaz.Robot(sim) as robot:
            with self.assertRaises(kaz.RobotError) as raised:
                robot.set_targets({0: 0.1})
            self.assertIn("neck_pan", str(raised.exception))
            robot.enable([0, "neck_tilt"])
            robot.set_targets({0: 0.1, "neck_tilt": 0.2}, duration=0.2)
            robot.sleep(0.8)
            details = robot.joints(["neck_tilt"])
            self.assertEqual(details["name"], ["neck_tilt"])
            self.assertAlmostEqual(details["angle"][0], 0.2, delta=0.04)
            for wrong in ({"wing": 0.1}, {18: 0.1}, [0.0] * 5, {0: float("nan")}):
                with self.assertRaises(kaz.UsageError):
                    robot.set_targets(wrong)
            self.assertEqual(robot.health()["shutdown"], "")
            posture = robot.exchange({0: 0.0}, duration=0.1)
            self.assertEqual(posture.angle.shape, (18,))
        with self.assertRaises(kaz.UsageError):
            robot.state()

    def test_a_port_that_is_not_there(self):
        with self.assertRaises(kaz.EnvironmentFault):
            kaz.Robot("serial:/nowhere/tty")
        with self.assertRaises(kaz.UsageError):
            kaz.Robot("sim")

    def test_the_robot_keeps_its_simulation(self):
        robot = kaz.Robot(kaz.Simulation(world="empty", mcu="native"))
        gc.collect()
        robot.sleep(0.1)
        self.assertGreater(robot.time, 0.09)


if __name__ == "__main__":
    unittest.main()
