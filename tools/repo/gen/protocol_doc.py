#!/usr/bin/env python3
# Writes docs/reference/protocol.md and messages.csv from the message table.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_doc.py ROOT [--check]

Writes ROOT/docs/reference/protocol.md and messages.csv; with --check only compares, and fails if one is
out of date.
"""
import csv
import io
import re
import struct
import sys
import textwrap

import generated_file
import limits
from protocol_table import (Refused, all_constants, check_of, crc16, read_constants, read_messages,
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


def declaration(field):
    """As in C: `u16 kp`, `s16 angle[18]`, `s16 angle[mask]`."""
    count = {"one": "", "array": f"[{field.most}]", "masked": f"[{field.mask}]"}[field.kind]
    return f"{field.type} {field.name}{count}"


WIDTH = 120
NO_BREAK = "\u00a0"
# Units that the page gives once, or that the end of the name has.
PLAIN_UNITS = ("100 urad", "mV", "ms", "s", "10 ms", "8 states")


def declaration_with_range(field):
    """`u16 kp 0..20480 [1/256 /rad]`; the page says once which bits a mask may have."""
    unit = f"[{field.unit}]" if field.unit and field.unit not in PLAIN_UNITS else ""
    bounds = "" if field.name == "mask" else range_of(field)
    return " ".join(filter(None, (declaration(field), bounds, unit)))


def listing(rows):
    """Rows of cells as lines with aligned columns; a last cell too long for its line is wrapped."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]) - 1)]
    starts = "  ".join(f"{{:{width}}}" for width in widths if width)
    lines = ["```"]
    for row in rows:
        start = starts.format(*(cell for cell, width in zip(row, widths) if width)) + "  "
        lines += textwrap.wrap(row[-1].replace("`", ""), 110, initial_indent=start,
                               subsequent_indent=" " * len(start)) or [start.rstrip()]
    return [*lines, "```", ""]


def own_fields(message):
    """The fields after `tick` and `status`, which all replies but that of `identify` begin with."""
    plain = [field.name for field in message.fields[:2]] == ["tick", "status"]
    return message.fields[2:] if plain else message.fields


def message_rows(message, messages):
    """(code and name, fields) of a request and its reply, or of a frame without a request."""
    rows = [(f"0x{message.code:02x} {message.name}", own_fields(message))]
    if message.is_request():
        fields = own_fields(next(m for m in messages if m.code == message.code | 0x80))
        rows += [("     reply", fields)] if fields else []
    # A line is broken between fields only.
    return [(name, ", ".join(declaration_with_range(field).replace(" ", NO_BREAK) for field in fields))
            for name, fields in rows]


def chapter(names, messages, printed):
    """The listing of the messages of a chapter; adds their names to `printed`."""
    rows = []
    for name in names.split():
        message = next((m for m in messages if m.name == name), None)
        if message is None:
            raise Refused(f"tools/repo/gen/protocol.md.in: there is no message '{name}'")
        printed.append(name)
        rows += message_rows(message, messages)
    return "\n".join(listing(rows)).rstrip().replace(NO_BREAK, " ")


def with_unlisted(text, messages):
    """The template, with each message that no @MESSAGES@ line names after the one before it in the table."""
    chapters = re.findall(r"@MESSAGES ([\w ]+)@", text)
    lists = [chapter.split() for chapter in chapters]
    before = None
    for message in messages:
        if not any(message.name in names for names in lists):
            names = next((names for names in lists if before in names), lists[-1])
            names.insert(names.index(before) + 1 if before in names else len(names), message.name)
        before = message.name
    for chapter, names in zip(chapters, lists):
        text = text.replace(f"@MESSAGES {chapter}@", f"@MESSAGES {' '.join(names)}@")
    return text


def constant_rows(constants, prefix):
    return listing([[value, name[len(prefix):], text] for name, (value, text) in constants.items()
                    if name.startswith(prefix) and not name.endswith("_MS")])


def constant_list(constants, prefix, with_text=True):
    return [", ".join(f"{name[len(prefix):]} {value}" + (f" ({text})" if text and with_text else "")
                      for name, (value, text) in constants.items()
                      if name.startswith(prefix) and not name.endswith("_MS")) + "."]


def joint_rows(root):
    """Numbers, names and mechanical limits; left and right joints with the same limits share a row."""
    urdf = f"{root}/shared/robot/kaz/kaz.urdf"
    model = limits.parse_urdf(urdf)
    rows = {}
    for i, joint in enumerate(limits.read_joints(f"{root}/shared/board/joints.def")):
        bounds = limits.limits_of(urdf, model, joint)
        rows.setdefault((joint[0].removeprefix("l_").removeprefix("r_"), bounds), []).append((i, joint[0]))
    table = []
    for (_, (lower, upper)), same in rows.items():
        numbers, names = (", ".join(str(joint[i]) for joint in same) for i in (0, 1))
        table.append([numbers, names, f"{lower}..{upper}"])
    return listing(table)


def example(title, body, meaning):
    stuffed = stuff(body)
    check = check_of(stuffed)
    return [f"{title}", "", "| part | bytes | |", "|---|---|---|",
            f"| body | `{hex_of(body)}` | {meaning} |",
            f"| on the wire | `{hex_of(bytes([0]) + stuffed + check + bytes([0]))}` "
            f"| CRC of the stuffed bytes: 0x{crc16(stuffed):04x} |", ""]


def with_value(match, constants):
    name = match.group(1)
    return f"{name} ({constants[name][0]})" if name in constants else name


def divided(value, divisor):
    return f"{int(value, 0) / int(divisor):g}" if divisor else value


def wrapped(text):
    """Breaks lines of prose that values made too long."""
    if text.startswith("```"):
        return text
    lines = [textwrap.fill(line, WIDTH, subsequent_indent="  " if line.startswith(("- ", "  ")) else "",
                           break_long_words=False, break_on_hyphens=False)
             if len(line) > WIDTH and not line.startswith("|") else line for line in text.split("\n")]
    return "\n".join(lines)


def document(root):
    messages = read_messages(root)
    constants = read_constants(f"{root}/shared/protocol/messages.h")
    snapshot = read_constants(f"{root}/shared/servo/snapshot.h")
    everything = all_constants(root)
    targets = struct.pack(">BBBIHhh", 1, 3, 7, 0b11, 500, 1000, -2)
    with open(f"{root}/tools/repo/gen/protocol.md.in", encoding="utf-8") as source:
        text = source.read()
    blocks = {
        "EXAMPLE_STATE": example("Example: the request `state` with sequence number 5 to board 1:",
                                 bytes([1, 5, 5]), "address, type, sequence number"),
        "EXAMPLE_TARGETS": example(
            "Example: the request `targets` with sequence number 7 moves joints 0 and 1 to 0.1 and "
            "−0.0002 rad in 500 ms:",
            targets, "mask 00000003, 500 ms = 01f4, 1000 = 03e8, −2 = fffe"),
        "STATUS": constant_list(constants, "KZ_STATUS_", False),
        "REFUSED": constant_list(constants, "KZ_REFUSED_", False),
        "SHUTDOWN": constant_list(constants, "KZ_SHUTDOWN_", False),
        "JOINT": constant_rows(constants, "KZ_JOINT_"),
        "RESET": constant_list(snapshot, "KZ_RESET_"),
        "JOINTS": joint_rows(root),
        **{name: constant_list(constants, f"KZ_{name}_", False)
           for name in ("REACTION", "CAPABILITY", "TELEMETRY", "TEST", "CALIBRATION")},
    }
    for key, lines in blocks.items():
        text = text.replace(f"@{key}@", "\n".join(lines).rstrip())
    printed = []
    wanted = [m for m in messages if m.is_request() or m.kind in ("TELEMETRY", "REFUSAL")]
    text = with_unlisted(text, wanted)
    text = re.sub(r"@MESSAGES ([\w ]+)@", lambda match: chapter(match.group(1), messages, printed), text)
    if len(printed) != len(wanted):
        raise Refused("tools/repo/gen/protocol.md.in: messages listed twice: "
                      f"{', '.join(sorted(name for name in set(printed) if printed.count(name) > 1))}")
    # A constant that the table's texts name is printed with its value.
    text = re.sub(r"(?<![@\w])(KZ_\w*[A-Z0-9])(?![\w*@])", lambda match: with_value(match, everything),
                  text)
    text = re.sub(r"@(KZ_\w+)(?:/(\d+))?@",
                  lambda match: divided(everything[match.group(1)][0], match.group(2)), text)
    return "".join(map(wrapped, re.split(r"(^```.*?^```$)", text, flags=re.M | re.S)))


def message_table(root):
    """Each message and its fields. Offsets are empty after a masked field, as they depend on the mask."""
    everything = all_constants(root)
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(["code", "message", "offset", "type", "field", "range", "unit", "meaning"])

    def plain(text):
        return re.sub(r"\b(KZ_\w*[A-Z0-9])(?![\w*])", lambda match: with_value(match, everything),
                      text.replace("`", ""))

    for message in read_messages(root):
        code = f"0x{message.code:02x}"
        table.writerow([code, message.name, "", "", "", "", "", plain(message.text)])
        at = 0
        for field in message.fields:
            kind, name = declaration(field).split(" ")
            table.writerow([code, message.name, at, kind, name, range_of(field), field.unit,
                            plain(field.text)])
            at = "" if field.kind == "masked" or at == "" else at + field.size_max()
    return out.getvalue()


if __name__ == "__main__":
    sys.exit(max(generated_file.main(sys.argv[1:], __doc__, "docs/reference/protocol.md", document),
                 generated_file.main(sys.argv[1:], __doc__, "docs/reference/messages.csv", message_table)))
