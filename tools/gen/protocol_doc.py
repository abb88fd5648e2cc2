#!/usr/bin/env python3
# Writes docs/protocol.md from the message table.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_doc.py ROOT [--check]

Writes ROOT/docs/protocol.md; with --check only compares, and fails if it is out of date.
"""
import ast
import os
import re
import struct
import sys

import limits

MACRO = re.compile(r"^KZ_(MESSAGE|FIELD|BOUNDED|ARRAY|MASKED|END)\(", re.MULTILINE)
DEFINE = re.compile(r"^#define (KZ_\w+) +(\w+)(?: *// (.*))?$", re.MULTILINE)
SIZES = {"u8": 1, "u16": 2, "s16": 2, "u32": 4}
CODES = {"u8": "B", "u16": "H", "s16": "h", "u32": "I"}
JOINTS = 18


class Refused(Exception):
    """One sentence with file and line."""


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


def read_messages(path):
    with open(path, encoding="utf-8") as source:
        text = source.read()
    text = re.sub(r"^//.*$", "", text, flags=re.MULTILINE)
    messages = []
    for match in MACRO.finditer(text):
        arguments = arguments_of(text, match.end(), path)
        kind = match.group(1)
        if kind == "MESSAGE":
            messages.append({"name": arguments[0], "code": int(arguments[1], 0),
                             "text": arguments[2], "fields": []})
        elif kind == "BOUNDED":
            kind_and_name, bounds, rest = arguments[:2], arguments[2:4], arguments[4:]
            messages[-1]["fields"].append(("FIELD", kind_and_name + rest, bounds))
        elif kind != "END":
            messages[-1]["fields"].append((kind, arguments, None))
    return messages


def read_constants(path):
    with open(path, encoding="utf-8") as source:
        return {name: (value, text or "") for name, value, text in DEFINE.findall(source.read())}


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


def check_of(stuffed):
    crc = crc16(stuffed)
    return bytes([0x80 | crc >> 14, 0x80 | crc >> 7 & 0x7F, 0x80 | crc & 0x7F])


def hex_of(data):
    return " ".join(f"{byte:02x}" for byte in data)


def size_of(field):
    kind, a, _ = field
    if kind == "FIELD":
        return SIZES[a[0]], SIZES[a[0]]
    if kind == "ARRAY":
        return SIZES[a[0]] * int(a[2]), SIZES[a[0]] * int(a[2])
    return 0, SIZES[a[0]] * (JOINTS if a[3] == "KZ_JOINTS" else int(a[3]))


def field_row(field, offset):
    kind, a, bounds = field
    if kind == "FIELD":
        kind_text, name, unit, text = a[0], a[1], a[2], a[3]
    elif kind == "ARRAY":
        kind_text, name, unit, text = f"{a[0]} × {a[2]}", a[1], a[3], a[4]
    else:
        kind_text, name, unit, text = f"{a[0]} for each bit of `{a[2]}`", a[1], a[4], a[5]
    range_text = f"{bounds[0]}..{bounds[1]}" if bounds else ""
    return f"| {offset} | {kind_text} | `{name}` | {unit} | {range_text} | {text} |"


def message_section(message):
    low = sum(size_of(field)[0] for field in message["fields"])
    high = sum(size_of(field)[1] for field in message["fields"])
    length = f"{low}" if low == high else f"{low} to {high}"
    lines = [f"### 0x{message['code']:02x} {message['name']}", "", message["text"], ""]
    if not message["fields"]:
        return lines + ["No fields.", ""]
    lines += [f"{length} bytes of fields.", "",
              "| at | type | field | unit | range | meaning |", "|---|---|---|---|---|---|"]
    offset = 0
    for field in message["fields"]:
        lines.append(field_row(field, offset))
        offset += size_of(field)[0]
    return lines + [""]


def constant_rows(constants, prefix):
    return [f"| {name[len(prefix):]} | {value} | {text} |"
            for name, (value, text) in constants.items()
            if name.startswith(prefix) and not name.endswith("_MS")]


def joint_rows(root):
    """Number, name and mechanical limits of each joint."""
    urdf = f"{root}/shared/robot/kaz/kaz.urdf"
    model = limits.parse_urdf(urdf)
    rows = ["| joint | name | lower | upper |", "|---|---|---|---|"]
    for i, joint in enumerate(limits.read_joints(f"{root}/shared/board/joints.def")):
        lower, upper = limits.limits_of(urdf, model, joint)
        rows.append(f"| {i} | {joint[0]} | {lower} | {upper} |")
    return rows


def example(title, body, meaning):
    stuffed = stuff(body)
    check = check_of(stuffed)
    return [f"{title}", "", "| part | bytes | |", "|---|---|---|",
            f"| body | `{hex_of(body)}` | {meaning} |",
            f"| stuffed | `{hex_of(stuffed)}` | |",
            f"| check | `{hex_of(check)}` | CRC of the stuffed bytes: 0x{crc16(stuffed):04x} |",
            f"| on the wire | `{hex_of(bytes([0]) + stuffed + check + bytes([0]))}` | |", ""]


def document(root):
    messages = read_messages(f"{root}/shared/protocol/messages.def")
    constants = read_constants(f"{root}/shared/protocol/messages.h")
    frame = read_constants(f"{root}/shared/protocol/frame.h")
    servo = read_constants(f"{root}/shared/servo/servo.h")
    ticks = read_constants(f"{root}/shared/servo/tick.h")
    targets = struct.pack(">BBBIHhh", 1, 3, 7, 0b11, 500, 1000, -2)
    with open(f"{root}/tools/gen/protocol.md.in", encoding="utf-8") as source:
        text = source.read()
    requests = [m for m in messages if not m["code"] & 0x80]
    replies = [m for m in messages if m["code"] & 0x80]
    blocks = {
        "EXAMPLE_STATE": example("The request `state`, sequence number 5, to board 1:",
                                 bytes([1, 5, 5]), "address, type, sequence number"),
        "EXAMPLE_TARGETS": example(
            "The request `targets`, sequence number 7: joints 0 and 1 to 0.1 and −0.0002 rad in "
            "500 ms:",
            targets, "mask 00000003, 500 ms = 01f4, 1000 = 03e8, −2 = fffe"),
        "REQUESTS": [line for m in requests for line in message_section(m)],
        "REPLIES": [line for m in replies for line in message_section(m)],
        "STATUS": constant_rows(constants, "KZ_STATUS_"),
        "REFUSED": constant_rows(constants, "KZ_REFUSED_"),
        "RESET": constant_rows(ticks, "KZ_RESET_"),
        "JOINTS": joint_rows(root),
        **{name: constant_rows(constants, f"KZ_{name}_")
           for name in ("SHUTDOWN", "JOINT", "CAPABILITY", "TELEMETRY", "TEST", "CALIBRATION")},
    }
    for key, lines in blocks.items():
        text = text.replace(f"@{key}@", "\n".join(lines).rstrip())
    everything = {**frame, **constants, **servo, **ticks}
    return re.sub(r"@(KZ_\w+)@", lambda match: everything[match.group(1)][0], text)


def main(arguments):
    if not arguments or arguments[1:] not in ([], ["--check"]):
        print(__doc__, file=sys.stderr)
        return 2
    target = os.path.join(arguments[0], "docs", "protocol.md")
    try:
        text = document(arguments[0])
        if len(arguments) == 1:
            with open(target, "w", encoding="utf-8") as out:
                out.write(text)
            return 0
        with open(target, encoding="utf-8") as old:
            if old.read() == text:
                return 0
        print(f"protocol_doc.py: {target} is out of date; run tools/gen/protocol_doc.py again",
              file=sys.stderr)
    except (Refused, limits.Refused, OSError) as error:
        print(f"protocol_doc.py: {error}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
