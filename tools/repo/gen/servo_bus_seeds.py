# Writes the seeds of the fuzz targets servo_bus (choices of tools/fuzz/inputs/servo_bus.cpp, a byte each) and
# bus_answers (what a client reads after each request: a length byte, and so many bytes).
# SPDX-License-Identifier: Apache-2.0
"""servo_bus_seeds.py ROOT [--check]: writes the files, or says which differ."""

import pathlib
import sys

FOLDER = "tools/fuzz/inputs/seeds"
STS3215, SCS0009, XL330, XL430 = 5, 4, 0, 2  # places in servo_bus::models()
ONE, ALL = 0, 1  # to the servo, or broadcast
# Places in kCodes.
(PING, READ, WRITE, REG_WRITE, ACTION, RESTORE, RESTART, BACKUP, TURNS, MIDDLE, SYNC_READ,
 SYNC_WRITE) = range(12)
# The same of DYNAMIXEL.
(DXL_PING, DXL_READ, DXL_WRITE, DXL_REG_WRITE, DXL_ACTION, DXL_FACTORY, DXL_REBOOT, DXL_CLEAR,
 DXL_BACKUP, DXL_STATUS, DXL_SYNC_READ, DXL_SYNC_WRITE, DXL_FAST, DXL_BULK_READ, DXL_BULK_WRITE,
 DXL_FAST_BULK) = range(16)


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


def crc16(data):
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x8005 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def dxl_answer(error, parameters=()):
    """What DYNAMIXEL 1 answers, as one reading; nothing in it has to be stuffed."""
    body = bytes([0xFF, 0xFF, 0xFD, 0, 1, len(parameters) + 4, 0, 0x55, error, *parameters])
    return reading(body + crc16(body).to_bytes(2, "little"))


def dxl_motion(position, error=0):
    """Registers 124 to 135; then, where they are read, 144 to 146."""
    return dxl_answer(error, [0] * 8 + list(position.to_bytes(4, "little")))


# Ping, model 777, mode 0, acceleration and torque acknowledged.
OPENED = answer(0) + answer(0, [9, 3]) + answer(0, [0]) + answer(0) + answer(0)

# Ping, mode 3, acceleration and torque acknowledged, motion, 5 V and 30 degrees.
DXL_OPENED = dxl_answer(0, [0xB0, 4, 53]) + dxl_answer(0, [3]) + dxl_answer(0) + dxl_answer(0) + \
    dxl_motion(2048) + dxl_answer(0, [50, 0, 30])

ANSWERS = {
    "dynamixel": DXL_OPENED + b"".join(dxl_motion(2000 + i) for i in range(20)),
    "dynamixel_faults": DXL_OPENED + dxl_motion(2000, 0x80) + dxl_answer(0x80, [32]) + dxl_answer(7) +
    reading(b"\xff\xff\xfd") + dxl_motion(4095, 0x85) + reading(b"\xff" * 80),
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
    # 64 torque, 11 mode, 116 goal position, 98 watchdog, 168 indirect address, 224 indirect data.
    "dynamixel": bytes([XL330]) + packet(DXL_WRITE, [11, 0, 4]) + packet(DXL_WRITE, [64, 0, 1]) +
    packet(DXL_WRITE, [116, 0, 0, 32, 0, 0], steps=7) + packet(DXL_WRITE, [98, 0, 1], steps=7) +
    packet(DXL_CLEAR, [1, 0x44, 0x58, 0x4C, 0x22]) + packet(DXL_BACKUP, [1, 0x43, 0x54, 0x52, 0x4C]),
    "dynamixel_groups": bytes([XL430]) + packet(DXL_SYNC_WRITE, [116, 0, 4, 0, 1, 0, 4, 0, 0], to=ALL) +
    packet(DXL_SYNC_READ, [132, 0, 4, 0, 2, 1], to=ALL) + packet(DXL_STATUS, [0], steps=0) +
    packet(DXL_FAST, [132, 0, 4, 0, 1, 2], to=ALL) +
    packet(DXL_FAST_BULK, [2, 132, 0, 4, 0, 1, 0, 0, 2, 0], to=ALL) +
    packet(DXL_BULK_READ, [1, 132, 0, 4, 0], to=ALL) + packet(DXL_BULK_WRITE, [1, 65, 0, 1, 0, 1], to=ALL) +
    packet(DXL_PING, to=ALL),
    "dynamixel_memory": bytes([XL330]) + packet(DXL_WRITE, [168, 0, 112, 0]) +
    packet(DXL_WRITE, [224, 0, 1]) + packet(DXL_READ, [224, 0, 2, 0]) +
    packet(DXL_REG_WRITE, [65, 0, 1]) + packet(DXL_ACTION) +
    packet(DXL_FACTORY, [2]) + packet(DXL_REBOOT, steps=7) + raw([0xFF, 0xFF, 0xFD, 0, 1, 9, 0, 3]),
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
        sys.exit(f"{FOLDER}: {', '.join(sorted(wrong))}: not as servo_bus_seeds.py writes it; run "
                 "python3 tools/repo/gen/servo_bus_seeds.py .")


if __name__ == "__main__":
    main()
