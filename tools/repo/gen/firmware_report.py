#!/usr/bin/env python3
# Prints how much flash, RAM and stack a firmware image takes; fails if it is too much.
# SPDX-License-Identifier: Apache-2.0
"""usage: firmware_report.py OBJDUMP COFF SIZES

SIZES gets one line for each figure: name and bytes."""
import subprocess
import sys

from coff import Coff, CoffError
from stack_bound import Unbounded, calls_out_of, disassemble, parse, stack_bound
from tick_divisions import Forbidden, tick_divisions

APPLICATION, APPLICATION_END = 0x1000, 0xC000  # erase blocks EB4, EB5
LOADER, LOADER_END = 0xC000, 0xDFE0  # EB6, up to its mark
RAM, RAM_SIZE = 0xFFE080, 0xF80


def used(coff, first, end):
    sections = coff.flash(first, end)
    return sections[-1].load + sections[-1].size - first if sections else 0


def line(what, size, limit):
    return f"  {what:<12}{size:6} of {limit:6} bytes ({100 * size / limit:.0f} %)"


def check_ram_code(objdump, coff):
    """What writes flash must not call anything that lies there."""
    code = coff.section(".ramtext")
    functions = parse(disassemble(objdump, coff.path))
    for caller, callee in calls_out_of(functions, code.run, code.run + code.size):
        raise CoffError(f"{coff.path}: {caller}, which runs in RAM, calls {callee:#x} outside")


def report(objdump, path, sizes_path):
    coff = Coff(path)
    check_ram_code(objdump, coff)
    data = coff.symbols["_kz_bss_end"] - RAM  # with the gaps between sections
    stack, names = stack_bound(objdump, path, "_kz_start")
    sizes = [("application", used(coff, APPLICATION, APPLICATION_END),
              APPLICATION_END - APPLICATION),
             ("loader", used(coff, LOADER, LOADER_END), LOADER_END - LOADER),
             ("data", data, RAM_SIZE),
             ("data + stack", data + stack, RAM_SIZE)]
    print(f"Firmware {path}")
    for what, size, limit in sizes:
        print(line(what, size, limit))
    print(f"  stack at most {stack} bytes: " + " > ".join(name.lstrip("_") for name in names))
    divisions = tick_divisions(parse(disassemble(objdump, path)))
    print("  divisions in the path of a tick: " +
          (", ".join(f"{name.lstrip('_')} {count}" for name, count in divisions.items()) or "none"))
    with open(sizes_path, "w", encoding="utf-8") as out:
        out.writelines(f"{what.replace(' + ', '_')} {size}\n" for what, size, _ in sizes)
        out.write(f"stack {stack}\n")
    return [what for what, size, limit in sizes if size > limit]


def main(arguments):
    if len(arguments) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        over = report(*arguments)
    except (CoffError, Unbounded, Forbidden, OSError, subprocess.CalledProcessError) as error:
        print(f"firmware_report.py: {error}", file=sys.stderr)
        return 1
    for what in over:
        print(f"firmware_report.py: {what} is over its limit", file=sys.stderr)
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
