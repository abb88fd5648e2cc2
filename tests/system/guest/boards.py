# Two boards on one CAN bus: they drive one robot's joints, and each conforms.
# SPDX-License-Identifier: Apache-2.0
import json

from robot_guest import (AWAIT_USB, ISOTP, UART, USB_MODULES, Guest, Link, Robot, bridge, can_bus,
                         can_up, usb_adapter)

UPPER = ["neck_pan", "neck_tilt", "l_sh_pitch", "l_sh_roll", "l_elbow", "l_hand", "r_sh_pitch", "r_sh_roll",
         "r_elbow", "r_hand"]
LOWER = ["l_hip_roll", "l_hip_pitch", "l_knee", "l_ankle_pitch", "r_hip_roll", "r_hip_pitch", "r_knee",
         "r_ankle_pitch"]
PORTS = {1: ("can1", "/dev/ttyS1"), 2: ("can2", "/dev/ttyUSB0")}
# A board on a UART and one on a USB adapter, each with its bridge and controller; the host has the third.
BUS = Link("boards", "", "can:can0", [*UART, *usb_adapter("board1"), *can_bus(3)],
           [("kvaser_pci", ""), *USB_MODULES, *ISOTP],
           [AWAIT_USB, *can_up("can0", "can1", "can2"),
            "{kaz} recover /dev/ttyUSB0 --address 2 >/mnt/recover.txt 2>&1",
            bridge(*PORTS[1], 1), bridge(*PORTS[2], 2)])
# A case or two of each chapter, for tests; all of them take minutes.
SHORT = ("^(frame.(noise|bad-check$|slow-bytes|damaged-then-whole)|address.(own|all-done)|"
         "request.repeated-not|identity.identify|motion.target-reached|safety.(stop$|supply-low)|"
         "watchdog.hold$)")
# What cannot be on a bus, by the report's words.
CANNOT_CROSS = "pauses between bytes", "a bench"


def conformance(options, guest, folder, address, short):
    """Lines and faults. The other board's bridge is away: the suite disturbs every board on its line."""
    name = f"conformance{address}"
    only = f" --filter '{SHORT}'" if short else ""
    code, printed = guest.run(f"{options.kaz} conformance --robot can:can0 --address {address} --allow-motion"
                              f"{only} --json /mnt/{name}.json >/mnt/{name}.txt 2>&1; e=$?; "
                              f"tail -n 3 /mnt/{name}.txt; exit $e", check=False)
    if not (folder / f"{name}.json").exists():
        return [], [f"conformance of board {address}: {printed}"]
    report = json.loads((folder / f"{name}.json").read_text())
    left_out = {one["id"]: one["message"] for one in report["results"] if one["verdict"] == "left out"}
    crossing = [id for id, why in left_out.items() if any(words in why for words in CANNOT_CROSS)]
    lines = [f"conformance of board {address} over CAN: {report['passed']} passed, {report['failed']} "
             f"failed, {len(left_out)} left out; left out because it cannot cross a bus, or needs a bench: "
             f"{', '.join(crossing)}"]
    others = sorted(set(left_out) - set(crossing))
    if others:
        lines.append(f"   left out for other reasons: {', '.join(f'{id} ({left_out[id]})' for id in others)}")
    wrong = []
    if code != 0 or report["failed"] or report["passed"] < (8 if short else 100):
        wrong.append(f"conformance of board {address} ended with {code}:\n"
                     + (folder / f"{name}.txt").read_text()[-8000:])
    if not any("slow-bytes" in id for id in crossing):
        wrong.append(f"conformance of board {address}: pauses between bytes were not left out: {left_out}")
    return lines, wrong


def two_boards(options, short):
    folder = options.out / "boards"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "boards.json").write_text(json.dumps(
        {"boards": [{"port": "can:can0", "address": 1, "joints": UPPER},
                    {"port": "can:can0", "address": 2, "joints": LOWER}]}))
    lines, wrong = [], []
    world = ["--mcu", "native", "--suspended"]
    with (Robot(options.kaz, folder / "upper", world, eyes=False) as upper,
          Robot(options.kaz, folder / "lower", world, eyes=False) as lower,
          Guest(options, folder, [upper, lower], BUS) as guest):
        code, printed = guest.run(f"{options.kaz} run stand --robot boards:/mnt/boards.json --json"
                                  " 2>/mnt/stand.txt", check=False)
        both = [robot.printed().count("motors on") for robot in (upper, lower)]
        lines.append(f"stand by two boards on one CAN bus: ended with {code}; motors on: {both[0]} and "
                     f"{both[1]} times")
        if code != 0 or 0 in both:
            wrong.append(f"stand by two boards: {printed}\n{(folder / 'stand.txt').read_text()}")
        for address, away in ((1, 2), (2, 1)):
            guest.run(f"kill $(cat /mnt/bridge{away}.pid)")
            if address == 2:
                guest.run(bridge(*PORTS[2], 2).format(kaz=options.kaz))
            found, faults = conformance(options, guest, folder, address, short)
            lines += found
            wrong += faults
    return lines, wrong
