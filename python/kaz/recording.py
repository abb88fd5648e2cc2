# Recordings (MCAP) as numpy arrays and dicts, decoded by the schemas of their channels.
# SPDX-License-Identifier: Apache-2.0
"""Recording("recording.mcap"): reads recordings of `kaz run --out` and Simulation(recording=...), and MCAP
files of other programs."""

import json
import os
import re
import struct

import numpy

from ._kaz import McapRecording, UsageError

_NUMBERS = {"bool": "?", "byte": "i1", "char": "u1", "int8": "i1", "uint8": "u1", "int16": "i2",
            "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4",
            "float64": "f8"}
_FIELD = re.compile(r"^\s*([A-Za-z0-9_/]+)(\[\d*\])?\s+([A-Za-z0-9_]+)\s*(=.*)?$")


# Errors of messages that do not match their schema, and of schemas without sense. Both come from the file.
_MISMATCH: tuple[type[Exception], ...] = (
    ArithmeticError, MemoryError, RecursionError, TypeError, ValueError, struct.error)


class _Schema:
    """A ROS 1 message definition. A message contains the fields in order, little-endian, without padding."""

    def __init__(self, text):
        parts = re.split(r"^=+$", text, flags=re.M)
        self.types = {"": self._fields(parts[0])}
        self.dtypes = {}
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
        if kind not in self.dtypes:
            self.dtypes[kind] = self._dtype(kind)
        return self.dtypes[kind]

    def _dtype(self, kind):
        columns = []
        for name, of, array in self._type(kind):
            if array == "" or of == "string":
                return None
            if of in ("time", "duration"):
                number = "<u4" if of == "time" else "<i4"
                inner = numpy.dtype([("secs", number), ("nsecs", number)])
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
            secs, nsecs = struct.unpack_from("<II" if kind == "time" else "<ii", data, at)
            return secs + 1e-9 * nsecs, at + 8
        made, end = self._decode(kind, data, at)
        if end == at:  # a few bytes could stand for any number of these
            raise UsageError(f"{kind} has no bytes")
        return made, end


class Recording:
    """A recording in memory.

    topics: the number of messages for each topic. facts: the version, world, seed and other facts of the run.
    duration_s: the duration of the recording. whole: False if the file is incomplete.

    Times are those of the file: in recordings of Kaz since the start, in files of ROS since 1970.
    """

    def __init__(self, path):
        self._file = McapRecording(os.fspath(path))
        try:
            self.topics = dict(self._file.topics)
            self.facts = dict(self._file.facts)
        except UnicodeDecodeError as error:
            raise UsageError(f"{path}: a topic or metadata entry must be UTF-8 ({error}); give a valid file")
        self.duration_s = self._file.duration_s
        self.whole = self._file.whole

    def _known(self, topic):
        if topic not in self.topics:
            known = ", ".join(sorted(self.topics))
            raise UsageError(f"this recording has no topic '{topic}': give one of {known}")

    def _schema(self, topic):
        """Returns name and _Schema of the topic's messages. JSON has no _Schema."""
        self._known(topic)
        found = self._file.schemas(topic)
        if len(found) > 1:
            raise UsageError(f"the messages of '{topic}' have {len(found)} different schemas; use raw()")
        message, name, encoding, text = (value.decode("utf-8", "replace") for value in found[0])
        if message == "json":
            return name, None
        if (message, encoding) != ("ros1", "ros1msg"):
            raise UsageError(f"the messages of '{topic}' have the encoding '{message}' with a schema in "
                             f"'{encoding}': must be json, or ros1 with ros1msg; use raw()")
        return name, _Schema(text)

    def raw(self, topic):
        """Returns the messages of a topic, as pairs of time (ns) and bytes, for any encoding."""
        self._known(topic)
        return self._file.messages(topic)

    def messages(self, topic):
        """Returns the messages of a topic, as pairs of time (s) and message (a dict)."""
        name, schema = self._schema(topic)
        decode = json.loads if schema is None else schema.decode
        try:
            return [(1e-9 * time, decode(data)) for time, data in self._file.messages(topic)]
        except _MISMATCH as error:
            raise UsageError(f"a message of '{topic}' does not fit its schema {name} ({error}); use raw()")

    def array(self, topic):
        """Returns all messages of a topic as a structured array, whose first column is `time` (s). All
        messages must have the same size.

        array("/truth/joints")["angle"] has a row for each message and a column for each joint."""
        name, schema = self._schema(topic)
        try:
            return self._table(topic, name, schema and schema.dtype())
        except UsageError:
            raise
        except _MISMATCH as error:
            raise UsageError(f"array: the schema {name} of '{topic}' is invalid ({error}); use raw()")

    def _table(self, topic, name, dtype):
        if dtype is None:
            raise UsageError(f"array: the messages of '{topic}' ({name}) have no fixed size; use messages()")
        times, data = self._file.joined(topic)
        if len(data) != len(times) * dtype.itemsize:
            raise UsageError(
                f"array: the size of the messages of '{topic}' differs from the size of {name}; use raw()")
        table = numpy.frombuffer(data, dtype)
        made = numpy.empty(len(times), [("time", "<f8")] + [(n, dtype.fields[n][0]) for n in dtype.names])
        made["time"] = 1e-9 * times
        for column in dtype.names:
            made[column] = table[column]
        return made
