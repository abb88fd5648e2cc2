#!/usr/bin/env python3
# Fills in length and CRC of the application's header, and the CRC of the loader's mark, in the linked COFF
# file.
# SPDX-License-Identifier: Apache-2.0
"""usage: stamp_image.py COFF

shared/flash/image.h has the layout of both and the range of the CRCs.
"""
import struct
import sys

from coff import Coff, CoffError

APPLICATION = 0x1000
LOADER, MARK = 0xC000, 0xDFE0
VECTORS_SIZE = 0x400
LENGTH_AT, CRC_AT, HEADER_SIZE = 12, 30, 32


def crc16(data, crc=0xFFFF):
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def flash(coff, first, end):
    """The bytes from first to end-1, as they lie in flash; blank where there is no section."""
    image = bytearray(b"\xff" * (end - first))
    for section in coff.flash(first, end):
        start = section.load - first
        image[start:start + section.size] = coff.data[section.offset:section.offset + section.size]
    return image


def application(coff):
    last = coff.flash(APPLICATION, LOADER)[-1]
    return flash(coff, APPLICATION, last.load + last.size)


def line_section(coff, name):
    section = coff.section(name)
    if section.size != HEADER_SIZE:
        raise CoffError(
            f"{coff.path}: section '{name}' has {section.size} bytes, not {HEADER_SIZE}")
    return section


def stamp(coff):
    header = line_section(coff, ".header")
    length = len(application(coff))
    struct.pack_into(">I", coff.data, header.offset + LENGTH_AT, length)
    image = application(coff)
    crc_at = header.load - APPLICATION + CRC_AT
    crc = crc16(image[:crc_at] + image[crc_at + 2:])
    struct.pack_into(">H", coff.data, header.offset + CRC_AT, crc)
    mark = line_section(coff, ".lmark")
    crc = crc16(flash(coff, LOADER, MARK), crc16(flash(coff, 0, VECTORS_SIZE)))
    struct.pack_into(">H", coff.data, mark.offset + CRC_AT, crc)


def main(arguments):
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        coff = Coff(arguments[0])
        stamp(coff)
        coff.write()
    except (CoffError, OSError) as error:
        print(f"stamp_image.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
