# The message table and the codec in Python: independent of the C code, for all generators.
# SPDX-License-Identifier: Apache-2.0
import ast
import re
from dataclasses import dataclass, field as with_default

MACRO = re.compile(r"^KZ_(MESSAGE|FIELD|BOUNDED|ARRAY|MASKED|NO_FIELDS|END)\(", re.MULTILINE)
DEFINE = re.compile(r"^#define (KZ_\w+) +(\(?-?\w+\)?)(?: *// (.*))?$", re.MULTILINE)
RANGES = {"u8": (0, 0xFF), "u16": (0, 0xFFFF), "s16": (-0x8000, 0x7FFF), "u32": (0, 0xFFFFFFFF)}
SIZES = {"u8": 1, "u16": 2, "s16": 2, "u32": 4}
JOINTS = 18
PAYLOAD_MAX = 96
HEADER_SIZE = 3
BODY_MAX = HEADER_SIZE + PAYLOAD_MAX


class Refused(Exception):
    """One sentence with file and line."""


@dataclass
class Field:
    type: str
    name: str
    unit: str
    text: str
    kind: str = "one"  # "one", "array", "masked"
    most: int = 1      # numbers, at most
    mask: str = ""     # of a masked field: the field that says which joints
    bounds: tuple = None  # as the table writes them
    low: int = 0       # bounds, or the range of the type
    high: int = 0

    def size_max(self):
        return SIZES[self.type] * self.most


@dataclass
class Message:
    name: str
    code: int
    kind: str
    text: str
    fields: list = with_default(default_factory=list)

    def is_request(self):
        return not self.code & 0x80

    def size_max(self):
        return sum(field.size_max() for field in self.fields)

    def size_min(self):
        return sum(field.size_max() for field in self.fields if field.kind != "masked")


def arguments_of(text, at, path):
    """The macro's arguments, from behind its opening bracket; adjacent strings are joined."""
    depth, quoted, parts, current = 1, False, [], ""
    for i in range(at, len(text)):
        c = text[i]
        if c == '"' and text[i - 1] != "\\":
            quoted = not quoted
        if not quoted:
            depth += (c == "(") - (c == ")")
            if depth == 0:
                parts.append(current.strip())
                break
            if c == "," and depth == 1:
                parts.append(current.strip())
                current = ""
                continue
        current += c
    else:
        raise Refused(f"{path}:{text.count(chr(10), 0, at) + 1}: a bracket is not closed")
    return [ast.literal_eval("(" + part + ")") if part.startswith('"') else part for part in parts]


def read_constants(path):
    """Name to (value as written, comment), in the order of the file."""
    with open(path, encoding="utf-8") as source:
        return {name: (value, text or "") for name, value, text in DEFINE.findall(source.read())}


def all_constants(root):
    constants = {"KZ_JOINTS": (str(JOINTS), "")}
    for name in ("protocol/frame.h", "protocol/messages.h", "servo/servo.h", "servo/snapshot.h"):
        constants.update(read_constants(f"{root}/shared/{name}"))
    return constants


def value_of(text, constants, path):
    """A number as the table writes it: digits, or the name of a constant."""
    if text in constants:
        text = constants[text][0]
    try:
        return int(text.strip("()"), 0)
    except ValueError:
        raise Refused(f"{path}: '{text}' is neither a number nor a KZ_ constant of one") from None


def read_messages(root):
    path = f"{root}/shared/protocol/messages.def"
    constants = all_constants(root)
    with open(path, encoding="utf-8") as source:
        text = re.sub(r"^//.*$", "", source.read(), flags=re.MULTILINE)
    messages = []
    for match in MACRO.finditer(text):
        a = arguments_of(text, match.end(), path)
        kind = match.group(1)
        if kind == "MESSAGE":
            messages.append(Message(a[0], int(a[1], 0), a[2], a[3]))
        elif kind == "FIELD":
            messages[-1].fields.append(Field(a[0], a[1], a[2], a[3]))
        elif kind == "BOUNDED":
            messages[-1].fields.append(Field(a[0], a[1], a[4], a[5], bounds=(a[2], a[3])))
        elif kind == "ARRAY":
            messages[-1].fields.append(
                Field(a[0], a[1], a[3], a[4], "array", value_of(a[2], constants, path)))
        elif kind == "MASKED":
            messages[-1].fields.append(
                Field(a[0], a[1], a[4], a[5], "masked", value_of(a[3], constants, path), a[2]))
    for message in messages:
        for field in message.fields:
            field.low, field.high = RANGES[field.type]
            if field.bounds:
                field.low, field.high = (value_of(b, constants, path) for b in field.bounds)
    return messages


# ---- Frames

def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def stuff(body):
    out = bytearray()
    for block in bytes(body).split(b"\0"):
        out += bytes([len(block) + 1]) + block
    return bytes(out)


def unstuff(stuffed):
    """None where the stuffing does not come out."""
    blocks, at = [], 0
    while at < len(stuffed):
        end = at + stuffed[at]
        if end > len(stuffed):
            return None
        blocks.append(stuffed[at + 1:end])
        at = end
    return b"\0".join(blocks)


def check_of(stuffed):
    crc = crc16(stuffed)
    return bytes([0x80 | crc >> 14, 0x80 | crc >> 7 & 0x7F, 0x80 | crc & 0x7F])


def frame_of(body):
    stuffed = stuff(body)
    return b"\0" + stuffed + check_of(stuffed) + b"\0"


def received(wire):
    """What a receiver makes of the bytes: a list of (result, body); the body only of FRAME."""
    results = []
    for piece in bytes(wire).split(b"\0")[1:-1]:  # before the first zero, behind the last: no frame
        if not piece:
            continue
        body = None
        if len(piece) > BODY_MAX + 4:
            result = "TOO_LONG"
        elif len(piece) <= 3:
            result = "TOO_SHORT"
        elif check_of(piece[:-3]) != piece[-3:]:
            result = "BAD_CHECK"
        else:
            body = unstuff(piece[:-3])
            result = "FRAME"
            if body is None:
                result = "BAD_STUFFING"
            elif len(body) < HEADER_SIZE:
                result, body = "TOO_SHORT", None
        results.append((result, body))
    return results


# ---- Fields

def joints_of(mask, most):
    return [joint for joint in range(JOINTS) if mask >> joint & 1][:most]


def pack(message, values):
    """Bytes of the fields. `values`: name to number, or to a list; of a masked field one by joint."""
    out = bytearray()
    for field in message.fields:
        value = values[field.name]
        if field.kind == "one":
            numbers = [value]
        elif field.kind == "array":
            numbers = value
        else:
            numbers = [value[joint] for joint in joints_of(values[field.mask], field.most)]
        for number in numbers:
            out += number.to_bytes(SIZES[field.type], "big", signed=field.type == "s16")
    return bytes(out)


def out_of_bounds(message, values):
    """Number of the first field that is out of its bounds, or None."""
    for i, field in enumerate(message.fields):
        if field.kind == "one" and not field.low <= values[field.name] <= field.high:
            return i
    return None
