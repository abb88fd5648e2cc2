#!/usr/bin/env python3
# Writes a C header with the interface id: a digest of the headers that plug-ins are compiled with.
# SPDX-License-Identifier: Apache-2.0
"""usage: interface_id.py ROOT HEADER FILE...

FILEs stand below ROOT; their order does not matter. HEADER is only written when the id changes.
"""
import hashlib
import os
import sys


def interface_id(root, files):
    digest = hashlib.sha256()
    for name in sorted(os.path.relpath(file, root).replace(os.sep, "/") for file in files):
        with open(os.path.join(root, name), "rb") as source:
            digest.update(name.encode() + b"\0" + source.read() + b"\0")
    return digest.hexdigest()[:12]


def main(arguments):
    if len(arguments) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    root, target, *files = arguments
    text = ("// Which headers of host, vision and shared these are: made by tools/repo/gen/interface_id.py.\n"
            # REUSE-IgnoreStart
            "// SPDX-License-Identifier: Apache-2.0\n"
            # REUSE-IgnoreEnd
            f'#define KAZ_INTERFACE_ID "{interface_id(root, files)}"\n')
    try:
        with open(target, encoding="utf-8") as old:
            if old.read() == text:
                return 0
    except FileNotFoundError:
        pass
    with open(target, "w", encoding="utf-8") as out:
        out.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
