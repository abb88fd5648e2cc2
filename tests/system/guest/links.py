# The behaviours' own program against the emulated board, over each kind of link and the kernel's video.
# SPDX-License-Identifier: Apache-2.0
"""One table. The virtual robot runs outside of the virtual machine and follows its clock; in the machine the
same executable as outside is the host, with the kernel's drivers below it. Exit status: 0 passed, 1 failed,
77 something is missing (it says what).

The machine's clock counts instructions (QEMU's -icount): one nanosecond each, and none while it waits. So
neither the emulated processor's slowness nor a busy machine outside makes the host late, and the board's
watchdog keeps its 90 ms. The world outside goes on only to times that the machine has sent (`kaz sim
--clock`), and the machine waits where the world has not come to the last one."""

import argparse
import contextlib
import hashlib
import json
import pathlib
import re
import socket
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine  # noqa: E402

EYES = "v4l2:/dev/video0,/dev/video1,fps=30"
LOOPBACK = (machine.LOOPBACK, "devices=2 video_nr=0,1 exclusive_caps=1,1 max_buffers=2")
# By the machine's clock; what is waited for outside is longer on a slow machine.
PATIENCE_S = 1500


class Link:
    """`devices`: QEMU's, with the board's line as the character device `board`. `before`: commands in the
    machine that make the link. `robot`: as for --robot there."""

    def __init__(self, name, what, robot, devices=("-serial", "chardev:board"), modules=(), before=()):
        self.name, self.what, self.robot = name, what, robot
        self.devices, self.modules, self.before = devices, modules, before


# A serial number of its own: QEMU would make one out of the socket, another one after replugging.
ADAPTER = {"driver": "usb-serial", "bus": "usb.0", "id": "adapter", "serial": "KAZ0001", "chardev": "board"}
USB = ["-device", "qemu-xhci,id=usb",
       "-device", ",".join([ADAPTER["driver"], *(f"{key}={value}" for key, value in ADAPTER.items()
                                                 if key != "driver")])]
ISOTP = [("can_raw", ""), ("can_isotp", "")]
CAN_PAIR = ["-object", "can-bus,id=bus", *(2 * ["-device", "kvaser_pci,canbus=bus"])]
UART = ["-serial", "chardev:board"]


def bridge(interface):
    """The board's end of a bus: `kaz can-bridge` on its UART."""
    return ("{kaz} can-bridge --port /dev/ttyS1 --can " + interface +
            " >/mnt/bridge.txt 2>&1 & sleep 1; cat /mnt/bridge.txt")


def up(interface, kind=""):
    # The kernel reports a new carrier as running within a second.
    return f"ip link set {interface} up{kind} && sleep 1.5"


LINKS = [
    Link("uart", "16550 UART (8250 driver)", "serial:/dev/ttyS1"),
    Link("usb", "USB serial adapter (ftdi_sio on xHCI)", "serial:/dev/ttyUSB0", USB,
         [("xhci_pci", ""), ("ftdi_sio", "")],
         ["for i in 1 2 3 4 5 6; do [ -e /dev/ttyUSB0 ] || sleep 1; done"]),
    Link("vcan", "virtual CAN bus, ISO-TP, bridge to the UART", "can:vcan0", UART, [("vcan", ""), *ISOTP],
         ["ip link add vcan0 type vcan", up("vcan0"), bridge("vcan0")]),
    Link("can", "two Kvaser controllers (SJA1000) on one bus, ISO-TP, bridge", "can:can0", [*UART, *CAN_PAIR],
         [("kvaser_pci", ""), *ISOTP],
         [up(name, " txqueuelen 128 type can bitrate 1000000 restart-ms 100") for name in ("can0", "can1")] +
         [bridge("can1")]),
    Link("slcan", "two adapters of serial text (slcan) over joined ptys, ISO-TP, bridge", "can:can0", UART,
         [("slcan", ""), *ISOTP],
         ["{feed} slcan >/mnt/slcan.txt 2>&1 & sleep 1; cat /mnt/slcan.txt",
          *(up(name, " txqueuelen 128") for name in ("can0", "can1")), bridge("can1")]),
    Link("tcp", "TCP to socat on the UART", "tcp:127.0.0.1:2000",
         before=["socat TCP-LISTEN:2000,reuseaddr,fork,nodelay FILE:/dev/ttyS1,raw,echo=0,b115200 "
                 "2>/mnt/socat.txt & sleep 1"]),
]


class Robot:
    """`kaz sim`, its sockets and its line, for one run."""

    def __init__(self, kaz, folder, arguments, clock):
        self.folder = folder.resolve()
        for name in ("board", "board.ctl", "eyes", "clock"):
            with contextlib.suppress(FileNotFoundError):
                (self.folder / name).unlink()
        self.log = self.folder / "robot.txt"
        command = [kaz, "sim", "--serial", "board", "--cameras", "eyes", "--eyes", "ideal", *arguments]
        command += ["--clock", "clock"] if clock else []
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen(command, cwd=self.folder, stdout=log, stderr=log,
                                            preexec_fn=machine.die_with_parent)
        end = time.monotonic() + 120
        while "ready: " not in self.printed():
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"{' '.join(map(str, command))} did not start:\n{self.printed()}")
            time.sleep(0.05)

    def printed(self):
        return self.log.read_text(encoding="utf-8")

    def command(self, line):
        with contextlib.closing(socket.socket(socket.AF_UNIX)) as control:
            control.connect(str(self.folder / "board.ctl"))
            control.sendall(line.encode() + b"\n")
            return json.loads(control.makefile().readline())

    def wait_until(self, at_s, patience_s=600):
        """By the robot's time."""
        end = time.monotonic() + patience_s
        while (now := self.command("status")["time_s"]) < at_s:
            if time.monotonic() > end:
                raise RuntimeError(f"the robot's time stands still at {now} s")
            time.sleep(0.02)
        return now

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Guest:
    """A virtual machine that the robot follows, with the robot's eyes as its video devices."""

    def __init__(self, options, folder, robot, link):
        # Its socket holds about one message: the machine waits until the robot has come to that time.
        clock = socket.socket(socket.AF_UNIX)
        clock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1)
        clock.connect(str(robot.folder / "clock"))
        line = (robot.folder / "board").resolve()
        devices = [
            *machine.COUNTED,
            "-chardev", f"socket,id=clock,fd={clock.fileno()}",
            "-device", "isa-debugcon,iobase=0xe9,chardev=clock",
            "-device", "virtio-serial-pci,id=ports",
            "-chardev", f"socket,id=eyes,path={robot.folder}/eyes",
            "-device", "virtserialport,bus=ports.0,nr=2,chardev=eyes",
            "-chardev", f"serial,id=board,path={line}", *link.devices]
        with clock:
            self.machine = machine.Machine(options.bin / "guest_init", options.kernel, folder,
                                           [LOOPBACK, *link.modules], devices, files=[clock.fileno()],
                                           patience_s=300)
        try:
            self.prepare(options, link)
        except BaseException:
            self.machine.stop()
            raise

    def prepare(self, options, link):
        self.run = self.machine.run
        feed = options.bin / "guest_feed"
        self.run(f"{feed} clock >/mnt/clock.txt 2>&1 &")
        self.run(f"{feed} eyes $(ls /dev/vport*p2) /dev/video0 /dev/video1 >/mnt/eyes.txt 2>&1 &"
                 " echo $! >/mnt/eyes.pid; sleep 0.5; cat /mnt/eyes.txt")
        self.run("ip link set lo up")
        for command in link.before:
            self.run(command.format(kaz=options.kaz, feed=feed), PATIENCE_S)

    def __enter__(self):
        self.machine.__enter__()
        return self

    def __exit__(self, *arguments):
        self.machine.__exit__(*arguments)


BEHAVIORS = {
    "track-ball": ("track-ball --duration {seconds}", []),
    "catch-ball": ("catch-ball", ["--world", "catch", "--imu"]),
}


def command_of(behavior, seed, seconds):
    return f"{BEHAVIORS[behavior][0].format(seconds=seconds)} --seed {seed} --json"


def result_of(text):
    """The JSON object in what `kaz run --json` printed, or an error of the same form."""
    found = re.search(r"^\{$.*?^\}$", text, re.M | re.S)
    return json.loads(found.group(0)) if found else {"outcome": "failed", "sentence": text.strip()[-400:]}


def in_guest(options, link, behavior, seed, during=None, before=None):
    """One run over a link in the machine: (result, what the robot's simulator printed)."""
    folder = options.out / link.name
    folder.mkdir(parents=True, exist_ok=True)
    world = [*BEHAVIORS[behavior][1], "--seed", str(seed)]
    with Robot(options.kaz, folder, world, True) as robot, Guest(options, folder, robot, link) as guest:
        if (inside := guest.run(f"sha256sum {options.kaz}", 300)[1].split()[0]) != options.hash:
            raise RuntimeError(f"the machine runs another program: {inside}")
        if before:
            before(guest)
        command = (f"{options.kaz} run {command_of(behavior, seed, options.seconds)} --robot {link.robot} "
                   # A plug that comes back is found by the kernel only after seconds of this machine.
                   f"--reconnect 20 --camera {EYES} --calibration {options.calibration} "
                   ">/mnt/result.json 2>/mnt/run.txt")
        if during is None:
            guest.run(command, PATIENCE_S, check=False)
        else:
            guest.run(command + " & echo $! >/mnt/run.pid")
            during(robot, guest)
            guest.run("while kill -0 $(cat /mnt/run.pid) 2>/dev/null; do sleep 0.2; done", PATIENCE_S)
        printed = robot.printed()
    result = result_of((folder / "result.json").read_text())
    if result["outcome"] == "failed" and not result.get("sentence"):
        result["sentence"] = (folder / "run.txt").read_text()[-400:]
    result["messages"] = (folder / "run.txt").read_text()
    return result, printed


def outside(options, name, behavior, seed):
    """The same in lockstep, or over a pty in real time, without the machine."""
    folder = options.out / name
    folder.mkdir(parents=True, exist_ok=True)
    world = BEHAVIORS[behavior][1]
    command = [options.kaz, "run", *command_of(behavior, seed, options.seconds).split()]
    with contextlib.ExitStack() as stack:
        if name == "lockstep":
            command += [*world, "--eyes", "ideal"]
        else:
            stack.enter_context(Robot(options.kaz, folder, [*world, "--seed", str(seed)], False))
            command += ["--robot", "serial:board", "--camera", "eyes"]
        ran = subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=PATIENCE_S)
    result = result_of(ran.stdout)
    result.setdefault("sentence", ran.stderr[-400:])
    return result


def row(name, what, results):
    good = sum(result["outcome"] == "done" for result in results)
    trips = [1e3 * result["link"]["round_trip_mean_s"] for result in results if "link" in result]
    ages = [result["vision"]["color"]["age_ms"]["median"] for result in results
            if result.get("vision", {}).get("color")]
    retries = sum(result.get("link", {}).get("retries", 0) for result in results)
    mean = lambda values: f"{sum(values) / len(values):.1f}" if values else "-"  # noqa: E731
    return f"| {name} | {what} | {good} of {len(results)} | {mean(trips)} | {retries} | {mean(ages)} |"


class Loss:
    """Something taken away for a second while the head follows the ball, and given back. `found`: what `kaz
    doctor` has to report of it before, (subject, part of the text)."""

    def __init__(self, link, what, found, take, give, board=True):
        self.link, self.what, self.found, self.take, self.give = link, what, found, take, give
        self.board = board


LOSSES = [
    Loss("usb", "USB adapter unplugged", ("/dev/ttyUSB0", "USB adapter 0403:6001"),
         lambda guest: guest.machine.qmp("device_del", id="adapter"),
         lambda guest: guest.machine.qmp("device_add", **ADAPTER)),
    Loss("can", "CAN interface taken down", ("can0", "1000000 bit/s, ERROR-ACTIVE"),
         lambda guest: guest.run("ip link set can0 down"),
         lambda guest: guest.run(up("can0"))),
    Loss("uart", "eyes unplugged", ("/dev/video0", "in use by process"),
         lambda guest: guest.run("kill -USR1 $(cat /mnt/eyes.pid)"),
         lambda guest: guest.run("kill -USR1 $(cat /mnt/eyes.pid)"), board=False),
]


def doctor(options, guest):
    """Findings of `kaz doctor` in the machine, as (subject, text)."""
    _, text = guest.run(f"{options.kaz} doctor --json", PATIENCE_S, check=False)
    return [(one.get("subject"), one["text"]) for one in result_of(text).get("findings", [])]


def loss_row(options, loss, times):
    """The table's row, and what is wrong with it, as sentences."""
    link = next(link for link in LINKS if link.name == loss.link)
    delays, wrong = [], []
    # A camera counts as lost only 2 s after its last picture.
    away_s = 1 if loss.board else 3.5

    def before(guest):
        findings = doctor(options, guest)
        if not any(subject == loss.found[0] and loss.found[1] in text for subject, text in findings):
            wrong.append(f"{loss.what}: kaz doctor does not report {loss.found}: {findings}")

    def during(robot, guest):
        end = time.monotonic() + 600
        while not robot.command("status")["motors"]:
            if time.monotonic() > end:
                raise RuntimeError("the motors are never on: " + guest.run("cat /mnt/run.txt")[1])
            time.sleep(0.05)
        began = robot.command("status")["time_s"] + 1
        for number in range(times):
            robot.wait_until(began + number * (away_s + 2.5))
            loss.take(guest)
            gone = robot.command("status")["time_s"]
            robot.wait_until(gone + away_s)
            if not robot.command("status")["motors"]:
                wrong.append(f"{loss.what}: the motors are off")
            loss.give(guest)

    seconds, options.seconds = options.seconds, 3 + times * (away_s + 2.5)
    result, printed = in_guest(options, link, "track-ball", 1, during, before)
    options.seconds = seconds
    delays = [int(ms) for ms in re.findall(r"joints held at .*? (\d+) ms after", printed)]
    messages = [line for line in result["messages"].splitlines() if "kaz run: " in line]
    back = [line for line in messages if "it answered again" in line or "are back" in line]
    if loss.board and (len(delays) != times or max(delays, default=999) > 100):
        wrong.append(f"{loss.what}: {times} times, and the board held its joints after {delays} ms")
    if not loss.board and delays:
        wrong.append(f"{loss.what}: the board heard nothing for its watchdog's time: {delays}")
    if len(back) != times:
        wrong.append(f"{loss.what}: {times} times, and {len(back)} reports of a return:\n"
                     f"{result['messages']}")
    # Whether the ball was in the middle often enough is not the question: it was away for seconds.
    if "link" not in result:
        wrong.append(f"{loss.what}: the run did not go on: {result['sentence']}")
    print(f"| {loss.what} | {link.name} | {times} | {max(delays, default='-')} | {len(back)} |", flush=True)
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True,
                        help="folder with kaz, guest_init, guest_feed")
    parser.add_argument("--kernels", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--fetch", action="store_true", help="get a kernel if there is none")
    parser.add_argument("--short", action="store_true",
                        help="only losses, one each: UART, USB, CAN and video within two minutes")
    parser.add_argument("--runs", type=int, default=10, help="of each behaviour over each link")
    parser.add_argument("--losses", type=int, default=20, help="of the link or the eyes in one run")
    parser.add_argument("--only", default="", help="names of links, separated by commas")
    parser.add_argument("--behaviors", default="track-ball,catch-ball")
    parser.add_argument("--seconds", type=float, default=6, help="that the head follows the ball")
    options = parser.parse_args()
    if options.fetch:
        machine.fetch(options.kernels)
    try:
        options.kernel = machine.kernel(options.kernels)
    except machine.Missing as missing:
        print(f"SKIPPED: not tested over real drivers (UART, USB, CAN, TCP, V4L2): {missing}; "
              "`./tools/dev guest` gets it")
        return 77
    options.bin = options.bin.resolve()
    options.kaz = options.bin / "kaz"
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    options.calibration = options.out / "eyes.yml"
    subprocess.run([options.kaz, "sim", "--eyes", "ideal", "--write-calibration", options.calibration],
                   check=True, stdout=subprocess.DEVNULL)
    options.hash = hashlib.sha256(options.kaz.read_bytes()).hexdigest()
    print(f"kaz: sha256 {options.hash}, the same file outside and in the machine\n"
          f"kernel: {options.kernel.name}")
    only = [name for name in options.only.split(",") if name]
    behaviors = [] if options.short else [name for name in options.behaviors.split(",") if name]
    runs, enough = options.runs, -(-9 * options.runs // 10)  # 9 of 10
    if options.short:
        options.losses = 1
    bad = 0
    names = [("lockstep", "in one process"), ("pty", "in real time, two processes"),
             *((link.name, link.what) for link in LINKS)]
    for behavior in behaviors:
        print(f"\n| {behavior} over | what it is | done | round trip, ms | repeated requests | "
              "age of pictures, ms |\n|---|---|---|---|---|---|", flush=True)
        for name, what in names:
            if only and name not in only:
                continue
            results, began = [], time.monotonic()
            link = next((link for link in LINKS if link.name == name), None)
            for seed in range(1, runs + 1):
                if link:
                    result, _ = in_guest(options, link, behavior, seed)
                else:
                    result = outside(options, name, behavior, seed)
                results.append(result)
                if result["outcome"] != "done":
                    print(f"   {name}, seed {seed}: {result['sentence']}", file=sys.stderr, flush=True)
            print(row(name, what, results), flush=True)
            print(f"   {name}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
            bad += sum(result["outcome"] == "done" for result in results) < enough
    losses = [loss for loss in LOSSES if not only or loss.link in only]
    if losses and options.losses:
        print("\n| track-ball, meanwhile | over | times | joints held after at most, ms | went on |\n"
              "|---|---|---|---|---|", flush=True)
    for loss in losses if options.losses else []:
        began = time.monotonic()
        wrong = loss_row(options, loss, options.losses)
        for sentence in wrong:
            print(f"   {sentence}", file=sys.stderr, flush=True)
        print(f"   {loss.what}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
        bad += bool(wrong)
    print(f"\n{'passed' if bad == 0 else f'{bad} rows failed'}")
    return 0 if bad == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
