#!/usr/bin/env python3
# Writes a C header with the build id: CRC-32 over the firmware's sources.
# SPDX-License-Identifier: Apache-2.0
"""usage: build_id.py ROOT HEADER FILE...

FILEs stand below ROOT; their order does not matter. HEADER is only written when the id changes.
"""
import os
import sys
import zlib


def build_id(root, files):
    crc = 0
    for name in sorted(os.path.relpath(file, root).replace(os.sep, "/") for file in files):
        with open(os.path.join(root, name), "rb") as source:
            crc = zlib.crc32(name.encode() + b"\0" + source.read(), crc)
    return crc


def main(arguments):
    if len(arguments) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    root, target, *files = arguments
    text = ("// Which sources this is: made by tools/repo/gen/build_id.py.\n"
            # REUSE-IgnoreStart
            "// SPDX-License-Identifier: Apache-2.0\n"
            # REUSE-IgnoreEnd
            f"#define KZ_BUILD_ID 0x{build_id(root, files):08x}UL\n")
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
