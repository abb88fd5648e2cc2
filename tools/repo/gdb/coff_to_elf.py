#!/usr/bin/env python3
# H8 COFF to ELF: GDB reads only the latter. Sections with contents and named symbols.
# SPDX-License-Identifier: Apache-2.0
"""coff_to_elf.py IN OUT: an H8 COFF program as ELF32, big-endian, machine 46, for h8300-elf-gdb."""

import struct
import sys

TEXT, BSS = 0x20, 0x80
SHF = {"text": 6, "data": 3}


def text_at(data, at, size):
    return data[at:at + size].split(b"\0")[0].decode("latin-1")


def read_coff(data):
    magic, sections, _, symbols_at, symbol_count, optional, _ = struct.unpack_from(">HHIIIHH", data)
    if magic not in (0x8302, 0x8304):
        raise SystemExit("coff_to_elf.py: IN is no program of h8300-hms-ld: its first bytes are neither 8302 "
                         "nor 8304 (an ELF file needs no conversion)")
    entry = struct.unpack_from(">I", data, 20 + 16)[0] if optional >= 20 else 0
    strings = symbols_at + 18 * symbol_count
    found = []
    for k in range(sections):
        at = 20 + optional + 40 * k
        load, run, size, where = struct.unpack_from(">IIII", data, at + 8)
        flags = struct.unpack_from(">I", data, at + 36)[0]
        contents = None if flags & BSS or where == 0 else data[where:where + size]
        found.append((text_at(data, at, 8), load, run, size, contents, flags))
    names = []
    k = 0
    while k < symbol_count:
        at = symbols_at + 18 * k
        zero, offset = struct.unpack_from(">II", data, at)
        name = text_at(data, strings + offset, 256) if zero == 0 else text_at(data, at, 8)
        value, section, kind, storage, further = struct.unpack_from(">IhHBB", data, at + 8)
        if storage in (2, 3) and section > 0 and name and not name.startswith("."):
            names.append((name, value, section, (kind & 0x30) == 0x20, storage == 2))
        k += 1 + further
    return entry, found, names


def strings_table(names):
    table, places = b"\0", []
    for name in names:
        places.append(len(table))
        table += name.encode("latin-1") + b"\0"
    return table, places


def write_elf(entry, sections, symbols):
    local_first = sorted(symbols, key=lambda s: s[4])
    strtab, places = strings_table([s[0] for s in local_first])
    symtab = bytes(16)
    for (_, value, section, function, is_global), place in zip(local_first, places):
        code = sections[section - 1][5] & TEXT
        info = (1 if is_global else 0) << 4 | (2 if function or code else 1)
        symtab += struct.pack(">IIIBBH", place, value, 0, info, 0, section)
    locals_count = 1 + sum(1 for s in symbols if not s[4])
    rows = [(name, run, size, contents, SHF["text"] if flags & TEXT else SHF["data"])
            for name, _, run, size, contents, flags in sections]
    names, name_at = strings_table([r[0] for r in rows] + [".symtab", ".strtab", ".shstrtab"])
    loads = [(r, s) for r, s in zip(rows, sections) if r[3]]
    body_at = 52 + 32 * len(loads)
    body, headers, programs = b"", [bytes(40)], []
    for k, (_, run, size, contents, flags) in enumerate(rows):
        kind = 1 if contents else 8
        headers.append(struct.pack(">IIIIIIIIII", name_at[k], kind, flags, run,
                                   body_at + len(body), size, 0, 0, 2, 0))
        if contents:
            programs.append(struct.pack(">IIIIIIII", 1, body_at + len(body), run, sections[k][1],
                                        size, size, 7, 2))
        body += contents or b""
    n = len(rows)
    for kind, table, link, info, entry_size, name in ((2, symtab, n + 2, locals_count, 16, name_at[n]),
                                                      (3, strtab, 0, 0, 0, name_at[n + 1]),
                                                      (3, names, 0, 0, 0, name_at[n + 2])):
        headers.append(struct.pack(">IIIIIIIIII", name, kind, 0, 0, body_at + len(body), len(table),
                                   link, info, 1, entry_size))
        body += table
    head = b"\x7fELF\x01\x02\x01" + bytes(9)
    # Flags: H8S in advanced mode.
    head += struct.pack(">HHIIIIIHHHHHH", 2, 46, 1, entry, 52, body_at + len(body), 0x00820000, 52, 32,
                        len(programs), 40, len(headers), len(headers) - 1)
    return head + b"".join(programs) + body + b"".join(headers)


def convert(source, target):
    with open(source, "rb") as file:
        entry, sections, symbols = read_coff(file.read())
    with open(target, "wb") as file:
        file.write(write_elf(entry, sections, symbols))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    try:
        convert(sys.argv[1], sys.argv[2])
    except (OSError, struct.error) as wrong:
        raise SystemExit(f"coff_to_elf.py: {wrong}") from None
