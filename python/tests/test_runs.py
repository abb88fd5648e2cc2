# The package kaz: behaviors run to their end, and their recordings are read.
# SPDX-License-Identifier: Apache-2.0
import json
import pathlib
import tempfile
import unittest

import numpy

import kaz


class Behavior(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = cls.folder.name + "/run"
        cls.report = kaz.run_behavior("search-ball", world="ball", mcu="native", out=cls.out)
        cls.recording = kaz.Recording(cls.out + "/recording.mcap")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_its_report_is_that_of_the_folder(self):
        self.assertTrue(self.report["success"], self.report)
        result = json.loads(pathlib.Path(self.out, "result.json").read_text())
        self.assertEqual(result["outcome"], "done")
        self.assertIn("ball", self.report["sentence"])

    def test_joints_are_a_table(self):
        joints = self.recording.array("/truth/joints")
        self.assertEqual(joints["angle"].shape, (len(joints), len(kaz.JOINTS)))
        self.assertEqual(len(joints), self.recording.topics["/truth/joints"])
        numpy.testing.assert_allclose(numpy.diff(joints["time"]), 0.001, atol=1e-6)
        self.assertGreater(numpy.ptp(joints["angle"][:, 0]), 0.01)  # the head turned

    def test_messages_with_lists_are_dicts(self):
        time, contacts = self.recording.messages("/truth/contacts")[-1]
        self.assertGreater(time, 0)
        self.assertEqual(set(contacts["contacts"][0]), {"a", "b", "at", "force"})
        _, poses = self.recording.messages("/tf")[-1]
        names = [pose["child_frame_id"] for pose in poses["transforms"]]
        self.assertIn("trunk", names)
        self.assertIn("ball/ball", names)
        for topic in self.recording.topics:  # each has a schema by which it can be decoded whole
            if self.recording.topics[topic]:
                self.recording.messages(topic)

    def test_the_bytes_of_the_line_are_there(self):
        total = sum(len(message["value"]) for _, message in self.recording.messages("/wire/to_board"))
        self.assertGreater(total, 100)

    def test_wrong_questions_are_sentences(self):
        with self.assertRaises(kaz.UsageError) as raised:
            self.recording.array("/truth/contacts")
        self.assertIn("use messages()", str(raised.exception))
        with self.assertRaises(kaz.UsageError) as raised:
            self.recording.messages("/wings")
        self.assertIn("/truth/joints", str(raised.exception))
        with self.assertRaises(kaz.UsageError):
            kaz.Recording(__file__)
        with self.assertRaises(kaz.UsageError):
            kaz.run_behavior("fly")
        with self.assertRaisesRegex(kaz.UsageError, "is a plug-in: run the plug-in with `kaz run ./kick.so`"):
            kaz.run_behavior("./kick.so")
        with self.assertRaises(kaz.UsageError):
            kaz.run_behavior("stand", settings={"seconds": "many"}, mcu="native")

    def test_a_failure_is_a_report_not_an_exception(self):
        report = kaz.run_behavior("search-ball", world="empty", mcu="native", settings={"seconds": 1})
        self.assertFalse(report["success"])
        self.assertTrue(report["sentence"])

    def test_behaviors_are_listed_with_their_options(self):
        text, options = kaz.behaviors()["catch-ball"]
        self.assertTrue(text)
        self.assertIsInstance(options, dict)


if __name__ == "__main__":
    unittest.main()
