#!/usr/bin/env python3
# A client of DYNAMIXEL servos, from docs/reference/servo-bus.md; standard library alone.
# SPDX-License-Identifier: Apache-2.0
"""Nods with every XL330 that answers on a bus, by small motions at 50 Hz, and reads every position back.

examples:
  servo_humanoid.py /dev/ttyUSB0
  kaz sim --bus dynamixel --robot-file sim/robots/mini/mini.urdf --serial mini --suspended &
  servo_humanoid.py mini

exit codes: 0 done, 1 a servo was lost, or did not follow, 2 wrong usage, 3 no port, or no servo that answers
"""
import argparse
import math
import os
import select
import sys
import termios
import time
import tty

PING, READ, WRITE, REBOOT, STATUS = 0x01, 0x02, 0x03, 0x08, 0x55
SYNC_READ, SYNC_WRITE, ALL = 0x82, 0x83, 0xFE
TORQUE, HARDWARE_ERROR, PROFILE_VELOCITY, GOAL, POSITION, VOLTAGE = 64, 70, 112, 116, 132, 144
XL330 = (1200, 1190)
ERRORS = {0: "voltage", 2: "temperature", 3: "encoder", 4: "shock", 5: "overload"}
RATES = {57600: termios.B57600, 115200: termios.B115200, 1000000: termios.B1000000,
         4000000: termios.B4000000}


def crc16(data):
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x8005 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc.to_bytes(2, "little")


def word(number):
    return number.to_bytes(2, "little")


class Bus:
    """Requests and answers on a port."""

    def __init__(self, path, rate):
        self.port = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self.port)
        settings = termios.tcgetattr(self.port)
        settings[4] = settings[5] = RATES[rate]
        termios.tcsetattr(self.port, termios.TCSANOW, settings)
        self.bad = 0

    def send(self, servo, instruction, parameters=b""):
        body = (bytes([instruction]) + parameters).replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
        packet = b"\xff\xff\xfd\x00" + bytes([servo]) + word(len(body) + 2) + body
        termios.tcflush(self.port, termios.TCIFLUSH)
        os.write(self.port, packet + crc16(packet))

    def bytes_until(self, got, wanted, end):
        while len(got) < wanted and select.select([self.port], [], [], max(0, end - time.monotonic()))[0]:
            got += os.read(self.port, wanted - len(got))
        return got

    def answer(self, servo, timeout=0.05):
        """Returns error byte and data of the servo's answer; None if it does not arrive, or is damaged."""
        end = time.monotonic() + timeout
        got = self.bytes_until(b"", 7, end)
        if len(got) == 7:
            got = self.bytes_until(got, 7 + int.from_bytes(got[5:7], "little"), end)
        if len(got) < 11 or got[:5] != b"\xff\xff\xfd\x00" + bytes([servo]) or got[7] != STATUS or \
                crc16(got[:-2]) != got[-2:]:
            return None
        return got[8], got[9:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")

    def request(self, servo, instruction, parameters=b""):
        self.send(servo, instruction, parameters)
        return self.answer(servo)

    def read(self, servo, address, length):
        """Returns None without an answer, or if the answer has an error instead of data."""
        found = self.request(servo, READ, word(address) + word(length))
        if not found or len(found[1]) != length:
            return None
        return int.from_bytes(found[1], "little", signed=length == 4)

    def write(self, servo, address, length, value):
        data = value.to_bytes(length, "little", signed=value < 0)
        return self.request(servo, WRITE, word(address) + data)

    def release(self, servos):
        """Switches the torque off until each servo confirms it. Returns those that do not."""
        for _ in range(5):
            for servo in servos:
                self.write(servo, TORQUE, 1, 0)
            servos = [servo for servo in servos if self.read(servo, TORQUE, 1) != 0]
        return servos

    def positions(self, servos):
        self.send(ALL, SYNC_READ, word(POSITION) + word(4) + bytes(servos))
        found = [self.answer(servo) for servo in servos]
        self.bad += found.count(None)
        return [one and int.from_bytes(one[1], "little", signed=True) for one in found]

    def move(self, goals):
        data = b"".join(bytes([servo]) + round(goal).to_bytes(4, "little", signed=True)
                        for servo, goal in goals.items())
        self.send(ALL, SYNC_WRITE, word(GOAL) + word(4) + data)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("port")
    parser.add_argument("--baud", type=int, default=1000000, choices=sorted(RATES))
    parser.add_argument("--ids", default="1-50", help="ids to look for, FIRST-LAST (default 1-50)")
    parser.add_argument("--seconds", type=float, default=4)
    options = parser.parse_args()
    try:
        first, last = (int(number) for number in options.ids.split("-"))
        bus = Bus(options.port, options.baud)
    except ValueError:
        parser.error(f"--ids {options.ids}: give FIRST-LAST, as in 1-50")
    except (OSError, termios.error) as error:
        print(f"servo_humanoid.py: {options.port}: {error}", file=sys.stderr)
        return 3
    servos = []
    for servo in range(first, last + 1):
        bus.send(servo, PING)
        found = bus.answer(servo, 0.01)
        if found and int.from_bytes(found[1][:2], "little") in XL330:
            servos.append(servo)
    if not servos:
        print(f"servo_humanoid.py: no XL330 with an id of {options.ids} answers", file=sys.stderr)
        return 3
    for servo in servos:
        bits = bus.read(servo, HARDWARE_ERROR, 1) or 0
        if bits:
            names = ", ".join(name for bit, name in ERRORS.items() if bits >> bit & 1)
            print(f"servo {servo}: {names}; rebooted")
            bus.request(servo, REBOOT)
            time.sleep(0.5)
    print(f"{len(servos)} servos, {(bus.read(servos[0], VOLTAGE, 2) or 0) / 10:.1f} V")

    # From where they are, a nod of 5 degrees about it.
    start = bus.positions(servos)
    if None in start:
        return 1
    worst = 0
    try:
        for servo in servos:
            bus.write(servo, PROFILE_VELOCITY, 4, 0)
            bus.write(servo, TORQUE, 1, 1)
        begin = time.monotonic()
        while (now := time.monotonic() - begin) < options.seconds:
            nod = 57 * math.sin(2 * math.pi * 0.5 * now)
            bus.move({servo: at + nod for servo, at in zip(servos, start)})
            time.sleep(0.005)
            seen = bus.positions(servos)
            if None not in seen:
                worst = max(worst, max(abs(one - at - nod) for one, at in zip(seen, start)))
            time.sleep(max(0, begin + now + 0.02 - time.monotonic()))
    finally:  # also after Ctrl-C
        if held := bus.release(servos):
            print(f"servo_humanoid.py: servos {held} do not confirm that their torque is off: cut the power",
                  file=sys.stderr)
    print(f"answers lost or damaged: {bus.bad}; the slowest servo lagged by up to {worst:.0f} pulses")
    return 0 if bus.bad == 0 and worst < 120 and not held else 1


if __name__ == "__main__":
    sys.exit(main())
