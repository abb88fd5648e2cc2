#!/usr/bin/env python3
# A program that sees: finds the red ball in the pictures and turns the head to it; standard library alone.
# SPDX-License-Identifier: Apache-2.0
"""Looks for the red ball and turns the head until the ball is in the middle of the left picture.

example:
  kaz sim --world catch --serial board --cameras board.eyes &   kaz_ball.py board board.eyes

exit codes: 0 the head points at the ball, 1 no ball, or the head did not reach it, 2 wrong usage,
3 no port, no board or no camera; 128 + signal interrupted (130: Ctrl-C)
"""
import argparse
import math
import socket
import struct
import sys
import time

import kaz_client

ALL_JOINTS, NECK = 0x3FFFF, 0x3
SEARCH = [(pan, 0.6) for pan in (0.0, 0.6, 1.1, -0.6, -1.1)]  # rad: pan to the left, tilt down
CENTRED = math.radians(1.5)


class Camera:
    """Reads docs/reference/camera-stream.md."""

    def __init__(self, path):
        try:
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.settimeout(10)
            self.socket.connect(path)
        except OSError as error:
            raise kaz_client.NoBoard(f"no camera at '{path}': {error.strerror or error}") from error
        self.stream = self.socket.makefile("rb")
        magic, version, *rest = struct.unpack("<4sIII5dq", self.read(64))
        if (magic, version) != (b"KAZC", 1):
            raise kaz_client.NoBoard(f"'{path}' is not a camera stream of version 1: {magic!r}, {version}")
        self.width, self.height, self.fx, self.fy, self.cx, self.cy, *_ = rest

    def read(self, count):
        try:
            data = self.stream.read(count)
        except OSError as error:
            raise kaz_client.NoBoard(f"the camera sends nothing: {error}") from error
        if len(data) < count:
            raise kaz_client.NoBoard("the camera is gone: the simulator has ended")
        return data

    def picture_after(self, moment_ns):
        """Returns the left picture of the first pair exposed after that time: RGB, rows from the top."""
        while True:
            magic, _reserved, _sequence, exposure_ns = struct.unpack("<4sIQq", self.read(24))
            if magic != b"PAIR":
                raise kaz_client.NoBoard("the camera's stream is damaged")
            left = self.read(3 * self.width * self.height)
            self.read(len(left))  # the right one
            if exposure_ns > moment_ns:
                return left

    def ball(self, rgb):
        """Returns the red pixels' center, rad left of and below the axis; None without a ball."""
        red = [i for i, (r, g, b) in enumerate(zip(rgb[0::3], rgb[1::3], rgb[2::3]))
               if r > 50 and r > 2.5 * g and r > 2.5 * b]
        if len(red) < 20:
            return None
        u = sum(i % self.width for i in red) / len(red)
        v = sum(i // self.width for i in red) / len(red)
        return math.atan((self.cx - u) / self.fx), math.atan((v - self.cy) / self.fy)


def turn_head(board, pan, tilt, seconds=0.5):
    """Waits until the head is at rest, so that the next picture fits the angles read. False: it is not."""
    angles = [round(angle / kaz_client.UNIT) for angle in (pan, tilt)]
    board.request(kaz_client.TARGETS, struct.pack(">IH2h", NECK, round(seconds * 1000), *angles))
    # Wherever it rests: the picture shows what is left.
    if kaz_client.settle(board, {0: pan, 1: tilt}, seconds, near=math.inf):
        return True
    print("kaz_ball.py: the head does not come to rest", file=sys.stderr)
    return False


def look_at_ball(board, camera):
    """Looks around until a ball is seen, then turns towards it. Returns pan, tilt and the remaining error."""
    places = iter(SEARCH)
    for _ in range(12):
        ball = camera.ball(camera.picture_after(time.monotonic_ns()))  # the head is at rest by now
        _, _, (pan, tilt, *_) = board.state()
        if ball is None:
            place = next(places, None)
            if place is None:
                return None
            if not turn_head(board, *place):
                return None
            continue
        error = math.hypot(*ball)
        print(f"ball {math.degrees(error):.1f} degrees from the middle, head at {pan:+.3f} {tilt:+.3f} rad")
        if error < CENTRED:
            return pan, tilt, error
        if not turn_head(board, pan + ball[0], tilt + ball[1]):
            return None
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", help="serial device, or the pty of `kaz sim --serial`")
    parser.add_argument("camera", help="socket of `kaz sim --cameras`")
    options = parser.parse_args()
    return kaz_client.run("kaz_ball.py", lambda: find(options))


def find(options):
    camera = Camera(options.camera)
    board = kaz_client.Board(options.port)
    board.identify()
    # Waiting for a picture may take longer than the link watchdog's 90 ms: 1 s.
    board.request(kaz_client.HEARTBEAT, bytes([100, kaz_client.REACTION_HOLD]))
    board.request(kaz_client.CLEAR)
    try:
        # Gains of the neck as in kaz_client.move. The other joints hold, else the robot would sink down.
        board.gains((0, 1), 12, 0.15)
        board.request(kaz_client.ENABLE, struct.pack(">I", ALL_JOINTS))
        found = look_at_ball(board, camera)
    finally:
        off = board.off()
    if not off:
        return 3
    if found is None:
        print("kaz_ball.py: no red ball was found, or the head does not reach it", file=sys.stderr)
        return 1
    print(f"the head points at the ball: pan {found[0]:+.3f}, tilt {found[1]:+.3f} rad")
    return 0


if __name__ == "__main__":
    sys.exit(main())
