# The package kaz: MCAP files of other programs, also hostile ones.
# SPDX-License-Identifier: Apache-2.0
import json
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

import numpy

import kaz

IN_2024 = 1_700_000_000_000_000_000  # ns


def text(value):
    value = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(value)) + value


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def schema(number, body, encoding="ros1msg"):
    return record(3, struct.pack("<H", number) + text(f"Type{number}") + text(encoding) + text(body))


def channel(number, topic, of_schema, encoding="ros1"):
    return record(4, struct.pack("<HH", number, of_schema) + text(topic) + text(encoding) + text(""))


def message(of_channel, time_ns, data):
    return record(5, struct.pack("<HIQQ", of_channel, 0, time_ns, time_ns) + data)


def chunk(compression, data, size):
    return record(6, struct.pack("<QQQI", 0, 2**64 - 1, size, 0) + text(compression) +
                  struct.pack("<Q", len(data)) + data)


class RecordingsOfOthers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name, "a.mcap")

    def read(self, *records):
        self.path.write_bytes(b"\x89MCAP0\r\n" + record(1, text("") + text("another program")) +
                              b"".join(records) + record(15, bytes(4)))
        return kaz.Recording(self.path)

    def read_one(self, body, *data):
        """A file of messages with this ROS 1 schema."""
        return self.read(schema(1, body), channel(1, "/x", 1), *(message(1, 1, one) for one in data))

    def refusal(self, call):
        with self.assertRaises(kaz.UsageError) as raised:
            call()
        self.assertIn("'/x'", str(raised.exception))
        return str(raised.exception)

    def test_messages_are_decoded_by_the_schema_in_the_file(self):
        body = ("Header header\nbyte[2] pair\nduration wait\nint8 LIMIT=3\nPoint[] points\n" + "=" * 80 +
                "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" + "=" * 80 +
                "\nMSG: geometry_msgs/Point\nfloat64 x\n")
        data = (struct.pack("<III", 7, 5, 500_000_000) + text("base") + b"\1\xff" +
                struct.pack("<iiId", -2, 0, 1, 0.5))
        recording = self.read(schema(1, body), channel(1, "/x", 1), message(1, IN_2024, data),
                              message(1, IN_2024 + 1_500_000_000, data))
        self.assertEqual(recording.topics, {"/x": 2})
        self.assertAlmostEqual(recording.duration_s, 1.5)
        (time, made), _ = recording.messages("/x")
        self.assertEqual(time, 1.7e9)
        self.assertEqual(made["header"], {"seq": 7, "stamp": 5.5, "frame_id": "base"})
        self.assertEqual((list(made["pair"]), made["wait"], made["points"]), ([1, -1], -2, [{"x": 0.5}]))
        self.assertEqual(recording.raw("/x")[1], (IN_2024 + 1_500_000_000, data))

    def test_compressed_chunks_of_other_programs(self):
        inside = schema(1, "float64 x") + channel(1, "/x", 1)
        inside += b"".join(message(1, IN_2024 + k, struct.pack("<d", k)) for k in range(1000))
        for compression in ("lz4", "zstd"):
            if not shutil.which(compression):
                continue
            with self.subTest(compression):
                data = subprocess.run([compression, "-c"], input=inside, stdout=subprocess.PIPE,
                                      stderr=subprocess.DEVNULL, check=True).stdout
                self.assertLess(len(data), len(inside))
                table = self.read(chunk(compression, data, len(inside))).array("/x")
                numpy.testing.assert_array_equal(table["x"], numpy.arange(1000))

    def test_other_encodings_are_raw(self):
        recording = self.read(
            schema(1, "float64 x", "ros2msg"), channel(1, "/x", 1, "cdr"), message(1, 5, b"abc"),
            channel(2, "/json", 0, "json"), message(2, 6, json.dumps({"a": [1]}).encode()),
            schema(2, b"\xff\0binary", "protobuf"), channel(3, "/binary", 2, "protobuf"))
        self.assertEqual(recording.raw("/x"), [(5, b"abc")])
        self.assertEqual(recording.messages("/json"), [(1e-9 * 6, {"a": [1]})])
        self.assertEqual(recording.raw("/binary"), [])
        for call in (recording.messages, recording.array):
            said = self.refusal(lambda: call("/x"))
            self.assertIn("'cdr' with a schema in 'ros2msg'", said)
            self.assertIn("use raw()", said)

    def test_channels_of_a_topic_may_differ(self):
        recording = self.read(
            schema(1, "int8 a"), schema(2, "int16 a"), channel(1, "/x", 1), channel(2, "/x", 2),
            message(1, 5, b"a"), message(2, 6, b"ab"))
        self.assertEqual(recording.topics, {"/x": 2})
        self.assertEqual(recording.raw("/x"), [(5, b"a"), (6, b"ab")])
        self.assertIn("2 different schemas", self.refusal(lambda: recording.messages("/x")))

    def test_hostile_schemas_and_messages(self):
        part = "\n===\nMSG: a/"
        doubled = "T0 t" + "".join(f"{part}T{k}\nT{k + 1} a\nT{k + 1} b" for k in range(60)) + part + "T60\n"
        for body, data in (
                ("T t" + part + "T\nT t", b""), ("T[] t" + part + "T\nT[] t", struct.pack("<I", 1) * 9000),
                (doubled, b""), (doubled + "int8 a", b"a"), ("T[] t" + part + "T\n", b"\xff" * 4),
                ("T[4294967295] t" + part + "T\nint8 a", b""), ("int8[" + "9" * 30 + "] a", b""),
                ("int8[" + "9" * 9000 + "] a", b""), ("float64[] a", b"\xff" * 8), ("string a", b"\xff" * 8),
                ("string[] a", b"\xff" * 8), ("Unknown a", b""), ("int8 a", b""), ("int8 a", b"ab"),
                ("int8[] a", b"ab")):
            with self.subTest(body[:40]):
                recording = self.read_one(body, data)
                self.assertEqual(recording.raw("/x"), [(1, data)])
                self.refusal(lambda: recording.messages("/x"))
                with self.assertRaises(kaz.UsageError):
                    recording.array("/x")
        for data in (b"", b"{", b"\xff", b"[" * 100_000):
            recording = self.read(channel(1, "/x", 0, "json"), message(1, 1, data))
            self.refusal(lambda: recording.messages("/x"))

    def test_columns_of_a_table_have_one_name_each(self):
        for body in ("int8 time", "int8 a\nint8 a"):
            recording = self.read_one(body, b"a" * (body.count("int8")))
            self.refusal(lambda: recording.array("/x"))

    def test_texts_that_are_not_utf_8(self):
        with self.assertRaisesRegex(kaz.UsageError, "must be UTF-8"):
            self.read(channel(1, b"/\xff", 0))
        broken = record(3, struct.pack("<H", 1) + text(b"\xff") * 3)
        recording = self.read(broken, channel(1, "/x", 1, b"\xff"))
        self.assertIn("use raw()", self.refusal(lambda: recording.messages("/x")))


if __name__ == "__main__":
    unittest.main()
