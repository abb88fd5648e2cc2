#!/usr/bin/env python3
# Prints how much of RAM the flash writer takes; fails if it does not fit.
# SPDX-License-Identifier: Apache-2.0
"""usage: writer_report.py OBJDUMP COFF"""
import subprocess
import sys

from coff import Coff, CoffError
from stack_bound import Unbounded, calls_out_of, disassemble, parse, stack_bound

BOOT_MAX = 2048  # hardware manual of the siblings, boot mode


def report(objdump, path):
    coff = Coff(path)
    boot, rest = coff.section(".text"), coff.section(".rest")
    if rest.run != boot.run + boot.size:
        raise CoffError(f"{path}: .rest does not follow .text")
    end = rest.run + rest.size
    for caller, callee in calls_out_of(parse(disassemble(objdump, path)), boot.run, end):
        raise CoffError(f"{path}: {caller} calls {callee:#x} outside")
    stack, names = stack_bound(objdump, path, "_kz_writer_main")
    data = max(s.run + s.size for s in coff.sections if boot.run <= s.run < 0xFFF000)
    room = coff.symbols["_kz_writer_stack"] - data
    print(f"Flash writer: {boot.size} of {BOOT_MAX} bytes through boot mode, {rest.size} behind it; "
          f"stack {stack} of {room}: " + " > ".join(name.lstrip("_") for name in names))
    return [what for what, size, limit in (("the boot part", boot.size, BOOT_MAX),
                                           ("the stack", stack, room)) if size > limit]


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        over = report(*arguments)
    except (CoffError, Unbounded, OSError, subprocess.CalledProcessError) as error:
        print(f"writer_report.py: {error}", file=sys.stderr)
        return 1
    for what in over:
        print(f"writer_report.py: {what} is over its limit", file=sys.stderr)
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
