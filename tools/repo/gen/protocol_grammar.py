#!/usr/bin/env python3
# Writes the message table as JSON, for fuzzers and for clients in other languages.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_grammar.py ROOT [--check]

Writes ROOT/shared/protocol/grammar.json; with --check only compares, and fails if it is out of date.
"""
import json
import sys

import generated_file
from protocol_table import (BODY_MAX, HEADER_SIZE, PAYLOAD_MAX, all_constants, read_messages,
                            value_of)

GROUPS = ("STATUS", "SHUTDOWN", "REFUSED", "REACTION", "RESET", "JOINT", "CAPABILITY", "TELEMETRY",
          "TEST", "CALIBRATION")


def field_data(field):
    data = {"name": field.name, "type": field.type, "unit": field.unit, "kind": field.kind,
            "count": field.most, "low": field.low, "high": field.high,
            "bounded": field.bounds is not None}
    if field.mask:
        data["mask"] = field.mask
    return data


def line(value):
    return json.dumps(value, ensure_ascii=False)


def grammar(root):
    constants = all_constants(root)
    messages = read_messages(root)
    codes = {message.code: message.name for message in messages}
    rows = []
    for message in messages:
        reply = codes.get(message.code | 0x80) if message.is_request() else None
        fields = ",\n".join(f"    {line(field_data(field))}" for field in message.fields)
        rows.append(f'  {{"name": {line(message.name)}, "code": {message.code}, '
                    f'"request": {line(message.is_request())}, "reply": {line(reply)}, '
                    f'"size_min": {message.size_min()}, "size_max": {message.size_max()},\n'
                    f'   "fields": [' + (f"\n{fields}" if fields else "") + "]}")
    groups = []
    for group in GROUPS:
        prefix = f"KZ_{group}_"
        values = {name[len(prefix):]: value_of(name, constants, "messages.h") for name in constants
                  if name.startswith(prefix) and not name.endswith("_MS")}
        groups.append(f'  "{group}": {line(values)}')
    numbers = {"version": value_of("KZ_PROTOCOL_VERSION", constants, "messages.h"),
               "joints": value_of("KZ_JOINTS", constants, "board.h"),
               "header_size": HEADER_SIZE, "payload_max": PAYLOAD_MAX, "body_max": BODY_MAX,
               "address_last": value_of("KZ_ADDRESS_LAST", constants, "messages.h"),
               "address_all": value_of("KZ_ADDRESS_ALL", constants, "messages.h"),
               "idle_ms": value_of("KZ_IDLE_MS", constants, "frame.h")}
    return ('{"about": "The messages of Kaz\'s servo board, made by tools/repo/gen/protocol_grammar.py",\n'
            f' "frame": {line(numbers)},\n "constants": {{\n' + ",\n".join(groups) + "},\n"
            ' "messages": [\n' + ",\n".join(rows) + "]}\n")


if __name__ == "__main__":
    sys.exit(generated_file.main(sys.argv[1:], __doc__, "shared/protocol/grammar.json", grammar))
