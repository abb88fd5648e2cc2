#!/usr/bin/env python3
# Writes the pages of the servo buses from their templates and the servos' register tables.
# SPDX-License-Identifier: Apache-2.0
"""usage: servo_bus_doc.py ROOT [--check]

Writes ROOT/docs/reference/servo-bus.md and dynamixel-bus.md; with --check only compares, and fails if one is
out of date.
"""
import csv
import re
import sys

import generated_file
from protocol_table import Refused

FEETECH = ("sts3215", "scs0009")
DYNAMIXEL = ("xl330", "xl430", "xm430")
HEADER = ("<!-- Written by tools/gen/servo_bus_doc.py from tools/gen/{template}.md.in and "
          "shared/{folder}/*.def: edit those. -->\n")
# Columns of each kind of line of a table.
COLUMNS = {
    "KZ_REGISTER": "name address size sign access area initial low high unit effect source",
    "KZ_CHOICE": "name address size access area initial values low high effect source",
    "KZ_ROW": "name address size count access area initial step low high effect source",
    "KZ_INITIAL": "model name initial",
}
LINE = re.compile(r"^(KZ_[A-Z]+)\((.*?)\)$", re.M | re.S)


def rows(path):
    """The lines of a table as dictionaries, with their kind: numbers, words and strings between commas."""
    with open(path, encoding="utf-8") as source:
        text = re.sub(r"^//.*$", "", source.read(), flags=re.M)
    for kind, line in LINE.findall(text):
        if kind not in COLUMNS:
            continue
        cells = next(csv.reader([" ".join(line.split())], skipinitialspace=True))
        names = COLUMNS[kind].split()
        if len(cells) != len(names):
            raise Refused(f"{path}: {kind}({line}) does not have {len(names)} columns")
        yield kind, dict(zip(names, cells))


def registers(path):
    return [{"sign": "0", "unit": "", "values": "", "count": "1", "step": "0", **row}
            for kind, row in rows(path) if kind != "KZ_INITIAL"]


def access(row):
    return ("R" if row["access"] == "r" else "RW") + (", kept" if row["area"] == "eeprom" else "")


def line(cells):
    return "| " + " | ".join(cells) + " |"


def table(root, model):
    lines = ["| address | bytes | name | access | initial | range | unit | effect | source |",
             "|---|---|---|---|---|---|---|---|---|"]
    for row in registers(f"{root}/shared/feetech/{model}.def"):
        size = row["size"] if row["sign"] == "0" else f"{row['size']}, sign bit {row['sign']}"
        bounds = f"{row['low']} to {row['high']}" if row["access"] == "rw" else ""
        lines.append(line((row["address"], size, f"`{row['name']}`", access(row), row["initial"], bounds,
                           row["unit"], row["effect"], row["source"])))
    return "\n".join(lines)


def joined(texts):
    """What the models have, once if it is the same."""
    return texts[0] if len(set(texts)) == 1 else " / ".join(text or "-" for text in texts)


def dynamixel_table(root):
    tables = [{row["name"]: row for row in registers(f"{root}/shared/dynamixel/{model}.def")}
              for model in DYNAMIXEL]
    every = {name: row for one in tables for name, row in one.items()}
    lines = ["| address | bytes | name | access | initial | range | unit | effect | source |",
             "|---|---|---|---|---|---|---|---|---|"]

    def bounds(row):
        if row["access"] != "rw":
            return "-"
        return row["values"].replace(" ", ", ") or f"{row['low']} to {row['high']}"

    def initial(row):
        return row["initial"] if row["step"] == "0" else f"{row['initial']}, and {row['step']} more each"

    for name, first in sorted(every.items(), key=lambda item: int(item[1]["address"])):
        owners = [one.get(name) for one in tables]
        size = first["size"] + (", signed" if first["sign"] != "0" else "")
        if first["count"] != "1":
            size += f", {first['count']} times"

        def of(column, where=owners):
            return joined(["x" if row is None else column(row) for row in where])

        def of_owners(column, where=owners):
            return joined([row[column] for row in where if row is not None])

        lines.append(line((first["address"], size, f"`{name}`", access(first), of(initial), of(bounds),
                           of_owners("unit"), of_owners("effect"), of_owners("source"))))
    return "\n".join(lines)


def variant(root):
    changes = [row for kind, row in rows(f"{root}/shared/dynamixel/xl330.def") if kind == "KZ_INITIAL"]
    return ", ".join(f"`{row['name']}` {row['initial']}" for row in changes)


def feetech_page(root):
    with open(f"{root}/tools/gen/servo-bus.md.in", encoding="utf-8") as template:
        text = template.read()
    for model in FEETECH:
        text = text.replace(f"@{model}@", table(root, model))
    return HEADER.format(template="servo-bus", folder="feetech") + text


def dynamixel_page(root):
    with open(f"{root}/tools/gen/dynamixel-bus.md.in", encoding="utf-8") as template:
        text = template.read()
    text = text.replace("@registers@", dynamixel_table(root)).replace("@m077@", variant(root))
    return HEADER.format(template="dynamixel-bus", folder="dynamixel") + text


if __name__ == "__main__":
    sys.exit(max(
        generated_file.main(sys.argv[1:], __doc__, "docs/reference/servo-bus.md", feetech_page),
        generated_file.main(sys.argv[1:], __doc__, "docs/reference/dynamixel-bus.md", dynamixel_page)))
