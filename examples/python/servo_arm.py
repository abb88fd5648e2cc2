#!/usr/bin/env python3
# A client of an arm of Feetech's servos, from docs/reference/servo-bus.md; standard library alone.
# SPDX-License-Identifier: Apache-2.0
"""Waves with an arm of six STS3215 on one bus, at 50 Hz, and reads every position back.

examples:
  servo_arm.py /dev/ttyACM0
  kaz sim --bus feetech --robot-file sim/robots/so101/so101.urdf --serial arm &   servo_arm.py arm

At its end, also after Ctrl-C, the torque is off and the arm sinks down: hold it.

exit codes: 0 done, 1 a servo was lost, or did not follow, 2 wrong usage, 3 no port, or no servo that answers,
130 Ctrl-C
"""
import argparse
import math
import os
import select
import sys
import termios
import time
import tty

PING, READ, WRITE, SYNC_READ, SYNC_WRITE, ALL = 0x01, 0x02, 0x03, 0x82, 0x83, 0xFE
TORQUE, ACCELERATION, GOAL, POSITION, VOLTAGE = 40, 41, 42, 56, 62
IDS = (1, 2, 3, 4, 5, 6)
ERRORS = ("voltage", "sensor", "temperature", "current", "angle", "overload")


class Bus:
    """Requests and answers on a port at 1 Mbaud."""

    def __init__(self, path):
        self.port = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self.port)
        settings = termios.tcgetattr(self.port)
        settings[4] = settings[5] = termios.B1000000
        termios.tcsetattr(self.port, termios.TCSANOW, settings)
        self.bad = 0

    def send(self, servo, instruction, parameters):
        body = bytes([servo, len(parameters) + 2, instruction, *parameters])
        termios.tcflush(self.port, termios.TCIFLUSH)
        os.write(self.port, b"\xff\xff" + body + bytes([~sum(body) & 0xFF]))

    def answer(self, servo, count, timeout=0.1):
        """Returns data and error bits of the servo's answer; None if it does not arrive, or is damaged."""
        wanted, got, end = 6 + count, b"", time.monotonic() + timeout
        while len(got) < wanted and select.select([self.port], [], [], max(0, end - time.monotonic()))[0]:
            got += os.read(self.port, wanted - len(got))
        if len(got) < wanted or got[:3] != bytes([0xFF, 0xFF, servo]) or \
                ~sum(got[2:-1]) & 0xFF != got[-1]:
            self.bad += 1
            return None
        return got[5:-1], got[4]

    def request(self, servo, instruction, parameters=(), count=0):
        self.send(servo, instruction, bytes(parameters))
        return self.answer(servo, count)

    def positions(self):
        self.send(ALL, SYNC_READ, bytes([POSITION, 2, *IDS]))
        answers = [self.answer(servo, 2) for servo in IDS]
        return [answer and int.from_bytes(answer[0], "little") for answer in answers]

    def move(self, goals):
        data = b"".join(bytes([servo]) + round(goal).to_bytes(2, "little")
                        for servo, goal in zip(IDS, goals))
        self.send(ALL, SYNC_WRITE, bytes([GOAL, 2]) + data)

    def release(self):
        """Switches the torque off; returns the servos that do not confirm it after five tries."""
        on = list(IDS)
        for _ in range(5):
            for servo in on:
                self.request(servo, WRITE, [TORQUE, 0])
            states = [(servo, self.request(servo, READ, [TORQUE, 1], 1)) for servo in on]
            on = [servo for servo, state in states if state is None or state[0][0] != 0]
        return on


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("port")
    parser.add_argument("--seconds", type=float, default=4)
    options = parser.parse_args()
    try:
        bus = Bus(options.port)
    except (OSError, termios.error) as error:
        print(f"servo_arm.py: {options.port}: {error}", file=sys.stderr)
        return 3
    for servo in IDS:
        found = bus.request(servo, PING)
        if found is None:
            print(f"servo_arm.py: servo {servo} does not answer", file=sys.stderr)
            return 3
        bits = [name for bit, name in enumerate(ERRORS) if found[1] >> bit & 1]
        volts = bus.request(servo, READ, [VOLTAGE, 1], 1)
        print(f"servo {servo}: {volts[0][0] / 10:.1f} V" + (f", error: {', '.join(bits)}" if bits else ""))

    start = bus.positions()
    if None in start:
        return 1
    status = 1
    try:
        status = wave(bus, start, options.seconds)
    except KeyboardInterrupt:
        status = 130
    finally:
        if held := bus.release():
            print(f"servo_arm.py: servos {held} do not confirm that their torque is off: cut the power",
                  file=sys.stderr)
    return 1 if held else status


def wave(bus, start, seconds):
    """Moves gently to the middle, then waves."""
    for servo in IDS:
        bus.request(servo, WRITE, [ACCELERATION, 254])
        bus.request(servo, WRITE, [TORQUE, 1])
    lost, worst, begin = 0, 0, time.monotonic()
    while (now := time.monotonic() - begin) < seconds + 2:
        share = min(1.0, now / 1.5)
        swing = 300 * math.sin(2 * math.pi * 0.5 * (now - 2)) if now > 2 else 0
        goals = [at + share * (2048 - at) for at in start]
        goals[0] += swing
        goals[4] -= swing
        bus.move(goals)
        time.sleep(0.005)
        seen = bus.positions()
        lost += seen.count(None)
        if now > 2 and None not in seen:
            worst = max(worst, abs(seen[0] - goals[0]))
        time.sleep(max(0, begin + now + 0.02 - time.monotonic()))
    print(f"answers lost or damaged: {lost}; the shoulder lagged by up to {worst:.0f} steps")
    return 0 if lost == 0 and worst < 250 else 1


if __name__ == "__main__":
    sys.exit(main())
