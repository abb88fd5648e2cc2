# Something unplugged while the head follows a ball, and plugged in again.
# SPDX-License-Identifier: Apache-2.0
import re
import time

import machine
from robot_guest import (ADAPTER, can_up, in_guest, link_of, result_of)

WATCHDOG_MS = 100  # at most, from the last byte that the board has heard
HEAD = ("| track-ball, meanwhile | over | the board is to | times | reaction after at most, ms | "
        "went on |\n|---|---|---|---|---|---|")


class Loss:
    """`found`: what `kaz doctor` has to report of it before, (subject, part of the text). `away_s`: for how
    long it is taken away, `back_s`: until it works again, both by the robot's time. `board`: whether the
    board loses its host, else it is the eyes. `in_one_run`: how many at most."""

    def __init__(self, link, what, found, take, give, away_s, back_s, board=True, in_one_run=20):
        self.link, self.what, self.found, self.take, self.give = link, what, found, take, give
        self.away_s, self.back_s, self.board, self.in_one_run = away_s, back_s, board, in_one_run


LOSSES = [
    Loss("usb", "USB adapter unplugged", ("/dev/ttyUSB0", "USB adapter 0403:6001"),
         lambda guest: guest.machine.qmp("device_del", id="adapter"),
         lambda guest: guest.machine.qmp("device_add", **ADAPTER), 1, 1,
         in_one_run=4),  # QEMU itself crashes in one of ten
    Loss("can", "CAN interface taken down", ("can0", "1000000 bit/s, ERROR-ACTIVE"),
         lambda guest: guest.run("ip link set can0 down"),
         lambda guest: guest.run(can_up("can0")[0]), 1, 0.5),
    # A camera counts as lost only 2 s after its last picture.
    Loss("uart", "eyes unplugged", ("/dev/video0", "in use by process"),
         lambda guest: guest.run("kill -USR1 $(cat /mnt/eyes.pid)"),
         lambda guest: guest.run("kill -USR1 $(cat /mnt/eyes.pid)"), 2.6, 1, board=False),
]
# What the simulator prints when the board's link watchdog has expired.
REACTIONS = {"hold": r"(\d+) ms after the host's last byte, the link watchdog began to hold",
             "limp": r"motors off at .*? no request came for too long, (\d+) ms after the host's last byte"}


def await_true(what, true, patience_s=1500):
    end = time.monotonic() + patience_s
    while not true():
        if time.monotonic() > end:
            raise RuntimeError(f"in {patience_s} s not: {what}")
        time.sleep(0.05)


def doctor(options, guest):
    """Findings of `kaz doctor` in the machine, as (subject, text)."""
    _, text = guest.run(f"{options.kaz} doctor --json", check=False)
    return [(one.get("subject"), one["text"]) for one in result_of(text).get("findings", [])]


def loss_row(options, loss, times, reaction="hold"):
    """The table's row, and what is wrong with it, as sentences. Runs in which QEMU crashes are run again."""
    lines, wrong, reacted, went_on, crashes = [], [], [], 0, 0
    left = times
    while left > 0:
        count = min(left, loss.in_one_run)
        try:
            delays, returns, faults = run_losses(options, loss, count, reaction)
        except machine.Crashed as crash:
            crashes += 1
            if crashes > 3 + times:
                raise
            lines.append(f"   {loss.what}: {crash}; {count} losses run again")
            continue
        left -= count
        reacted += delays
        went_on += returns
        wrong += faults
    lines.append(f"| {loss.what} | {loss.link} | {reaction if loss.board else 'go on'} | {times} | "
                 f"{max(reacted, default='-')} | {went_on} |")
    return lines, wrong


def run_losses(options, loss, times, reaction):
    """So many in one run: (the board's reactions, ms; how often it went on; what is wrong, as sentences)."""
    link, wrong = link_of(loss.link), []
    folder = options.out / f"loss-{link.name}-{reaction}"
    messages = folder / "run.txt"
    lost, back = "the robot stands still until the cameras are back", "the cameras are back, after "
    if loss.board:
        lost, back = "the link was lost; retrying for up to 20 s: ", "the link is back after "

    def reports(words):
        return messages.read_text().count(words) if messages.exists() else 0

    def before(guest):
        messages.unlink(missing_ok=True)
        findings = doctor(options, guest)
        if not any(subject == loss.found[0] and loss.found[1] in text for subject, text in findings):
            wrong.append(f"{loss.what}: kaz doctor does not report {loss.found}: {findings}")

    def during(robot, guest):
        await_true("motors on; the run printed " + str(messages), robot.motors)
        robot.wait_until(robot.now() + 0.7)
        for number in range(times):
            loss.take(guest)
            gone = robot.now()
            robot.wait_until(gone + loss.away_s)
            if robot.motors() != (reaction == "hold"):
                wrong.append(f"{loss.what}: the motors are {'on' if robot.motors() else 'off'}")
            # Now, not when it is back.
            if reports(lost) != number + 1 or reports(back) != number:
                wrong.append(f"{loss.what}: away for {loss.away_s} s, and it is not reported:\n"
                             f"{messages.read_text()}")
                return
            loss.give(guest)
            given = robot.now()
            await_true(f"{loss.what}: time passes", lambda: reports(back) > number or
                       robot.now() > given + 20)
            if reports(back) != number + 1:
                wrong.append(f"{loss.what}: given back, and it did not go on:\n{messages.read_text()}")
                return
            robot.wait_until(robot.now() + 0.5)

    seconds = 1.5 + times * (loss.away_s + loss.back_s + 0.5)
    # Without motors a robot that stands would fall.
    world = ["--suspended"] if reaction == "limp" else []
    result, printed = in_guest(options, folder, link, "track-ball", 1, seconds, during, before, world,
                               f"--reconnect 20 --when-lost {reaction}")
    reacted = [int(ms) for ms in re.findall(REACTIONS[reaction], printed)]
    if loss.board and (len(reacted) != times or max(reacted, default=999) > WATCHDOG_MS):
        wrong.append(f"{loss.what}: {times} times, and the board's reaction ({reaction}) came after "
                     f"{reacted} ms:\n{printed}")
    if not loss.board and reacted:
        wrong.append(f"{loss.what}: the board heard nothing for its watchdog's time: {reacted}")
    went_on = reports(back)
    if reports(lost) != times or went_on != times:
        wrong.append(f"{loss.what}: {times} times, and {reports(lost)} reports of it and {went_on} of the "
                     f"return:\n{result['messages']}")
    # Whether the ball was in the middle often enough is not the question: it was away for seconds.
    if "link" not in result:
        wrong.append(f"{loss.what}: the run did not end well: {result['sentence']}")
    return reacted, went_on, wrong
