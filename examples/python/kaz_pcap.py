#!/usr/bin/env python3
# Makes a capture for Wireshark from the bytes of Kaz's serial line: one packet a frame.
# SPDX-License-Identifier: Apache-2.0
"""Reads the bytes of one direction, from a serial port that listens on the line or from a file, and
writes them as a capture that shared/protocol/wireshark/kaz.lua dissects. Damaged frames are kept. Ctrl-C ends
the capture. The first frame replaces an existing capture. Any other existing file is kept.

exit status: 0 captured; 1 no frame came, nothing is written; 2 wrong usage, or the target is another kind of
file; 3 the port is in use, or cannot be read or written

examples:
  kaz_pcap.py /dev/ttyUSB1 line.pcap --seconds 10
  kaz_pcap.py recorded.bin line.pcap
  wireshark -X lua_script:shared/protocol/wireshark/kaz.lua line.pcap    # installed: share/kaz/wireshark
"""
import argparse
import fcntl
import math
import os
import select
import stat
import struct
import sys
import termios
import time
import tty

USER0 = 147  # link type of pcap files for private use
# Of pcap files in either byte order, with microseconds or nanoseconds.
MAGICS = [struct.pack(order + "I", magic) for order in "<>" for magic in (0xA1B2C3D4, 0xA1B23C4D)]


class Target:
    """The capture's file: opened at once, changed by the first frame."""

    def __init__(self, path):
        self.path = path
        self.created = not os.path.lexists(path)
        self.file = os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT, 0o666), "wb")
        self.count = 0

    def write(self, when, frame):
        if self.count == 0:
            if stat.S_ISREG(os.fstat(self.file.fileno()).st_mode):
                self.file.truncate(0)
            self.file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, USER0))
        self.file.write(packet(when, frame))
        self.count += 1

    def close(self):
        self.file.close()
        if self.count == 0 and self.created:
            os.unlink(self.path)


def may_be_replaced(path):
    """Returns True if the path is absent, empty, a capture, or not a regular file (such as a pipe)."""
    if not os.path.isfile(path):
        return True
    with open(path, "rb") as file:
        return file.read(4) in [b"", *MAGICS]


def chunks(path, seconds):
    """Yields bytes with their arrival time; those of a file all at once."""
    port = os.open(path, os.O_RDONLY | os.O_NOCTTY)
    if not os.isatty(port):
        with os.fdopen(port, "rb") as file:
            yield time.time(), file.read()
        return
    fcntl.flock(port, fcntl.LOCK_EX | fcntl.LOCK_NB)  # two readers would each get a part
    tty.setraw(port)
    settings = termios.tcgetattr(port)
    settings[4] = settings[5] = termios.B115200
    termios.tcsetattr(port, termios.TCSANOW, settings)
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        if select.select([port], [], [], left)[0]:
            received = os.read(port, 256)
            if not received:
                return
            yield time.time(), received


def packet(when, frame):
    return struct.pack("<IIII", int(when), int(when % 1 * 1e6), len(frame), len(frame)) + frame


def capture(path, target, seconds):
    rest = b""
    try:
        for when, received in chunks(path, seconds):
            *pieces, rest = (rest + received).split(b"\0")
            for piece in filter(None, pieces):
                target.write(when, b"\0" + piece + b"\0")
    except KeyboardInterrupt:  # the normal end of a long capture
        pass


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help="serial port, or file with the bytes")
    parser.add_argument("pcap", help="capture to write")
    parser.add_argument("--seconds", type=float, default=10, help="for a port (default: 10)")
    options = parser.parse_args()
    if not math.isfinite(options.seconds) or options.seconds <= 0:
        parser.error("--seconds must be above 0")
    try:
        if not may_be_replaced(options.pcap):
            print(f"kaz_pcap.py: '{options.pcap}' is not a capture and would be replaced: remove it, or give "
                  "another path", file=sys.stderr)
            return 2
        target = Target(options.pcap)
        try:
            capture(options.source, target, options.seconds)
        finally:
            target.close()
    except BlockingIOError:
        print(f"kaz_pcap.py: '{options.source}' is in use by another program: end that program first",
              file=sys.stderr)
        return 3
    except (OSError, termios.error) as error:
        print(f"kaz_pcap.py: cannot capture '{options.source}' to '{options.pcap}': "
              f"{error.args[-1]}", file=sys.stderr)
        return 3
    if target.count == 0:
        print(f"kaz_pcap.py: no frame came from '{options.source}': give the port or the bytes of a line on "
              "which a host and a board talk", file=sys.stderr)
        return 1
    print(f"{target.count} frame{'' if target.count == 1 else 's'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
