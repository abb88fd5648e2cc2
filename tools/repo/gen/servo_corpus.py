# Makes the conformance suite's register tables from shared/feetech/corpus and shared/dynamixel/corpus.
# SPDX-License-Identifier: Apache-2.0
"""usage: servo_corpus.py OUTPUT CSV..."""

import json
import pathlib
import sys


def number(text):
    return "std::nullopt" if text == "-" else str(int(text or 0))


def rows(path):
    for line in path.read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        address, size, access, area, factory, low, high, sign, what = (line.split(",") + [""] * 9)[:9]
        if access not in ("R", "RW") or area not in ("EEPROM", "RAM") or not what:
            sys.exit(f"{path}: no register: {line}")
        yield (f"KZ_ROW({int(address)}, {int(size)}, {int(sign or 0)}, {str(access == 'RW').lower()}, "
               f"{str(area == 'EEPROM').lower()}, {number(factory)}, {int(low or 0)}, {int(high or 0)}, "
               f"{json.dumps(what)})")


def main():
    target = pathlib.Path(sys.argv[1])
    lines = [f"// Registers as published, made by {pathlib.Path(__file__).name}."]
    for path in map(pathlib.Path, sys.argv[2:]):
        family = path.parent.parent.name
        found = list(rows(path))
        if len({row.split(",")[0] for row in found}) != len(found):
            sys.exit(f"{path}: an address twice")
        lines += [f"KZ_TABLE({json.dumps(path.stem)}, {family})", *found, "KZ_TABLE_END"]
    target.write_text("\n".join(lines) + "\n")


main()
