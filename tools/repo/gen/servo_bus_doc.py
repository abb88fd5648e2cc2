#!/usr/bin/env python3
# Writes the page of the servo buses from its template and the servos' register tables.
# SPDX-License-Identifier: Apache-2.0
"""usage: servo_bus_doc.py ROOT [--check]

Writes ROOT/docs/reference/servo-bus.md; with --check only compares, and fails if it is out of date.
"""
import csv
import re
import sys

import generated_file
from protocol_table import Refused

# Columns of the tables in the order of the models, which the page names.
MODELS = {"feetech": ("sts3215", "scs0009"), "dynamixel": ("xl330", "xl430", "xm430")}
# Constant, and of no use to a client.
LEFT_OUT = ("endianness",)
HEADER = ("<!-- Written by tools/repo/gen/servo_bus_doc.py from tools/repo/gen/servo-bus.md.in, "
          "shared/feetech/*.def and shared/dynamixel/*.def: edit those. -->\n")
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
        # As in C, adjacent strings are one.
        whole = " ".join(line.split()).replace('" "', "")
        cells = next(csv.reader([whole], skipinitialspace=True))
        names = COLUMNS[kind].split()
        if len(cells) != len(names):
            raise Refused(f"{path}: {kind}({line}) does not have {len(names)} columns")
        yield kind, dict(zip(names, cells))


def registers(path):
    return {row["name"]: {"sign": "0", "unit": "", "values": "", "count": "1", "step": "0", **row}
            for kind, row in rows(path) if kind != "KZ_INITIAL"}


def by_name(root, family):
    """{register: {model: row}}, in the order of addresses."""
    tables = {model: registers(f"{root}/shared/{family}/{model}.def") for model in MODELS[family]}
    names = {name: int(row["address"]) for table in reversed(tables.values()) for name, row in table.items()}
    return {name: {model: table[name] for model, table in tables.items() if name in table}
            for name in sorted(names, key=names.get) if name not in LEFT_OUT}


def joined(texts):
    """The values of the models: one if they are equal."""
    return texts[0] if len(set(texts)) == 1 else (" / " if " " in "".join(texts) else "/").join(texts)


def meaning(owners):
    """The effects, without those that another one contains."""
    texts = list(dict.fromkeys(row["effect"] for row in owners))
    texts = [one for one in texts
             if not any(one != other and all(part in other for part in one.split(", ")) for other in texts)
             and one != "[unknown]"]
    quantity = owners[0]["name"].split("_")[-1]
    return " / ".join(f"{quantity} {one}" if one.startswith("of ") else one for one in texts)


def address(row):
    last = int(row["address"]) + int(row["size"]) * int(row["count"]) - 1
    return row["address"] if last == int(row["address"]) else f"{row['address']}–{last}"


def initial(row):
    if row["step"] == "0":
        return row["initial"]
    return f"{row['initial']}, {int(row['initial']) + int(row['step'])}, ..."


def bounds(row):
    if row["values"]:
        return row["values"].replace(" ", ",")
    return f"±{row['high']}" if int(row["low"]) == -int(row["high"]) else f"{row['low']}–{row['high']}"


def unit_after(unit):
    if unit in ("", "bits", "code"):
        return ""
    return f" × {unit}" if unit[0].isdigit() else f" {unit}"


def limits(owners):
    """The ranges with their unit: once if it is the same for all models."""
    units = [unit_after(row["unit"]) for row in owners]
    if len(set(units)) == 1:
        return joined([bounds(row) for row in owners]) + units[0]
    return joined([bounds(row) + unit for row, unit in zip(owners, units)])


def is_stored_only(owners):
    return all(row["effect"].startswith("[") and row["effect"].endswith("]") for row in owners)


def line(cells):
    return "|" + "|".join(cells) + "|"


def titled(name, by_model, family):
    names = ", ".join(model.upper() for model in by_model)
    return f"`{name}`" + (f" ({names})" if len(by_model) < len(MODELS[family]) else "")


def writable_table(root, family, area):
    lines = ["|address|name|initial|range|meaning|", "|---|---|---|---|---|"]
    for name, by_model in by_name(root, family).items():
        owners = list(by_model.values())
        if owners[0]["access"] != "rw" or owners[0]["area"] != area or is_stored_only(owners):
            continue
        lines.append(line((joined([address(row) for row in owners]), titled(name, by_model, family),
                           joined([initial(row) for row in owners]), limits(owners), meaning(owners))))
    return "\n".join(lines)


def read_only_table(root, family):
    lines = ["|address|name|unit|meaning|", "|---|---|---|---|"]
    for name, by_model in by_name(root, family).items():
        owners = list(by_model.values())
        if owners[0]["access"] != "r" or is_stored_only(owners):
            continue
        unit = joined([row["unit"] for row in owners])
        if any(row["sign"] != "0" for row in owners):
            unit = f"{unit}, signed"
        text = meaning(owners)
        if owners[0]["area"] == "eeprom":
            text = f"{text}{': ' if text else ''}{joined([initial(row) for row in owners])}"
        lines.append(line((joined([address(row) for row in owners]), titled(name, by_model, family),
                           unit, text)))
    return "\n".join(lines)


def stored_only(root, family):
    """The writable registers without a simulated effect."""
    found = []
    for name, by_model in by_name(root, family).items():
        owners = list(by_model.values())
        if owners[0]["access"] == "rw" and is_stored_only(owners):
            found.append(f"`{name}` ({joined([row['address'] for row in owners])})")
    return ", ".join(found)


def sign_bits(root, family):
    names = {}
    for name, by_model in by_name(root, family).items():
        for bit in dict.fromkeys(row["sign"] for row in by_model.values() if row["sign"] != "0"):
            names.setdefault(bit, []).append(f"`{name}`")
    usual = max(names, key=lambda bit: len(names[bit]))
    others = [f"bit {bit} in {' and '.join(names[bit])}" for bit in sorted(names, key=int) if bit != usual]
    return f"bit {usual} ({', '.join(others)})"


def variant(root):
    changes = [row for kind, row in rows(f"{root}/shared/dynamixel/xl330.def") if kind == "KZ_INITIAL"]
    return ", ".join(f"`{row['name']}` {row['initial']}" for row in changes)


def page(root):
    with open(f"{root}/tools/repo/gen/servo-bus.md.in", encoding="utf-8") as template:
        text = template.read()
    made = {"m077": variant(root), "feetech-signs": sign_bits(root, "feetech")}
    for family in MODELS:
        made |= {f"{family}-eeprom": writable_table(root, family, "eeprom"),
                 f"{family}-ram": writable_table(root, family, "ram"),
                 f"{family}-read-only": read_only_table(root, family),
                 f"{family}-stored": stored_only(root, family)}
    for name, content in made.items():
        if f"@{name}@" not in text:
            raise Refused(f"tools/repo/gen/servo-bus.md.in does not have @{name}@")
        text = text.replace(f"@{name}@", content)
    return HEADER + text


if __name__ == "__main__":
    sys.exit(generated_file.main(sys.argv[1:], __doc__, "docs/reference/servo-bus.md", page))
