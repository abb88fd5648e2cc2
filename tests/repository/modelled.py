# The table of docs/explanation/emulator.md: each row names tests that show it, and each named test exists.
# SPDX-License-Identifier: Apache-2.0
"""usage: modelled.py ROOT"""

import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
TEST = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")

existing = {".".join(name) for source in ROOT.glob("sim/h8s/**/*_test.cpp")
            for name in TEST.findall(source.read_text())}
text = (ROOT / "docs/explanation/emulator.md").read_text()
table = text[text.index("| part | modeled"):].split("\n\n")[0]
rows = [row for row in table.splitlines()[2:] if row.startswith("|")]
wrong = []
for row in rows:
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    named = re.findall(r"`(\w+\.\w+)`", cells[-1])
    if len(cells) != 4 or not named:
        wrong.append(f"row '{cells[0]}' has {len(cells)} cells and names {len(named)} tests")
    wrong += [f"row '{cells[0]}': there is no test {name}" for name in named if name not in existing]
for line in wrong:
    print(f"docs/explanation/emulator.md: {line}")
print(f"{len(rows)} rows")
sys.exit(1 if wrong or not rows else 0)
