#!/usr/bin/env python3
# Makes a capture for Wireshark from the bytes of Kaz's serial line: one packet a frame.
# SPDX-License-Identifier: Apache-2.0
"""Reads the bytes of one direction, from a serial port that listens on the line or from a file, and
writes them as a capture that shared/protocol/wireshark/kaz.lua dissects. Damaged frames are kept. Ctrl-C ends
the capture.

examples:
  kaz_pcap.py /dev/ttyUSB1 line.pcap --seconds 10
  kaz_pcap.py recorded.bin line.pcap
  wireshark -X lua_script:shared/protocol/wireshark/kaz.lua line.pcap
"""
import argparse
import fcntl
import math
import os
import select
import struct
import sys
import termios
import time
import tty

USER0 = 147  # link type of pcap files for private use


def chunks(path, seconds):
    """Pieces of bytes with the time at which they came; those of a file all at once."""
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


def capture(path, out, seconds):
    """Number of frames written."""
    count, rest = 0, b""
    out.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, USER0))
    try:
        for when, received in chunks(path, seconds):
            *pieces, rest = (rest + received).split(b"\0")
            for piece in filter(None, pieces):
                out.write(packet(when, b"\0" + piece + b"\0"))
                count += 1
    except KeyboardInterrupt:  # the normal end of a long capture
        pass
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help="serial port, or file with the bytes")
    parser.add_argument("pcap", help="capture to write")
    parser.add_argument("--seconds", type=float, default=10, help="for a port (default: 10)")
    options = parser.parse_args()
    if not math.isfinite(options.seconds) or options.seconds <= 0:
        parser.error("--seconds is a number above 0")
    try:
        with open(options.pcap, "wb") as out:
            print(f"{capture(options.source, out, options.seconds)} frames")
    except BlockingIOError:
        print(f"kaz_pcap.py: '{options.source}' is in use by another program: end that one first",
              file=sys.stderr)
        return 3
    except (OSError, termios.error) as error:
        print(f"kaz_pcap.py: cannot capture '{options.source}' to '{options.pcap}': "
              f"{error.args[-1]}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
