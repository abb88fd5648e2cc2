# Reads the linker's output: COFF for the H8, sections and symbols.
# SPDX-License-Identifier: Apache-2.0
"""Only what the firmware's build needs of coff-h8300 (binutils: include/coff/h8300.h)."""
import struct
from dataclasses import dataclass

FILE_HEADER = struct.Struct(">HHIIIHH")
SECTION_HEADER = struct.Struct(">8sIIIIIIHHI")
SYMBOL = struct.Struct(">8sIhHBB")
H8S_MAGIC = 0x8302  # H8S, 24-bit addresses
FLAG_BSS = 0x80


class CoffError(Exception):
    """One sentence: which file, and what is wrong with it."""


@dataclass
class Section:
    name: str
    load: int  # address in flash
    run: int  # address while running
    size: int
    offset: int  # in the file, 0: no contents


class Coff:
    def __init__(self, path):
        self.path = path
        with open(path, "rb") as source:
            self.data = bytearray(source.read())
        try:
            self._parse()
        except struct.error:
            raise CoffError(f"{path}: the file ends early")

    def _parse(self):
        magic, section_count, _, symbols_at, symbol_count, optional, _ = \
            FILE_HEADER.unpack_from(self.data, 0)
        if magic != H8S_MAGIC:
            raise CoffError(f"{self.path}: magic {magic:#06x} is not that of an H8S COFF file")
        self.sections = []
        at = FILE_HEADER.size + optional
        for _ in range(section_count):
            name, load, run, size, offset, *_, flags = SECTION_HEADER.unpack_from(self.data, at)
            if flags & FLAG_BSS:
                offset = 0
            self.sections.append(
                Section(name.rstrip(b"\0").decode("ascii"), load, run, size, offset))
            at += SECTION_HEADER.size
        strings_at = symbols_at + symbol_count * SYMBOL.size
        self.symbols = {}
        index = 0
        while index < symbol_count:
            name, value, section, _, _, extra = SYMBOL.unpack_from(
                self.data, symbols_at + index * SYMBOL.size)
            if section > 0 or section == -1:
                self.symbols[self._name(name, strings_at)] = value
            index += 1 + extra

    def _name(self, raw, strings_at):
        if raw[:4] != b"\0\0\0\0":
            return raw.rstrip(b"\0").decode("ascii")
        start = strings_at + struct.unpack_from(">I", raw, 4)[0]
        return self.data[start:self.data.index(0, start)].decode("ascii")

    def section(self, name):
        for section in self.sections:
            if section.name == name:
                return section
        raise CoffError(f"{self.path}: no section '{name}'")

    def flash(self, first, end):
        """The sections with contents whose load address lies in first..end-1, by address."""
        return sorted((s for s in self.sections
                       if s.size and s.offset and first <= s.load < end), key=lambda s: s.load)

    def write(self):
        with open(self.path, "wb") as out:
            out.write(self.data)
