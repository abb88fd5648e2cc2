#!/usr/bin/env python3
# Writes docs/reference/protocol.md from the message table.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_doc.py ROOT [--check]

Writes ROOT/docs/reference/protocol.md; with --check only compares, and fails if it is out of date.
"""
import re
import struct
import sys

import generated_file
import limits
from protocol_table import (all_constants, check_of, crc16, read_constants, read_messages,
                            stuff)


def hex_of(data):
    return " ".join(f"{byte:02x}" for byte in data)


def range_of(field):
    """Empty, or the bounds as numbers."""
    if not field.bounds:
        return ""
    if field.low == field.high:
        return f"{field.low:#x}"
    if field.high > 0xFFFF:
        return f"{field.low}..{field.high:#x}"
    return f"{field.low}..{field.high}"


def field_row(field, at):
    kind = {"one": field.type, "array": f"{field.type} × {field.most}",
            "masked": f"{field.type} for each bit of `{field.mask}`"}[field.kind]
    return f"| {at} | {kind} | `{field.name}` | {field.unit} | {range_of(field)} | {field.text} |"


def message_section(message):
    low, high = message.size_min(), message.size_max()
    if not message.fields:
        return [f"### 0x{message.code:02x} {message.name}", "", message.text, "", "No fields.", ""]
    length = f"{low}" if low == high else f"{low} to {high}"
    lines = [f"### 0x{message.code:02x} {message.name}", "", message.text, "",
             f"{length} byte{'s' if high > 1 else ''} of fields.", "",
             "| at | type | field | unit | range | meaning |", "|---|---|---|---|---|---|"]
    at = 0
    for field in message.fields:
        lines.append(field_row(field, at))
        # How many numbers a mask leaves out is not known: what follows stands behind it.
        at = "then" if field.kind == "masked" or at == "then" else at + field.size_max()
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


def with_value(match, constants):
    name = match.group(1)
    return f"{name} ({constants[name][0]})" if name in constants else name


def document(root):
    messages = read_messages(root)
    constants = read_constants(f"{root}/shared/protocol/messages.h")
    snapshot = read_constants(f"{root}/shared/servo/snapshot.h")
    everything = all_constants(root)
    targets = struct.pack(">BBBIHhh", 1, 3, 7, 0b11, 500, 1000, -2)
    with open(f"{root}/tools/gen/protocol.md.in", encoding="utf-8") as source:
        text = source.read()
    requests = [m for m in messages if m.is_request()]
    replies = [m for m in messages if not m.is_request()]
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
        "RESET": constant_rows(snapshot, "KZ_RESET_"),
        "JOINTS": joint_rows(root),
        **{name: constant_rows(constants, f"KZ_{name}_")
           for name in ("SHUTDOWN", "REACTION", "JOINT", "CAPABILITY", "TELEMETRY",
                        "TEST", "CALIBRATION")},
    }
    for key, lines in blocks.items():
        text = text.replace(f"@{key}@", "\n".join(lines).rstrip())
    # A constant that the table's texts name is printed with its value.
    text = re.sub(r"(?<![@\w])(KZ_\w*[A-Z0-9])(?![\w*@])", lambda match: with_value(match, everything),
                  text)
    return re.sub(r"@(KZ_\w+)@", lambda match: everything[match.group(1)][0], text)


if __name__ == "__main__":
    sys.exit(generated_file.main(sys.argv[1:], __doc__, "docs/reference/protocol.md", document))
