# Recordings (MCAP) as numpy arrays and dicts, decoded by the schemas of their channels.
# SPDX-License-Identifier: Apache-2.0
"""Recording("recording.mcap"): reads recordings of `kaz run --out` and Simulation(recording=...)."""

import json
import os
import re
import struct

import numpy

from ._kaz import McapRecording, UsageError, schemas

_NUMBERS = {"bool": "?", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4",
            "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4", "float64": "f8"}
_FIELD = re.compile(r"^\s*([A-Za-z0-9_/]+)(\[\d*\])?\s+([A-Za-z0-9_]+)\s*(=.*)?$")


class _Schema:
    """A ROS 1 message definition. A message contains the fields in order, little-endian, without padding."""

    def __init__(self, text):
        parts = re.split(r"^=+$", text, flags=re.M)
        self.types = {"": self._fields(parts[0])}
        for part in parts[1:]:
            name, _, fields = part.strip().partition("\n")
            self.types[name.removeprefix("MSG:").strip()] = self._fields(fields)

    @staticmethod
    def _fields(text):
        fields = []
        for line in text.split("\n"):
            found = _FIELD.match(line.split("#")[0].rstrip())
            if found and not found.group(4):
                kind, array, name = found.group(1, 2, 3)
                fields.append((name, kind, None if array is None else array[1:-1]))
        return fields

    def _type(self, kind):
        if kind in self.types:
            return self.types[kind]
        for name, fields in self.types.items():  # "Header" is std_msgs/Header
            if name.rpartition("/")[2] == kind:
                return fields
        raise UsageError(f"the schema does not define {kind}")

    def dtype(self, kind=""):
        """Returns the numpy type of a fixed-size message; None if the message has strings or lists."""
        columns = []
        for name, of, array in self._type(kind):
            if array == "" or of == "string":
                return None
            if of in ("time", "duration"):
                inner = numpy.dtype([("secs", "<u4"), ("nsecs", "<u4")])
            else:
                inner = "<" + _NUMBERS[of] if of in _NUMBERS else self.dtype(of)
            if inner is None:
                return None
            columns.append((name, inner) if array is None else (name, inner, (int(array),)))
        return numpy.dtype(columns)

    def decode(self, data):
        value, at = self._decode("", memoryview(data), 0)
        if at != len(data):
            raise UsageError(f"a message has {len(data)} bytes, but its schema describes {at} bytes")
        return value

    def _decode(self, kind, data, at):
        made = {}
        for name, of, array in self._type(kind):
            if array is None:
                made[name], at = self._one(of, data, at)
                continue
            if array == "":
                (count,), at = struct.unpack_from("<I", data, at), at + 4
            else:
                count = int(array)
            if of in _NUMBERS:
                made[name] = numpy.frombuffer(data, "<" + _NUMBERS[of], count, at).copy()
                at += made[name].nbytes
            else:
                values = []
                for _ in range(count):
                    value, at = self._one(of, data, at)
                    values.append(value)
                made[name] = values
        return made, at

    def _one(self, kind, data, at):
        if kind in _NUMBERS:
            size = numpy.dtype(_NUMBERS[kind]).itemsize
            return numpy.frombuffer(data, "<" + _NUMBERS[kind], 1, at)[0].item(), at + size
        if kind == "string":
            (size,) = struct.unpack_from("<I", data, at)
            return bytes(data[at + 4:at + 4 + size]).decode("utf-8", "replace"), at + 4 + size
        if kind in ("time", "duration"):
            secs, nsecs = struct.unpack_from("<II", data, at)
            return secs + 1e-9 * nsecs, at + 8
        return self._decode(kind, data, at)


class Recording:
    """A recording in memory.

    topics: the number of messages for each topic. facts: the version, world, seed and other facts of the run.
    duration_s: the duration of the recording. whole: False if the file is incomplete.
    """

    def __init__(self, path):
        self._file = McapRecording(os.fspath(path))
        self._schemas = schemas()
        self.topics = dict(self._file.topics)
        self.facts = dict(self._file.facts)
        self.duration_s = self._file.duration_s
        self.whole = self._file.whole

    def _schema(self, topic):
        if topic not in self.topics:
            known = ", ".join(sorted(self.topics))
            raise UsageError(f"this recording has no topic '{topic}': give one of {known}")
        known = re.sub(r"^/wire/\d+/", "/wire/", topic)  # of a second board
        if known not in self._schemas:
            raise UsageError(f"topic '{topic}' is unknown in this version of Kaz")
        return self._schemas[known]

    def messages(self, topic):
        """Returns the messages of a topic, as pairs of time (s) and message (a dict)."""
        encoding, _, text = self._schema(topic)
        if encoding == "json":
            return [(1e-9 * time, json.loads(data)) for time, data in self._file.messages(topic)]
        schema = _Schema(text)
        return [(1e-9 * time, schema.decode(data)) for time, data in self._file.messages(topic)]

    def array(self, topic):
        """Returns all messages of a topic as a structured array, whose first column is `time` (s). All
        messages must have the same size.

        array("/truth/joints")["angle"] has a row for each message and a column for each joint."""
        encoding, name, text = self._schema(topic)
        dtype = None if encoding == "json" else _Schema(text).dtype()
        if dtype is None:
            raise UsageError(f"array: the messages of '{topic}' ({name}) have no fixed size; use messages()")
        times, data = self._file.joined(topic)
        if len(data) != len(times) * dtype.itemsize:
            raise UsageError(
                f"array: the size of the messages of '{topic}' differs from the size of {name} in this "
                "version of Kaz")
        table = numpy.frombuffer(data, dtype)
        made = numpy.empty(len(times), [("time", "<f8")] + [(n, dtype.fields[n][0]) for n in dtype.names])
        made["time"] = 1e-9 * times
        for column in dtype.names:
            made[column] = table[column]
        return made
