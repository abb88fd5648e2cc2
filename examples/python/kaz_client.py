#!/usr/bin/env python3
# A client of Kaz's servo board, written from docs/reference/protocol.md, with the standard library alone.
# SPDX-License-Identifier: Apache-2.0
"""Moves one joint of Kaz, reads it back, and shows what a refusal looks like.

examples:
  kaz_client.py /dev/ttyUSB0 --joint 0 --angle 0.3
  kaz sim --world ball --serial board &   kaz_client.py ./board --joint 1 --angle -0.2

exit codes: 0 done, 1 the joint did not reach its target or the board refused, 2 wrong usage,
3 no port, or no board that answers; 128 + signal interrupted (130: Ctrl-C)
"""
import argparse
import errno
import fcntl
import math
import os
import select
import signal
import struct
import sys
import termios
import time
import tty

ADDRESS = 1
IDENTIFY, ENABLE, TARGETS, GAINS, STATE, HEARTBEAT, CLEAR, SETTINGS, REFUSED = (
    0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x08, 0x14, 0xFF)
PROTOCOL_VERSIONS = (2, 3)
REACTION_HOLD = 2
REASONS = {1: "unknown type", 2: "wrong length", 3: "value out of range",
           4: "target outside the joint's soft limits", 5: "joint is off",
           6: "a shutdown is latched", 7: "too many requests", 8: "only while all motors are off",
           9: "only under unlock", 10: "not on a shared line", 11: "flash could not be written"}
SHUTDOWNS = {1: "emergency stop", 2: "no request came for too long", 3: "potentiometer open or short",
             4: "supply too low", 5: "supply too high", 6: "motor drivers too hot",
             7: "A/D converter misreads its reference", 8: "motor stalled", 9: "motor overloaded",
             10: "self-test failed"}
UNIT = 1e-4  # angles are in 100 microradians


class Refusal(Exception):
    """A negative reply: the board does not execute the request."""

    def __init__(self, request, reason, detail):
        where = f", joint {detail}" if reason in (4, 5) else ""
        if reason == 6:
            where = f" ({SHUTDOWNS.get(detail, detail)})"
        super().__init__(f"the board refused request 0x{request:02x}: "
                         f"{REASONS.get(reason, f'reason {reason}')}{where}")
        self.reason, self.detail = reason, detail


class ShutDown(Exception):
    """The board has switched its motors off by itself."""

    def __init__(self, reason):
        super().__init__(f"the board has shut down: {SHUTDOWNS.get(reason, reason)}; "
                         "see docs/explanation/safety.md")


class NoBoard(Exception):
    """The port cannot be opened, or nothing answers."""


class Interrupted(Exception):
    """Ctrl-C, SIGTERM or SIGHUP: raised wherever the program waits, so that the motors go off."""

    def __init__(self, number):
        super().__init__("interrupted")
        self.number = number


def catch_signals():
    def interrupt(number, _frame):
        signal.signal(number, signal.SIG_DFL)  # a second one ends the program at once
        raise Interrupted(number)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, interrupt)


def run(name, work):
    """Returns the exit code of work(), or that of its error."""
    try:
        catch_signals()
        return work()
    except (Refusal, ShutDown, NoBoard, Interrupted) as error:
        print(f"{name}: {error}", file=sys.stderr)
        if isinstance(error, Interrupted):
            return 128 + error.number
        return 3 if isinstance(error, NoBoard) else 1


# ---- Frames: 00 | stuffed body | check | 00

CRC_START = 0xFFFF


def crcs_of(stuffed):
    """The CRC after each byte."""
    crc = CRC_START
    for byte in stuffed:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1
            crc &= 0xFFFF
        yield crc


def check_of(stuffed):
    *_, crc = crcs_of(stuffed)
    return bytes([0x80 | crc >> 14, 0x80 | crc >> 7 & 0x7F, 0x80 | crc & 0x7F])


def stuffed_of(body):
    return b"".join(bytes([len(piece) + 1]) + piece for piece in body.split(b"\0"))


def frame_of(body):
    stuffed = stuffed_of(body)
    return b"\0" + stuffed + check_of(stuffed) + b"\0"


def splits(body):
    """A byte that becomes a zero would leave a valid frame behind it (FRAME-4)."""
    return CRC_START in crcs_of(stuffed_of(body))


def body_of(piece):
    """Returns the body of the bytes between two zeros; None if they are damaged."""
    stuffed, check = piece[:-3], piece[-3:]
    if not stuffed or check_of(stuffed) != check:
        return None
    pieces = []
    while stuffed:
        length = stuffed[0]
        if length > len(stuffed):
            return None
        pieces.append(stuffed[1:length])
        stuffed = stuffed[length:]
    body = b"\0".join(pieces)
    return body if len(body) >= 3 else None


# ---- Requests and replies

class Board:
    def __init__(self, path):
        self.watchdog = None  # as found; off() puts it back
        self.found_gains = {}  # of a joint: the same
        try:
            self.port = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
            fcntl.flock(self.port, fcntl.LOCK_EX | fcntl.LOCK_NB)  # as `kaz` does
            tty.setraw(self.port)  # 8 bits, no parity, nothing translated
            settings = termios.tcgetattr(self.port)
            settings[4] = settings[5] = termios.B115200
            termios.tcsetattr(self.port, termios.TCSANOW, settings)
            termios.tcflush(self.port, termios.TCIOFLUSH)
        except BlockingIOError as error:
            raise NoBoard(f"'{path}' is in use by another program: end that program first") from error
        except (OSError, termios.error) as error:
            why = "it is not a serial port" if error.args[0] == errno.ENOTTY else error.args[-1]
            raise NoBoard(f"cannot open '{path}': {why}") from error
        self.path = path
        self.heard = b""
        self.sequence = os.urandom(1)[0]  # hardly where the last client ended

    def bodies(self, until):
        """Yields valid bodies as they arrive, until the given time."""
        while (left := until - time.monotonic()) > 0:
            if not select.select([self.port], [], [], left)[0]:
                continue
            try:
                received = os.read(self.port, 256)
            except BlockingIOError:
                continue
            except OSError as error:
                raise NoBoard(f"'{self.path}' is gone: {error.strerror}") from error
            if not received:
                raise NoBoard(f"'{self.path}' is gone")
            *pieces, self.heard = (self.heard + received).split(b"\0")
            self.heard = self.heard[-200:]  # no frame is longer
            yield from filter(None, map(body_of, pieces))

    def write(self, frame, until):
        """Returns False if the port accepts nothing."""
        while frame and (left := until - time.monotonic()) > 0:
            if not select.select([], [self.port], [], left)[1]:
                break
            try:
                frame = frame[os.write(self.port, frame):]
            except BlockingIOError:
                continue
            except OSError as error:
                raise NoBoard(f"'{self.path}' is gone: {error.strerror}") from error
        return not frame

    def new_sequence(self, kind, fields):
        while True:
            self.sequence = self.sequence + 1 & 0xFF
            if not splits(bytes([ADDRESS, kind, self.sequence]) + fields):
                return self.sequence

    def request(self, kind, fields=b"", patience_s=0.5):
        """Returns the fields of the reply. A request without a reply is repeated with the same number.

        A request that switches all motors off gets a new number each time: protocol 2 executes no repetition.
        """
        off = kind == ENABLE and not any(fields)
        sequences = []
        give_up = time.monotonic() + patience_s
        while time.monotonic() < give_up:
            if off or not sequences:
                sequences.append(self.new_sequence(kind, fields))
            if not self.write(frame_of(bytes([ADDRESS, kind, sequences[-1]]) + fields), give_up):
                break
            for body in self.bodies(time.monotonic() + 0.05):
                address, reply, sequence = body[:3]
                if address != ADDRESS or sequence not in sequences:
                    continue
                if reply == REFUSED:
                    _tick, _status, request, reason, detail = struct.unpack(">IHBBB", body[3:])
                    raise Refusal(request, reason, detail)
                if reply == kind | 0x80:
                    return body[3:]
        raise NoBoard(f"no board answers at '{self.path}'")

    def identify(self):
        reply = self.request(IDENTIFY, patience_s=3)
        tick, version, joints, status = struct.unpack(">IBBH", reply[:8])
        if version in PROTOCOL_VERSIONS and self.watchdog is None:
            self.watchdog = bytes(reply[19:21])  # limit and reaction, as off() puts them back
        return {"tick": tick, "version": version, "joints": joints, "status": status}

    def state(self):
        """Returns the board's time in s, the shutdown reason (0: none), and the angles in rad."""
        tick, status, _supply, *angles = struct.unpack(">IHH18h", self.request(STATE))
        return tick / 1000, status >> 8, [angle * UNIT for angle in angles]

    def off(self):
        """Call this last in every program. Never raises. Returns True if all motors are off."""
        try:
            _tick, _status, mask = struct.unpack(">IHI", self.request(ENABLE, struct.pack(">I", 0)))
            if mask:
                raise NoBoard(f"joints of mask {mask:#x} are still on")
            for joint, found in self.found_gains.items():
                self.request(GAINS, struct.pack(">I", 1 << joint) + found)
            if self.watchdog:
                self.request(HEARTBEAT, self.watchdog)
            return True
        except (Refusal, NoBoard) as error:
            print(f"{error}: the motors may still hold; switch the board off", file=sys.stderr)
            return False

    def gains(self, joints, kp, kd):
        """Sets kp in duty per rad and kd in duty per rad/s for the joints, without dead band and friction."""
        for joint in joints:
            if joint not in self.found_gains:  # bytes 7 to 13 of the reply are as a request has them
                self.found_gains[joint] = self.request(SETTINGS, bytes([joint]))[7:14]
        mask = sum(1 << joint for joint in joints)
        self.request(GAINS, struct.pack(">IHHHB", mask, round(kp * 256), round(kd * 4096), 0, 0))

    def target(self, joint, angle, seconds):
        self.request(TARGETS, struct.pack(">IHh", 1 << joint, round(seconds * 1000), round(angle / UNIT)))


STILL, STILL_S = 0.02, 0.1  # at rest: within 0.02 rad for 0.1 s; a healthy joint trembles by 0.016
NEAR = 0.03  # rad between a joint at rest and its target: dead band and friction
PATIENCE_S = 1.5  # to come to rest, after the motion's duration


def settle(board, targets, seconds, near=NEAR):
    """After a target of that duration, waits until the joints rest near their targets, {joint: rad}.

    One reading is not enough, since a joint may swing through its target. Returns False if they do not rest
    there within PATIENCE_S on the board's clock. (A simulator on a busy machine is slower than real time.)
    """
    begin, _, resting = board.state()
    since = begin
    while True:  # each request also resets the link watchdog
        now, reason, angles = board.state()
        if reason:
            raise ShutDown(reason)
        if any(abs(angles[joint] - resting[joint]) > STILL for joint in targets):
            since, resting = now, angles
        if (now - begin >= seconds and now - since >= STILL_S
                and all(abs(angles[joint] - target) < near for joint, target in targets.items())):
            return True
        if now - begin > seconds + PATIENCE_S:
            return False
        time.sleep(0.02)


def move(board, joint, angle, seconds):
    """Returns True if the joint has come to rest at the angle."""
    board.request(HEARTBEAT, bytes([0, REACTION_HOLD]))  # should this client die, the joint holds
    _, reason, _ = board.state()
    if reason:  # report it before it is cleared
        print(f"the board had shut down: {SHUTDOWNS.get(reason, reason)}")
    board.request(CLEAR)
    if joint < 2:
        # The neck carries nothing: softer than after a reset (16 /rad, 0.09 s/rad), as behaviors
        # have it.
        board.gains([joint], 12, 0.15)
    board.request(ENABLE, struct.pack(">I", 1 << joint))
    _, _, angles = board.state()
    print(f"joint {joint} is on at {angles[joint]:+.3f} rad")
    board.target(joint, angle, seconds)
    arrived = settle(board, {joint: angle}, seconds)
    _, _, angles = board.state()
    if arrived:
        print(f"joint {joint} is at {angles[joint]:+.3f} rad")
    else:
        print(f"joint {joint} has not come to rest at {angle:+.3f} rad within {seconds + PATIENCE_S:.1f} s: "
              f"it is at {angles[joint]:+.3f}", file=sys.stderr)
    return arrived


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", help="serial device, or the pty of `kaz sim --serial`")
    parser.add_argument("--joint", type=int, default=0, choices=range(18), metavar="0..17",
                        help="number of the joint (default: 0, neck_pan)")
    parser.add_argument("--angle", type=float, default=0.3, help="rad (default: 0.3)")
    parser.add_argument("--seconds", type=float, default=1.0, help="duration of the motion (default: 1)")
    options = parser.parse_args()
    if not math.isfinite(options.angle) or abs(options.angle) > 3.2 or not 0 <= options.seconds <= 60:
        parser.error("--angle must be -3.2 to 3.2, --seconds 0 to 60")
    return run("kaz_client.py", lambda: demonstrate(options))


def demonstrate(options):
    board = Board(options.port)
    who = board.identify()
    print(f"a board with {who['joints']} joints, protocol {who['version']}, last reset "
          f"{who['tick'] / 1000:.1f} s ago")
    if who["version"] not in PROTOCOL_VERSIONS:
        raise NoBoard(f"the board has protocol {who['version']}: must be one of {PROTOCOL_VERSIONS}")
    try:
        arrived = move(board, options.joint, options.angle, options.seconds)
        try:
            board.target(options.joint, 3.27, 1)  # beyond every joint's limits
            print("the board accepted a target beyond the limits", file=sys.stderr)
            arrived = False
        except Refusal as refusal:
            print(f"as expected: {refusal}")
    finally:
        if board.off():
            print("all joints are off")
    return 0 if arrived else 1


if __name__ == "__main__":
    sys.exit(main())
