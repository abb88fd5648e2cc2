# The package kaz: one object in several threads, and stop() from another one.
# SPDX-License-Identifier: Apache-2.0
import contextlib
import json
import os
import pathlib
import random
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest

import numpy

import kaz

HANG_S = 600  # of a busy machine
LONG = 1e5  # s of simulated time: hours of this machine's
IN_USE = "in use by another thread"


class Caller(threading.Thread):
    """Runs a call that another thread ends; `error` is what it raised. `runs`: a call on the same object."""

    def __init__(self, call, runs):
        super().__init__(daemon=True)
        self.call, self.error = call, None
        self.start()
        end = time.monotonic() + HANG_S
        while not self._raises(runs):
            assert time.monotonic() < end and self.is_alive(), f"the call does not run: {self.error!r}"

    @staticmethod
    def _raises(call):
        """Whether an object is in use: this call of it is refused."""
        try:
            call()
        except RuntimeError as error:
            return IN_USE in str(error)
        return False

    def run(self):
        while self._raises(self._call_once):  # refused by the short calls of __init__
            pass

    def _call_once(self):
        try:
            self.call()
        except RuntimeError as error:
            if IN_USE in str(error):
                raise
            self.error = error
        except BaseException as error:
            self.error = error

    def ended(self):
        self.join(60)
        assert not self.is_alive(), "the call goes on"
        return self.error


class Stop(unittest.TestCase):
    def robot(self, mcu="native", **options):
        sim = kaz.Simulation(world="empty", mcu=mcu, suspended=True)
        robot = kaz.Robot(sim, **options)
        robot.enable()
        return sim, robot

    def check_stopped(self, sim, robot, call, end):
        self.assertTrue(sim.motors_enabled)
        caller = Caller(call, lambda: sim.time)
        began = time.monotonic()
        end()
        took = time.monotonic() - began
        self.assertFalse(sim.motors_enabled, "off when stop() has returned")
        self.assertIsInstance(caller.ended(), kaz.Stopped)
        self.assertLess(took, HANG_S)
        return robot

    def test_it_ends_every_call_that_waits(self):
        for mcu in ("native", "h8"):
            for call in (lambda sim, robot: robot.sleep(LONG), lambda sim, robot: sim.step(LONG)):
                with self.subTest(mcu=mcu):
                    sim, robot = self.robot(mcu)
                    self.check_stopped(sim, robot, lambda: call(sim, robot), robot.stop)
                    robot.clear()
                    robot.enable()  # and the robot is usable
                    robot.exchange({"neck_pan": 0.1}, duration=0.1)
                    self.assertTrue(sim.motors_enabled)

    def test_a_loop_of_short_calls_ends(self):
        sim, robot = self.robot()

        def control():
            while True:
                robot.exchange({"neck_pan": 0.1}, duration=0.1)
        caller = Caller(control, lambda: sim.time)
        robot.stop()
        # Either the call that ran, or the next one: the board refuses targets.
        self.assertIsInstance(caller.ended(), kaz.RobotError)
        self.assertFalse(sim.motors_enabled)

    def test_the_stop_is_latched(self):
        sim, robot = self.robot()
        self.check_stopped(sim, robot, lambda: robot.sleep(LONG), robot.stop)
        self.assertIn("stop", robot.health()["shutdown"])
        with self.assertRaises(kaz.RobotError):
            robot.exchange({"neck_pan": 0.1}, duration=0.1)

    def test_close_ends_it_too(self):
        sim, robot = self.robot()
        self.check_stopped(sim, robot, lambda: robot.sleep(LONG), robot.close)
        with self.assertRaises(kaz.UsageError):
            robot.state()
        robot.close()

    def test_the_last_reference_goes_while_the_world_steps(self):
        sim, robot = self.robot()
        caller = Caller(lambda: sim.step(LONG), lambda: sim.time)
        del robot
        self.assertIsInstance(caller.ended(), kaz.Stopped)
        self.assertFalse(sim.motors_enabled)

    def test_many_at_once(self):
        sim, robot = self.robot()
        caller = Caller(lambda: robot.sleep(LONG), lambda: sim.time)
        errors = []

        def stop():
            try:
                robot.stop()
            except Exception as error:
                errors.append(error)
        stops = [threading.Thread(target=stop) for _ in range(8)]
        for one in stops:
            one.start()
        for one in stops:
            one.join()
        self.assertEqual(errors, [])
        self.assertIsInstance(caller.ended(), kaz.Stopped)
        self.assertFalse(sim.motors_enabled)

    def test_a_signal_handler_stops_the_call_that_it_interrupts(self):
        sim, robot = self.robot()
        before = signal.signal(signal.SIGALRM, lambda *_: robot.stop())
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.2)
            with self.assertRaises(kaz.Stopped):
                robot.sleep(LONG)
        finally:
            signal.signal(signal.SIGALRM, before)
        self.assertFalse(sim.motors_enabled)
        self.assertEqual(robot.state().angle.shape, (18,))

    def test_a_stop_that_nobody_confirms_is_an_error(self):
        sim, robot = self.robot()
        sim.add_fault("for 60 s link_drop 1")
        caller = Caller(lambda: robot.sleep(LONG), lambda: sim.time)
        with self.assertRaises(kaz.EnvironmentFault) as raised:
            robot.stop()
        self.assertIn("cut the power", str(raised.exception))
        self.assertTrue(caller.ended())


class Threads(unittest.TestCase):
    def test_a_second_call_is_refused_and_changes_nothing(self):
        sim = kaz.Simulation(world="ball", mcu="native")
        robot = kaz.Robot(sim)
        robot.enable()
        state = sim.save()
        calls = {
            "joints": sim.joints, "contacts": sim.contacts, "save": sim.save, "pairs": sim.pairs,
            "restore": lambda: sim.restore(state), "step": sim.step,
            "link_pose": lambda: sim.link_pose("trunk"), "read": sim.read,
            "write": lambda: sim.write(b"x"), "object_position": lambda: sim.object_position("ball"),
            "push": lambda: sim.push("trunk", [0, 0, 0]), "clear_faults": sim.clear_faults,
            "add_fault": lambda: sim.add_fault("for 1 s link_drop 1"),
            "picture": lambda: sim.picture([1, 0, 1], [0, 0, 0], 16, 16),
            "start_recording": lambda: sim.start_recording("nowhere.mcap"),
            "finish_recording": sim.finish_recording, "supply_volts": lambda: sim.supply_volts,
            "state": robot.state, "enable": robot.enable, "time": lambda: robot.time,
            "set_targets": lambda: robot.set_targets({0: 0.0}), "clear": robot.clear,
            "health": robot.health, "sleep": lambda: robot.sleep(0.01), "Robot": lambda: kaz.Robot(sim)}
        caller = Caller(lambda: sim.step(LONG), lambda: sim.time)
        for name, call in calls.items():
            with self.subTest(name), self.assertRaises(RuntimeError) as raised:
                call()
            self.assertIn(IN_USE, str(raised.exception))
        robot.stop()
        self.assertIsInstance(caller.ended(), kaz.Stopped)
        sim.restore(state)
        self.assertTrue(sim.motors_enabled)

    def test_a_batch_and_detectors_are_locked(self):
        env = kaz.VectorEnv("stand", num_envs=64, engine="native", threads=2)
        env.reset(seed=1)
        zeros = numpy.zeros(env.action_space.shape)
        picture = numpy.random.default_rng(1).integers(0, 255, (480, 640, 3), numpy.uint8)
        camera = kaz.CameraModel(640, 480, 500.0, 500.0, 320.0, 240.0, 0.06)
        ball, depth = kaz.vision.BallDetector(), kaz.vision.DepthFinder()
        flow = kaz.vision.FlowFinder()
        for call, other in (
                (lambda: env.step(zeros), env.batch.state),
                (lambda: ball.find(picture, camera), lambda: ball.find(picture, camera)),
                (lambda: depth.find(picture, picture, camera), lambda: depth.find(picture, picture, camera)),
                (lambda: flow.find(picture, picture, camera), lambda: flow.find(picture, picture, camera))):
            refused, done = [], threading.Event()

            def again(call=call, refused=refused, done=done):
                while not done.is_set():
                    try:
                        call()
                    except RuntimeError as error:  # by the other one's call
                        refused.append(str(error))
            thread = threading.Thread(target=again)
            thread.start()
            end = time.monotonic() + HANG_S
            while not refused and time.monotonic() < end:
                try:
                    other()
                except RuntimeError as error:
                    refused.append(str(error))
            done.set()
            thread.join()
            self.assertTrue(refused)
            self.assertIn(IN_USE, refused[0])

    def test_one_behavior_runs_at_a_time(self):
        def search(seconds):
            kaz.run_behavior("search-ball", world="empty", mcu="native", settings={"seconds": seconds})
        caller = Caller(lambda: search(30), lambda: search(0.1))
        self.assertIsNone(caller.ended())

    def test_any_calls_in_any_threads_end_in_an_exception_at_worst(self):
        sim = kaz.Simulation(world="ball", mcu="native")
        robot = kaz.Robot(sim)
        state = sim.save()
        strange = []

        def play(seed):
            dice = random.Random(seed)
            calls = [
                sim.step, sim.joints, sim.save, lambda: sim.restore(state), sim.contacts, sim.pairs,
                robot.enable, robot.state, robot.stop, lambda: robot.sleep(0.02),
                lambda: robot.exchange({0: 0.1}, duration=0.1), lambda: kaz.Robot(sim).close()]
            end = time.monotonic() + 3
            while time.monotonic() < end:
                try:
                    dice.choice(calls)()
                except (RuntimeError, kaz.EnvironmentFault):
                    pass
                except Exception as error:
                    strange.append(error)
        threads = [threading.Thread(target=play, args=(seed,)) for seed in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(strange, [])
        sim.restore(state)
        robot.close()


class Port(unittest.TestCase):
    """A robot at a pty, in real time."""

    @contextlib.contextmanager
    def board(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "log")
            with log.open("wb") as out:
                process = subprocess.Popen(
                    [os.environ["KAZ_PROGRAM"], "sim", "--serial", "board", "--world", "empty", "--suspended",
                     "--mcu", "native"], cwd=folder, stdout=out, stderr=out)
            try:
                end = time.monotonic() + HANG_S
                while b"ready: " not in log.read_bytes():
                    self.assertIsNone(process.poll(), log.read_text())
                    self.assertLess(time.monotonic(), end, log.read_text())
                    time.sleep(0.02)
                with kaz.Robot(f"serial:{folder}/board") as robot:
                    yield robot, pathlib.Path(folder, "board.ctl")
            finally:
                process.terminate()
                process.wait()

    def motors(self, control):
        """By the simulator, not by the line."""
        with contextlib.closing(socket.socket(socket.AF_UNIX)) as status:
            status.connect(str(control))
            status.sendall(b"status\n")
            return json.loads(status.makefile().readline())["motors"]

    def test_a_stop_from_another_thread(self):
        def control(robot):
            while True:
                robot.exchange({"neck_pan": 0.1}, duration=0.1)
        with self.board() as (robot, truth):
            for call in (lambda: robot.sleep(600), lambda: control(robot)):
                robot.enable()
                self.assertTrue(self.motors(truth))
                caller = Caller(call, lambda: robot.time)
                time.sleep(0.2)
                began = time.monotonic()
                robot.stop()
                took = time.monotonic() - began
                self.assertFalse(self.motors(truth))
                self.assertIsInstance(caller.ended(), kaz.RobotError)
                self.assertLess(took, 0.5)  # 20 ms, and what a busy machine adds

    def test_close_from_another_thread(self):
        with self.board() as (robot, truth):
            robot.enable()
            caller = Caller(lambda: robot.sleep(600), lambda: robot.time)
            robot.close()
            self.assertFalse(self.motors(truth))
            self.assertIsInstance(caller.ended(), kaz.Stopped)


if __name__ == "__main__":
    unittest.main()
