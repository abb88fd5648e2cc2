#!/usr/bin/env python3
# Writes the Wireshark dissector from the message table.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_dissector.py ROOT [--check]

Writes ROOT/shared/protocol/wireshark/kaz.lua; with --check only compares, and fails if it is out of
date.
"""
import os
import sys

import generated_file
from protocol_table import SIZES, all_constants, read_messages, value_of

NAMED = {"status": "SHUTDOWN", "reason": "REFUSED", "reset_cause": "RESET", "reaction": "REACTION",
         "source": "CALIBRATION"}


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def message_rows(messages):
    rows = []
    for message in messages:
        rows.append(f"  [{message.code}] = {{name = {quoted(message.name)}, fields = {{")
        for field in message.fields:
            more = f", mask = {quoted(field.mask)}" if field.mask else ""
            rows.append(f"    {{name = {quoted(field.name)}, kind = {quoted(field.type)}, "
                        f"size = {SIZES[field.type]}, count = {field.most}, "
                        f"unit = {quoted(field.unit)}{more}}},")
        rows.append("  }},")
    return rows


def constant_rows(constants):
    rows = []
    for group in sorted({*NAMED.values(), "STATUS"}):
        prefix = f"KZ_{group}_"
        values = ", ".join(f"[{value_of(name, constants, 'messages.h')}] = "
                           f"{quoted(name[len(prefix):])}"
                           for name in constants if name.startswith(prefix))
        rows.append(f"  {group} = {{{values}}},")
    rows.append("  of_field = {" + ", ".join(f"{name} = {quoted(group)}" for name, group
                                             in NAMED.items() if name != "status") + "},")
    return rows


def dissector(root):
    blocks = {"MESSAGES": message_rows(read_messages(root)),
              "CONSTANTS": constant_rows(all_constants(root))}
    path = os.path.join(root, "tools", "repo", "gen", "dissector.lua.in")
    with open(path, encoding="utf-8") as source:
        text = source.read()
    for name, rows in blocks.items():
        text = text.replace(f"@{name}@", "\n".join(rows))
    return text


if __name__ == "__main__":
    sys.exit(generated_file.main(sys.argv[1:], __doc__, "shared/protocol/wireshark/kaz.lua",
                                 dissector))
