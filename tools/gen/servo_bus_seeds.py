# Writes the seeds of the fuzz target servo_bus: choices of tools/fuzz/inputs/servo_bus.cpp, a byte each.
# SPDX-License-Identifier: Apache-2.0
"""servo_bus_seeds.py ROOT [--check]: writes the files, or says which differ."""

import pathlib
import sys

FOLDER = "tools/fuzz/inputs/seeds/servo_bus"
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
    folder = pathlib.Path(sys.argv[1]) / FOLDER
    wrong = {path.name for path in folder.iterdir()} - set(SEEDS)
    for name, data in SEEDS.items():
        path = folder / name
        if "--check" not in sys.argv:
            path.write_bytes(data)
        elif not path.exists() or path.read_bytes() != data:
            wrong.add(name)
    if wrong:
        sys.exit(f"{FOLDER}: {', '.join(sorted(wrong))}: not as tools/gen/servo_bus_seeds.py writes it; run "
                 "python3 tools/gen/servo_bus_seeds.py .")


if __name__ == "__main__":
    main()
