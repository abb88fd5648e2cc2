#!/usr/bin/env python3
# Writes the servo board's wiring, as tables and as a drawing, from the joint table and the chip's pins.
# SPDX-License-Identifier: Apache-2.0
"""usage: wiring_doc.py ROOT [--check]

Writes ROOT/docs/reference/wiring.md and wiring.svg; with --check only compares, and fails if one is
out of date.
"""
import re
import sys

import generated_file
from protocol_table import Refused, read_constants

JOINT = re.compile(r'^KZ_JOINT\(\s*(\d+), (\w+),\s*(\d+), (\d+), (\d+), (\d+), (\d+),'
                   r'\s*(-?\d+),\s*(-?\d+)\)', re.M)
PIN = re.compile(r'\{(\d), \d, (?:true|false), (true|false), \{([^}]*)\}\}')
HEADER = ("<!-- Written by tools/repo/gen/wiring_doc.py from shared/board and sim/h8s/chip/pins.cpp: edit "
          "those. -->\n")


class Joint:
    def __init__(self, row):
        self.index, self.name = int(row[0]), row[1]
        self.pwm, self.port, self.bit, self.mux, self.input, self.sign, self.centre = map(int, row[2:])

    def speed(self):
        return f"PW{self.pwm}" if self.pwm < 16 else f"TMO{self.pwm - 16}"

    def direction(self):
        return f"P{self.port}{self.bit}"


class Board:
    """Joints, the chip's pins by any name, and the constants of board.h."""

    def __init__(self, root):
        with open(f"{root}/shared/board/joints.def", encoding="utf-8") as source:
            self.joints = [Joint(row) for row in JOINT.findall(source.read())]
        with open(f"{root}/sim/h8s/chip/pins.cpp", encoding="utf-8") as source:
            rows = PIN.findall(source.read())
        # The control inputs, of port 0, are listed apart.
        self.pins = [re.findall(r'"(\w+)"', names) for port, _, names in rows if port != "0"]
        self.weak_high = {re.findall(r'"(\w+)"', names)[0] for _, weak, names in rows if weak == "true"}
        self.constants = {name: text for name, (text, _) in
                          read_constants(f"{root}/shared/board/board.h").items()}
        if len(self.joints) != self.number("KZ_JOINTS") or len(self.pins) != 51:
            raise Refused(f"{root}: {len(self.joints)} joints and {len(self.pins)} pins were read")
        self.uses = self.assign()

    def number(self, name):
        return int(self.constants[name].rstrip("L"), 0)

    def pin(self, name):
        """The port's name of a pin."""
        for names in self.pins:
            if name in names:
                return names[0]
        raise Refused(f"the chip has no pin {name}")

    def assign(self):
        """Port's name of each pin to (function, direction, what it is for); each is used once."""
        uses = {}

        def use(name, function, way, purpose):
            pin = self.pin(name)
            if pin in uses:
                raise Refused(f"{pin} is used twice: {uses[pin][2]}, {purpose}")
            uses[pin] = (function, way, purpose)

        for joint in self.joints:
            use(joint.speed(), joint.speed(), "out", f"speed of {joint.name}")
            use(joint.direction(), "port", "out", f"direction of {joint.name}")
        select = self.number("KZ_P4_MUX_MASK")
        enable = self.number("KZ_P4_ENABLE")
        for bit in range(8):
            if select >> bit & 1:
                use(f"P4{bit}", "port", "out", f"select S{bit} of all multiplexers; pull-up 10 kΩ")
            if enable >> bit & 1:
                use(f"P4{bit}", "port", "out", "enable of all motor drivers; pull-down 10 kΩ")
        for mux in range(self.number("KZ_MUXES")):
            use(f"AN{mux}", f"AN{mux}", "in", f"common pin of multiplexer {mux}")
        for channel, what in enumerate(("yaw rate", "forward force", "left force"), 3):
            use(f"AN{channel}", f"AN{channel}", "in", f"{what} (inertial option), else ground")
        use("TxD0", "TxD0", "out", "host line, to the PC")
        use("RxD0", "RxD0", "in", "host line, from the PC")
        return uses

    def inputs(self):
        """(multiplexer, input) to what is connected there."""
        table = {(joint.mux, joint.input): joint.name for joint in self.joints}
        at = lambda name: divmod(self.number(name), self.number("KZ_MUX_INPUTS"))
        volts = self.number("KZ_SUPPLY_FULL_MV") / 1000
        table[at("KZ_ANALOG_SUPPLY")] = f"motor supply, divided so that {volts:g} V gives AVCC"
        table[at("KZ_ANALOG_REFERENCE")] = "half of AVCC, from two equal resistors"
        full = self.number("KZ_TEMPERATURE_FULL_DC") / 10
        table[at("KZ_ANALOG_TEMPERATURE")] = \
            f"temperature of the motor drivers: 0 V at 0 °C, AVCC at {full:g} °C"
        return table


def rows_of(table):
    head, *body = table
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head),
            *("| " + " | ".join(row) + " |" for row in body), ""]


def signed(tenths):
    return f"{tenths / 10:+g}°" if tenths else "0°"


def by_joint(board):
    table = [("joint", "name", "speed (PWM)", "direction", "input", "mirrored", "angle at mid-scale")]
    for joint in board.joints:
        table.append((str(joint.index), f"`{joint.name}`",
                      f"{board.pin(joint.speed())} ({joint.speed()})", joint.direction(),
                      f"{joint.mux}.{joint.input}",
                      "" if joint.sign > 0 else "yes", signed(joint.centre)))
    return rows_of(table)


def by_pin(board):
    """Pins that do not belong to a joint."""
    of_joints = {pin for joint in board.joints for pin in (board.pin(joint.speed()), joint.direction())}
    table = [("pin", "purpose")]
    for names in board.pins:
        if names[0] in board.uses and names[0] not in of_joints:
            function, _, purpose = board.uses[names[0]]
            table.append((names[0] if function == "port" else f"{names[0]} ({function})", purpose))
    return rows_of(table)


def weak_outputs(board):
    """Outputs whose high level needs a pull-up."""
    return [names[0] for names in board.pins
            if names[0] in board.weak_high and board.uses.get(names[0], ("", ""))[1] == "out"]


def by_input(board):
    """Inputs of the multiplexers without a potentiometer."""
    of_joints = {(joint.mux, joint.input) for joint in board.joints}
    table = [("input", "connect")]
    table += [(f"{mux}.{i}", what) for (mux, i), what in sorted(board.inputs().items())
              if (mux, i) not in of_joints]
    return rows_of(table)


def document(root):
    board = Board(root)
    with open(f"{root}/tools/repo/gen/wiring.md.in", encoding="utf-8") as template:
        text = template.read()
    for name, rows in (("BY_JOINT", by_joint(board)), ("BY_PIN", by_pin(board)),
                       ("BY_INPUT", by_input(board))):
        text = text.replace(f"@{name}@\n", "\n".join(rows) + "\n")
    text = text.replace("@WEAK_OUTPUTS@", " and ".join(weak_outputs(board)))
    text = text.replace("@MHZ@", f"{board.number('KZ_CLOCK_HZ') / 1e6:g}")
    if "@" in text:
        raise Refused("tools/repo/gen/wiring.md.in: a name between @ that this program does not know")
    return HEADER + "\n" + text


# ---- The drawing

ROW = 19  # px


def text_at(x, y, text, kind="small", anchor="start"):
    return f'<text class="{kind}" x="{x}" y="{y}" text-anchor="{anchor}">{text}</text>'


def box(x, y, width, height, kind="box"):
    return f'<rect class="{kind}" x="{x}" y="{y}" width="{width}" height="{height}" rx="5"/>'


def line(x1, y1, x2, y2, kind="wire"):
    return f'<path class="{kind}" d="M{x1} {y1}H{x2}"/>' if y1 == y2 else \
           f'<path class="{kind}" d="M{x1} {y1}L{x2} {y2}"/>'


def drawing(root):
    board = Board(root)
    inputs = board.inputs()
    out = []
    # Right: drivers, a row for each joint with its two wires.
    top, left, width = 60, 400, 250
    drivers_x = left + width + 130
    height = ROW * (2 * len(board.joints) + 4)
    out.append(box(left, top, width, height))
    middle = left + width / 2 - 18
    clock = f"{board.number('KZ_CLOCK_HZ') / 1e6:g} MHz"
    out.append(text_at(middle, top + height / 2, "H8S/2128", "head", "middle"))
    out.append(text_at(middle, top + height / 2 + 18, clock, "small", "middle"))
    enable = next(pin for pin, use in board.uses.items() if use[2].startswith("enable"))
    for k, joint in enumerate(board.joints):
        y = top + ROW * (2 * k + 1)
        out.append(box(drivers_x, y - 9, 270, 2 * ROW - 4))
        out.append(text_at(drivers_x + 10, y + 14, f"{joint.index}  {joint.name}", "name"))
        out.append(text_at(drivers_x + 260, y + 14, "driver and servo", "small", "end"))
        for at, pin, role in ((y, board.pin(joint.speed()), "speed"),
                              (y + ROW - 1, joint.direction(), "direction")):
            label = f"{pin} ({joint.speed()})" if role == "speed" else pin
            out.append(line(left + width, at, drivers_x, at))
            out.append(text_at(left + width - 8, at + 4, label, "small", "end"))
            out.append(text_at(left + width + 10, at - 3, role, "tiny"))
    y = top + ROW * (2 * len(board.joints) + 1)
    out.append(line(left + width, y, drivers_x + 270, y, "enable"))
    out.append(text_at(left + width - 8, y + 4, enable, "small", "end"))
    out.append(text_at(left + width + 10, y - 3, "enable of all drivers; 10 kΩ to ground", "tiny"))
    # Left: multiplexers with what is at their inputs.
    selects = [pin for pin, use in board.uses.items() if use[2].startswith("select")]
    y = top + 10
    for mux in range(board.number("KZ_MUXES")):
        count = board.number("KZ_MUX_INPUTS")
        out.append(box(30, y, 250, ROW * (count + 1) + 6))
        out.append(text_at(40, y + 16, f"multiplexer {mux}", "name"))
        out.append(text_at(270, y + 16, "select " + " ".join(selects), "small", "end"))
        for i in range(count):
            what = inputs.get((mux, i), "ground")
            short = re.split(r"[,:]", what)[0]
            out.append(text_at(48, y + ROW * (i + 2) - 3, f"{i}   {short}", "small"))
        middle = y + ROW * (count + 1) / 2
        out.append(line(280, middle, left, middle))
        out.append(text_at(left + 8, middle + 4, f"{board.pin(f'AN{mux}')} (AN{mux})"))
        y += ROW * (count + 1) + 26
    other = [(f"{pin} (AN{channel})", board.uses[pin][2].split(" (")[0])
             for channel, pin in ((c, board.pin(f"AN{c}")) for c in (3, 4, 5))]
    out.append(box(30, y, 250, 3 * ROW + 12))
    for k, (pin, what) in enumerate(other):
        at = y + 14 + ROW * k
        out.append(text_at(40, at + 4, f"{what} (option)"))
        out.append(line(280, at, left, at))
        out.append(text_at(left + 8, at + 4, pin))
    y += 3 * ROW + 32
    out.append(box(30, y, 250, 2 * ROW + 10))
    for k, (name, what) in enumerate((("TxD0", "host line: to the PC"), ("RxD0", "host line: from the PC"))):
        at = y + 14 + ROW * k
        out.append(text_at(40, at + 4, what))
        out.append(line(280, at, left, at))
        out.append(text_at(left + 8, at + 4, f"{board.pin(name)} ({name})"))
    total = top + height + 20
    style = ("<style>.box{fill:#fff;stroke:#42597a;stroke-width:1.2}"
             ".wire{stroke:#42597a;fill:none}.enable{stroke:#b03a2e;stroke-width:2;fill:none}"
             ".head{font-size:18px;font-weight:bold;fill:#1f2f45}.name{font-weight:bold;fill:#1f2f45}"
             ".small{font-size:12px;fill:#24344d}.tiny{font-size:9.5px;fill:#5a6b85}</style>")
    wide = drivers_x + 290
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {total}" '
                      'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="13">', style,
                      f'<rect width="{wide}" height="{total}" fill="#f6f8fb"/>',
                      text_at(30, 34, "Kaz servo board: what is connected to what", "head"), *out,
                      "</svg>", ""])


if __name__ == "__main__":
    sys.exit(max(generated_file.main(sys.argv[1:], __doc__, "docs/reference/wiring.md", document),
                 generated_file.main(sys.argv[1:], __doc__, "docs/reference/wiring.svg", drawing)))
