#!/usr/bin/env python3
# Writes a C header with an id of source files: the firmware's build id, or the interface id of plug-ins.
# SPDX-License-Identifier: Apache-2.0
"""usage: source_id.py build|interface ROOT HEADER FILE...

build: CRC-32 of the FILEs. interface: the first 12 digits of their SHA-256. FILEs stand below ROOT; their
order does not matter. HEADER is only written when the id changes.
"""
import hashlib
import os
import sys
import zlib


def build_line(named):
    crc = 0
    for name, content in named:
        crc = zlib.crc32(name + b"\0" + content, crc)
    return f"#define KZ_BUILD_ID 0x{crc:08x}UL\n"


def interface_line(named):
    digest = hashlib.sha256()
    for name, content in named:
        digest.update(name + b"\0" + content + b"\0")
    return f'#define KAZ_INTERFACE_ID "{digest.hexdigest()[:12]}"\n'


KINDS = {"build": build_line, "interface": interface_line}


def contents(root, files):
    for name in sorted(os.path.relpath(file, root).replace(os.sep, "/") for file in files):
        with open(os.path.join(root, name), "rb") as source:
            yield name.encode(), source.read()


def main(arguments):
    if len(arguments) < 4 or arguments[0] not in KINDS:
        print(__doc__, file=sys.stderr)
        return 2
    kind, root, target, *files = arguments
    text = ("// Made by tools/repo/gen/source_id.py.\n"
            # REUSE-IgnoreStart
            "// SPDX-License-Identifier: Apache-2.0\n"
            # REUSE-IgnoreEnd
            + KINDS[kind](contents(root, files)))
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
