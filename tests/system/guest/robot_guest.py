# The virtual robot outside, the virtual machine that it follows, and the links between the two.
# SPDX-License-Identifier: Apache-2.0
"""The machine's clock counts instructions (QEMU's -icount): one nanosecond each, and none while it waits. So
neither the emulated processor's slowness nor a busy machine outside makes the host late, and the board's
watchdog keeps its 90 ms. The world outside goes on only to times that the machine has sent (`kaz sim
--clock`), and the machine waits where the world has not come to the last one."""

import contextlib
import json
import re
import socket
import subprocess
import time

import machine

EYES = "v4l2:/dev/video0,/dev/video1,fps=30"
LOOPBACK = (machine.LOOPBACK, "devices=2 video_nr=0,1 exclusive_caps=1,1 max_buffers=2")


class Link:
    """`devices`: QEMU's, with the boards' lines as the character devices `board0`, `board1`. `before`:
    commands in the machine that make the link. `robot`: as for --robot there."""

    def __init__(self, name, what, robot, devices=("-serial", "chardev:board0"), modules=(), before=()):
        self.name, self.what, self.robot = name, what, robot
        self.devices, self.modules, self.before = devices, modules, before


# A serial number of its own: QEMU would make one out of the socket, another one after replugging.
ADAPTER = {"driver": "usb-serial", "bus": "usb.0", "id": "adapter", "serial": "KAZ0001", "chardev": "board0"}


def usb_adapter(chardev):
    return ["-device", "qemu-xhci,id=usb",
            "-device", ",".join([ADAPTER["driver"], *(f"{key}={value}" for key, value in
                                                      {**ADAPTER, "chardev": chardev}.items()
                                                      if key != "driver")])]


USB_MODULES = [("xhci_pci", ""), ("ftdi_sio", "")]
AWAIT_USB = "for i in 1 2 3 4 5 6; do [ -e /dev/ttyUSB0 ] || sleep 1; done"
ISOTP = [("can_raw", ""), ("can_isotp", "")]
UART = ["-serial", "chardev:board0"]


def can_bus(controllers):
    return ["-object", "can-bus,id=bus", *(controllers * ["-device", "kvaser_pci,canbus=bus"])]


def bridge(interface, port="/dev/ttyS1", address=1):
    """The board's end of a bus: `kaz can-bridge` on its line."""
    return (f"{{kaz}} can-bridge --port {port} --can {interface} --address {address}"
            f" >/mnt/bridge{address}.txt 2>&1 & echo $! >/mnt/bridge{address}.pid;"
            f" for i in 1 2 3 4 5 6; do grep -q ready: /mnt/bridge{address}.txt || sleep 0.5; done;"
            f" cat /mnt/bridge{address}.txt")


def up(interface, kind=""):
    return f"ip link set {interface} up{kind}"


def can_up(*names):
    return [up(name, " txqueuelen 128 type can bitrate 1000000 restart-ms 100") for name in names]


LINKS = [
    Link("uart", "16550 UART (8250 driver)", "serial:/dev/ttyS1"),
    Link("usb", "USB serial adapter (ftdi_sio on xHCI)", "serial:/dev/ttyUSB0", usb_adapter("board0"),
         USB_MODULES, [AWAIT_USB]),
    Link("vcan", "virtual CAN bus, ISO-TP, bridge to the UART", "can:vcan0", UART, [("vcan", ""), *ISOTP],
         ["ip link add vcan0 type vcan", up("vcan0"), bridge("vcan0")]),
    Link("can", "two Kvaser controllers (SJA1000) on one bus, ISO-TP, bridge", "can:can0",
         [*UART, *can_bus(2)], [("kvaser_pci", ""), *ISOTP], [*can_up("can0", "can1"), bridge("can1")]),
    Link("slcan", "two adapters of serial text (slcan) over joined ptys, ISO-TP, bridge", "can:can0", UART,
         [("slcan", ""), *ISOTP],
         ["{feed} slcan >/mnt/slcan.txt 2>&1 & sleep 1; cat /mnt/slcan.txt",
          *(up(name, " txqueuelen 128") for name in ("can0", "can1")), bridge("can1")]),
    Link("tcp", "TCP to socat on the UART", "tcp:127.0.0.1:2000",
         before=["socat TCP-LISTEN:2000,reuseaddr,fork,nodelay FILE:/dev/ttyS1,raw,echo=0,b115200 "
                 "2>/mnt/socat.txt & sleep 1"]),
]


def link_of(name):
    return next(link for link in LINKS if link.name == name)


class Robot:
    """`kaz sim`, its sockets and its line, for one run."""

    def __init__(self, kaz, folder, arguments, clock=True, eyes=True):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.eyes = folder.resolve(), eyes
        for name in ("board", "board.ctl", "eyes", "clock"):
            with contextlib.suppress(FileNotFoundError):
                (self.folder / name).unlink()
        self.log = self.folder / "robot.txt"
        command = [kaz, "sim", "--serial", "board", *arguments]
        command += ["--cameras", "eyes", "--eyes", "ideal"] if eyes else []
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

    def now(self):
        """Its time, s."""
        return self.command("status")["time_s"]

    def motors(self):
        return self.command("status")["motors"]

    def wait_until(self, at_s):
        """By the robot's time."""
        end = time.monotonic() + machine.PATIENCE_S
        while (now := self.now()) < at_s:
            if time.monotonic() > end:
                raise RuntimeError(f"the robot's time stands still at {now} s")
            time.sleep(0.02)

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
    """A virtual machine that robots follow, with the first one's eyes, if it has any, as video devices."""

    def __init__(self, options, folder, robots, link):
        devices = [*machine.COUNTED, "-device", "virtio-serial-pci,id=ports"]
        clocks = []
        for number, robot in enumerate(robots):
            # Its socket holds about one message: the machine waits until the robot has come to that time.
            clock = socket.socket(socket.AF_UNIX)
            clock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1)
            clock.connect(str(robot.folder / "clock"))
            clocks.append(clock)
            devices += ["-chardev", f"socket,id=clock{number},fd={clock.fileno()}",
                        "-device", f"isa-debugcon,iobase={0xe9 + number:#x},chardev=clock{number}",
                        "-chardev", f"serial,id=board{number},path={(robot.folder / 'board').resolve()}"]
        eyes = bool(robots) and robots[0].eyes
        if eyes:
            devices += ["-chardev", f"socket,id=eyes,path={robots[0].folder}/eyes",
                        "-device", "virtserialport,bus=ports.0,nr=2,chardev=eyes"]
        modules = [*([LOOPBACK] if eyes else []), *link.modules]
        try:
            self.machine = machine.Machine(options.bin / "guest_init", options.kernel, folder, modules,
                                           [*devices, *link.devices],
                                           files=[clock.fileno() for clock in clocks])
        finally:
            for clock in clocks:
                clock.close()
        self.run = self.machine.run
        try:
            self.prepare(options, link, len(robots), eyes)
        except BaseException:
            self.machine.stop()
            raise

    def prepare(self, options, link, robots, eyes):
        feed = options.bin / "guest_feed"
        if robots:
            self.run(f"{feed} clock {robots} >/mnt/clock.txt 2>&1 &")
        if eyes:
            self.run(f"{feed} eyes $(ls /dev/vport*p2) /dev/video0 /dev/video1 >/mnt/eyes.txt 2>&1 &"
                     " echo $! >/mnt/eyes.pid; sleep 0.5; cat /mnt/eyes.txt")
        self.run("ip link set lo up")
        for command in link.before:
            self.run(command.format(kaz=options.kaz, feed=feed))

    def check_program(self, options):
        """That it runs the same executable."""
        inside = self.run(f"sha256sum {options.kaz}")[1].split()[0]
        if inside != options.hash:
            raise RuntimeError(f"the machine runs another program: {inside}")

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


def in_guest(options, folder, link, behavior, seed, seconds, during=None, before=None, world=(), more=""):
    """One run over a link in the machine: (result, what the robot's simulator printed). `more`: further
    options of the run; `world`: of the simulator."""
    folder.mkdir(parents=True, exist_ok=True)
    world = [*BEHAVIORS[behavior][1], "--seed", str(seed), *world]
    with Robot(options.kaz, folder, world) as robot, Guest(options, folder, [robot], link) as guest:
        if before:
            before(guest)
        command = (f"{options.kaz} run {command_of(behavior, seed, seconds)} --robot {link.robot} {more}"
                   f" --camera {EYES} --calibration {options.calibration} >/mnt/result.json 2>/mnt/run.txt")
        if during is None:
            guest.check_program(options)
            guest.run(command, check=False)
        else:
            guest.run(command + " & echo $! >/mnt/run.pid")
            during(robot, guest)
            guest.run("while kill -0 $(cat /mnt/run.pid) 2>/dev/null; do sleep 0.2; done")
        printed = robot.printed()
    result = result_of((folder / "result.json").read_text())
    result["messages"] = (folder / "run.txt").read_text()
    if result["outcome"] == "failed" and not result.get("sentence"):
        result["sentence"] = result["messages"][-400:]
    return result, printed


def outside(options, folder, name, behavior, seed, seconds):
    """The same in lockstep, or over a pty in real time, without the machine."""
    folder.mkdir(parents=True, exist_ok=True)
    world = BEHAVIORS[behavior][1]
    command = [options.kaz, "run", *command_of(behavior, seed, seconds).split()]
    with contextlib.ExitStack() as stack:
        if name == "lockstep":
            command += [*world, "--eyes", "ideal"]
        else:
            stack.enter_context(Robot(options.kaz, folder, [*world, "--seed", str(seed)], clock=False))
            command += ["--robot", "serial:board", "--camera", "eyes"]
        ran = subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=machine.PATIENCE_S)
    result = result_of(ran.stdout)
    result.setdefault("sentence", ran.stderr[-400:])
    return result
