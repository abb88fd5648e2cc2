# Makes the list of the numbered statements of docs/reference/protocol.md for the conformance suite.
# SPDX-License-Identifier: Apache-2.0
"""usage: statements.py PROTOCOL_MD OUTPUT"""

import json
import pathlib
import re
import sys


def statements(text):
    found = []
    for item in re.split(r"^- (?=\*\*)", text, flags=re.M)[1:]:
        match = re.match(r"\*\*([A-Z]+-\d+)\*\* (.*?)(?:\n\n|\Z)", item.rstrip() + "\n\n", re.S)
        if match:
            plain = re.sub(r"[`*]", "", re.sub(r"\s+", " ", match[2]))
            found.append((match[1], plain.strip()))
    return found


def main():
    source, target = map(pathlib.Path, sys.argv[1:])
    found = statements(source.read_text())
    if not found or len({name for name, _ in found}) != len(found):
        sys.exit(f"{source}: no numbered statements, or a number twice")
    lines = [f"// Statements of {source.name}, made by {pathlib.Path(__file__).name}."]
    lines += [f"KZ_STATEMENT({json.dumps(name)}, {json.dumps(text, ensure_ascii=False)})"
              for name, text in found]
    target.write_text("\n".join(lines) + "\n")


main()
