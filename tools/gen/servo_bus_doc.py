#!/usr/bin/env python3
# Writes the page of the servo bus from its template and the servos' register tables.
# SPDX-License-Identifier: Apache-2.0
"""usage: servo_bus_doc.py ROOT [--check]

Writes ROOT/docs/reference/servo-bus.md; with --check only compares, and fails if it is out of date.
"""
import csv
import re
import sys

import generated_file
from protocol_table import Refused

MODELS = ("sts3215", "scs0009")
HEADER = ("<!-- Written by tools/gen/servo_bus_doc.py from tools/gen/servo-bus.md.in and "
          "shared/feetech/*.def: edit those. -->\n")
ROW = re.compile(r"^KZ_REGISTER\((.*?)\)$", re.M | re.S)


def rows(path):
    """The columns of each KZ_REGISTER of a table, which are those of a list of numbers, words and strings."""
    with open(path, encoding="utf-8") as source:
        text = re.sub(r"^//.*$", "", source.read(), flags=re.M)
    for row in ROW.findall(text):
        cells = next(csv.reader([" ".join(row.split())], skipinitialspace=True))
        if len(cells) != 12:
            raise Refused(f"{path}: KZ_REGISTER({row}) does not have 12 columns")
        yield cells


def table(root, model):
    lines = ["| address | bytes | name | access | initial | range | unit | effect | source |",
             "|---|---|---|---|---|---|---|---|---|"]
    for name, address, size, sign, access, area, initial, low, high, unit, effect, source in \
            rows(f"{root}/shared/feetech/{model}.def"):
        size = size if sign == "0" else f"{size}, sign bit {sign}"
        kept = ("R" if access == "r" else "RW") + (", kept" if area == "eeprom" else "")
        bounds = f"{low} to {high}" if access == "rw" else ""
        lines.append("| " + " | ".join((address, size, f"`{name}`", kept, initial, bounds, unit, effect,
                                        source)) + " |")
    return "\n".join(lines)


def page(root):
    with open(f"{root}/tools/gen/servo-bus.md.in", encoding="utf-8") as template:
        text = template.read()
    for model in MODELS:
        text = text.replace(f"@{model}@", table(root, model))
    return HEADER + text


if __name__ == "__main__":
    sys.exit(generated_file.main(sys.argv[1:], __doc__, "docs/reference/servo-bus.md", page))
