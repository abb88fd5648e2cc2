# Writes the seeds of the fuzz targets servo_bus (choices of tools/fuzz/inputs/servo_bus.cpp, a byte each) and
# bus_answers (what a client reads after each request: a length byte, and so many bytes).
# SPDX-License-Identifier: Apache-2.0
"""servo_bus_seeds.py ROOT [--check]: writes the files, or says which differ."""

import pathlib
import sys

FOLDER = "tools/fuzz/inputs/seeds"
STS3215, SCS0009 = 1, 0  # places in feetech::models()
ONE, ALL = 0, 1  # to the servo, or broadcast
# Places in kCodes.
(PING, READ, WRITE, REG_WRITE, ACTION, RESTORE, RESTART, BACKUP, TURNS, MIDDLE, SYNC_READ,
 SYNC_WRITE) = range(12)


def packet(code, parameters=(), to=ONE, steps=1):
    """A valid packet, and then so many milliseconds."""
    return bytes([1, 1, to, code, len(parameters), *parameters, steps])


def raw(data, steps=1):
    return bytes([0, len(data), *data, steps])


def answer(status, parameters=()):
    """What servo 1 answers, as one reading."""
    body = bytes([1, len(parameters) + 2, status, *parameters])
    return reading(b"\xff\xff" + body + bytes([~sum(body) & 0xFF]))


def reading(data):
    return bytes([len(data)]) + data


def block(position, status=0):
    """Position, speed, load, 7.4 V, 30 degrees: registers 56 to 63."""
    return answer(status, [position & 0xFF, position >> 8, 0, 0, 0, 0, 74, 30])


# Ping, model 777, mode 0, acceleration and torque acknowledged.
OPENED = answer(0) + answer(0, [9, 3]) + answer(0, [0]) + answer(0) + answer(0)

ANSWERS = {
    "whole": OPENED + b"".join(block(2000 + i) for i in range(20)),
    "faults": OPENED + block(2048) + block(4095, 32) + reading(b"\xff\xff\x01") + block(0, 63) +
    reading(b"\xff" * 80),
}
SEEDS = {
    # Registers by address: 33 mode, 40 torque switch, 42 goal position, 48 torque limit, 55 lock.
    "modes": bytes([STS3215]) + packet(WRITE, [55, 0]) + packet(WRITE, [33, 3]) + packet(WRITE, [40, 1]) +
    packet(WRITE, [42, 0xFF, 0x7F], steps=7) + packet(BACKUP) + packet(TURNS, steps=0) + packet(MIDDLE),
    "writes": bytes([STS3215]) + packet(WRITE, [5, 7]) + packet(REG_WRITE, [42, 0, 8]) +
    packet(ACTION, to=ALL, steps=7) + packet(RESTORE) + packet(RESTART, steps=7),
    "sync": bytes([STS3215]) + packet(SYNC_WRITE, [42, 2, 1, 0, 4, 2, 0, 8], to=ALL) +
    packet(SYNC_READ, [56, 2, 2, 1], to=ALL) + packet(PING),
    "scs": bytes([SCS0009]) + packet(WRITE, [42, 2, 0]) + packet(READ, [56, 2]) + packet(PING, to=ALL),
    "noise": bytes([STS3215]) + raw([0xFF] * 15) + raw([0xFF, 0xFF, 1, 250, 3, 0]),
}


def main():
    wrong = set()
    for target, seeds in (("servo_bus", SEEDS), ("bus_answers", ANSWERS)):
        folder = pathlib.Path(sys.argv[1]) / FOLDER / target
        wrong |= {f"{target}/{path.name}" for path in folder.iterdir() if path.name not in seeds}
        for name, data in seeds.items():
            path = folder / name
            if "--check" not in sys.argv:
                path.write_bytes(data)
            elif not path.exists() or path.read_bytes() != data:
                wrong.add(f"{target}/{name}")
    if wrong:
        sys.exit(f"{FOLDER}: {', '.join(sorted(wrong))}: not as tools/gen/servo_bus_seeds.py writes it; run "
                 "python3 tools/gen/servo_bus_seeds.py .")


if __name__ == "__main__":
    main()
