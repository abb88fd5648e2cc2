#!/usr/bin/env python3
# Fills in length and CRC of the application's header, in the linked COFF file.
# SPDX-License-Identifier: Apache-2.0
"""usage: stamp_image.py COFF

shared/flash/image.h tells the header's layout and what the CRC covers.
"""
import struct
import sys

from coff import Coff, CoffError

APPLICATION = 0x1000
LOADER = 0xC000
LENGTH_AT, CRC_AT, HEADER_SIZE = 12, 30, 32


def crc16(data, crc=0xFFFF):
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def application(coff):
    """The application's bytes from APPLICATION on, as they lie in flash."""
    sections = coff.flash(APPLICATION, LOADER)
    end = sections[-1].load + sections[-1].size
    image = bytearray(b"\xff" * (end - APPLICATION))
    for section in sections:
        start = section.load - APPLICATION
        image[start:start + section.size] = coff.data[section.offset:section.offset + section.size]
    return image


def stamp(coff):
    header = coff.section(".header")
    if header.size != HEADER_SIZE:
        raise CoffError(
            f"{coff.path}: section '.header' has {header.size} bytes, not {HEADER_SIZE}")
    length = len(application(coff))
    struct.pack_into(">I", coff.data, header.offset + LENGTH_AT, length)
    image = application(coff)
    crc_at = header.load - APPLICATION + CRC_AT
    crc = crc16(image[:crc_at] + image[crc_at + 2:])
    struct.pack_into(">H", coff.data, header.offset + CRC_AT, crc)


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
