# The package kaz: None in place of any argument is a TypeError, and never the end of the interpreter.
# SPDX-License-Identifier: Apache-2.0
import inspect
import pathlib
import tempfile
import unittest

import numpy

import kaz
from kaz import _kaz

PICTURE = numpy.zeros((240, 320, 3), numpy.uint8)
CAMERA = kaz.CameraModel(320, 240, 250.0, 250.0, 160.0, 120.0, 0.06)
# Where None has a meaning.
OPTIONAL = {("Robot.enable", 0), ("Robot.joints", 0), ("Robot.set_gains", 0), ("Robot.set_limits", 0)}


class Nothing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        recording = str(pathlib.Path(cls.folder.name, "run.mcap"))
        sim = kaz.Simulation(world="ball", mcu="native", suspended=True, recording=recording)
        robot = kaz.Robot(sim)
        robot.enable()
        state = sim.save()
        sim.pairs()
        robot.sleep(0.2)
        pair = sim.pairs()[0]
        sim.finish_recording()
        batch = _kaz.Batch(robots=1, engine="none")
        batch.reset([1])
        cls.objects = {
            "Simulation": sim, "Robot": robot, "Batch": batch, "CameraModel": CAMERA, "Pair": pair,
            "Posture": robot.state(), "BallDetector": _kaz.BallDetector(), "DepthFinder": _kaz.DepthFinder(),
            "FlowFinder": _kaz.FlowFinder(), "PlaneFinder": _kaz.PlaneFinder(),
            "McapRecording": _kaz.McapRecording(recording)}
        # Arguments with which the call is right, each of which becomes None.
        cls.calls = {
            "Simulation": {
                "step": [0.001], "link_pose": ["trunk"], "object_position": ["ball"],
                "push": ["trunk", [0, 0, 0]], "picture": [[1, 0, 1], [0, 0, 0], 16, 16, 0.9],
                "add_fault": ["for 0.1 s link_drop 1"], "restore": [state], "write": [b"x"], "read": [1],
                "start_recording": [recording]},
            "Robot": {
                "enable": [[0]], "set_targets": [{0: 0.0}, 0.1], "exchange": [{0: 0.0}, 0.1], "joints": [[0]],
                "set_gains": [[0]], "set_limits": [[0]], "sleep": [0.001], "__exit__": []},
            "Batch": {
                "reset": [[1]], "step": [numpy.zeros((1, 18)), numpy.zeros(1, numpy.uint8)],
                "push": [0, "trunk", [0, 0, 0]], "accelerate": [0, "ball", [0, 0, 0]],
                "link_pose": [0, "trunk"]},
            "BallDetector": {"find": [PICTURE, CAMERA]},
            "DepthFinder": {"find": [PICTURE, PICTURE, CAMERA]},
            "FlowFinder": {"find": [PICTURE, PICTURE, CAMERA]},
            "PlaneFinder": {"find": [numpy.zeros((240, 320), numpy.float32), CAMERA]},
            "McapRecording": {"schemas": ["/tf"], "messages": ["/tf"], "joined": ["/tf"]}}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def check(self, what, call, arguments):
        for place in range(len(arguments)):
            if (what, place) in OPTIONAL:
                continue
            with self.subTest(what, place=place), self.assertRaises(TypeError):
                call(*arguments[:place], None, *arguments[place + 1:])

    def test_members(self):
        for name, made in inspect.getmembers(_kaz, inspect.isclass):
            if issubclass(made, Exception):
                continue
            for member, of in inspect.getmembers(made):
                if member.startswith("_") and member not in ("__enter__", "__exit__"):
                    continue
                what = f"{name}.{member}"
                with self.subTest(what, place="self"), self.assertRaises(TypeError):
                    (of.fget if isinstance(of, property) else of)(None)
                if isinstance(of, property) or name not in self.objects:
                    continue
                arguments = self.calls.get(name, {}).get(member, [])
                self.check(what, getattr(self.objects[name], member), arguments)
                # A call that takes more than the table has is new: it is to be entered there.
                takes = of.__doc__.split(" -> ")[0].count(": ") - 1
                if member not in ("__exit__", "set_gains", "set_limits"):
                    self.assertEqual(takes, len(arguments), f"{what}: {of.__doc__}")

    def test_constructors(self):
        for what, arguments in {
                "Robot": [None], "Camera": ["nowhere", ""],
                "CameraModel": [320, 240, 1.0, 1.0, 1.0, 1.0, 0.1],
                "BallDetector": [0.03, 0.5], "DepthFinder": [0.1, 9], "PlaneFinder": [1],
                "McapRecording": ["nowhere"]}.items():
            self.check(what, getattr(_kaz, what), arguments)
        for what, names in {
                "Simulation": ("world", "mcu", "seed", "eyes", "suspended", "imu", "faults", "recording"),
                "Batch": ("robots", "threads", "engine", "posture", "world", "pictures", "kp"),
                "Robot": ("simulation", "port")}.items():
            for name in names:
                with self.subTest(what, argument=name), self.assertRaises(TypeError):
                    getattr(_kaz, what)(**{name: None})
        for name in ("watchdog", "when_lost"):
            with self.subTest("Robot", argument=name), self.assertRaises(TypeError):
                kaz.Robot(self.objects["Simulation"], **{name: None})

    def test_functions(self):
        with self.assertRaises(TypeError):
            kaz.run_behavior(None)
        for name in ("world", "settings", "out", "robot", "camera", "address"):
            with self.subTest(argument=name), self.assertRaises(TypeError):
                kaz.run_behavior("stand", mcu="native", **{name: None})

    def test_in_python(self):
        recording = kaz.Recording(pathlib.Path(self.folder.name, "run.mcap"))
        for what, call in {
                "Recording": lambda: kaz.Recording(None), "VectorEnv": lambda: kaz.VectorEnv(None),
                "Env": lambda: kaz.Env(None), "num_envs": lambda: kaz.VectorEnv("stand", num_envs=None),
                "engine": lambda: kaz.Env("stand", engine=None),
                "depth_of": lambda: kaz.vision.depth_of(None, CAMERA)}.items():
            with self.subTest(what), self.assertRaises(TypeError):
                call()
        for call in (recording.array, recording.messages, recording.raw):
            with self.assertRaises(kaz.UsageError):
                call(None)


if __name__ == "__main__":
    unittest.main()
