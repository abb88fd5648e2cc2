# Copies shared/ and replaces one piece of code in one of its files; fails if it does not stand there
# exactly once, so that a planted bug cannot silently become none.
# SPDX-License-Identifier: Apache-2.0
"""usage: plant.py FROM TO FILE RIGHT WRONG"""

import pathlib
import shutil
import sys


def main():
    source, target, name, right, wrong = sys.argv[1:]
    shutil.copytree(source, target, dirs_exist_ok=True)
    path = pathlib.Path(target) / name
    text = path.read_text()
    if text.count(right) != 1:
        sys.exit(f"{source}/{name}: expected exactly one '{right}', found {text.count(right)}; "
                 "adapt tests/system/planted/CMakeLists.txt to the code")
    path.write_text(text.replace(right, wrong))


main()
