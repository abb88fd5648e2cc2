# What generators of checked-in files have in common: write the file, or compare it.
# SPDX-License-Identifier: Apache-2.0
import os
import sys

import limits
from protocol_table import Refused


def main(arguments, usage, name, content):
    """Writes content(ROOT) to ROOT/name, or compares with --check. Returns the exit code."""
    program = os.path.basename(sys.argv[0])
    if not arguments or arguments[1:] not in ([], ["--check"]):
        print(usage, file=sys.stderr)
        return 2
    root, target = arguments[0], os.path.join(arguments[0], name)
    try:
        text = content(root)
        if len(arguments) == 1:
            os.makedirs(os.path.dirname(target), exist_ok=True)
            with open(target, "w", encoding="utf-8") as out:
                out.write(text)
            return 0
        with open(target, encoding="utf-8") as old:
            if old.read() == text:
                return 0
        print(f"{program}: {target} is out of date; run tools/repo/gen/{program} again", file=sys.stderr)
    except (Refused, limits.Refused, OSError) as error:
        print(f"{program}: {error}", file=sys.stderr)
    return 1
