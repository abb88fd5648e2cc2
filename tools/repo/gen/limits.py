#!/usr/bin/env python3
# Writes the joints' limits from the robot's URDF as C constants, in 100 microradians.
# SPDX-License-Identifier: Apache-2.0
"""usage: limits.py URDF JOINTS_DEF HEADER

Every joint of JOINTS_DEF must stand in URDF with a <limit lower upper>, inside the range in which
its potentiometer gives a valid code. Limits are rounded inwards.
"""
import math
import re
import sys
from xml.parsers import expat

ANGLE_PER_RAD = 10000
POT_CODES = 1024
POT_RANGE_DEG = 190.0
SOUND_CODES = (4, 1019)  # outside, the servo takes the potentiometer for open or short
JOINT_LINE = re.compile(r"KZ_JOINT\(([^)]*)\)")


class Refused(Exception):
    """One sentence with file and line."""


class Element:
    """An XML element that knows the line of its start tag."""

    def __init__(self, tag, attributes, line):
        self.tag, self.attributes, self.line, self.children = tag, attributes, line, []

    def get(self, name):
        return self.attributes.get(name)

    def find(self, tag):
        return next((child for child in self.children if child.tag == tag), None)


def parse_urdf(path):
    parser = expat.ParserCreate()
    top = Element("", {}, 1)
    stack = [top]

    def start(tag, attributes):
        element = Element(tag, attributes, parser.CurrentLineNumber)
        stack[-1].children.append(element)
        stack.append(element)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: stack.pop()
    try:
        with open(path, "rb") as source:
            parser.ParseFile(source)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise Refused(f"{path}:{error.lineno}: not well-formed XML: {reason}")
    return top.children[0]


def read_joints(path):
    """(name, sign, centre in degrees, line) of each joint, in order."""
    joints = []
    with open(path, encoding="utf-8") as source:
        for number, line in enumerate(source, 1):
            match = JOINT_LINE.search(line)
            if not match or line.lstrip().startswith("//"):
                continue
            cells = [cell.strip() for cell in match.group(1).split(",")]
            if len(cells) != 9:
                raise Refused(f"{path}:{number}: KZ_JOINT has {len(cells)} values, not 9")
            joints.append((cells[1], int(cells[7]), int(cells[8]) / 10.0, number))
    if not joints:
        raise Refused(f"{path}:1: no KZ_JOINT line")
    return joints


def pot_window(sign, centre_deg):
    """Joint angles, rad, at the first and last valid code."""
    ends = [centre_deg + sign * (code - POT_CODES // 2) * POT_RANGE_DEG / POT_CODES
            for code in SOUND_CODES]
    return math.radians(min(ends)), math.radians(max(ends))


def number(path, element, joint, name):
    text = element.get(name)
    if text is None:
        raise Refused(f"{path}:{element.line}: <limit> of joint '{joint}' has no '{name}'")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise Refused(f"{path}:{element.line}: '{name}=\"{text}\"' of joint '{joint}' is no number")
    return value


def limits_of(path, root, joint):
    name, sign, centre_deg, _ = joint
    element = next((child for child in root.children
                    if child.tag == "joint" and child.get("name") == name), None)
    if element is None:
        raise Refused(f"{path}:{root.line}: no joint '{name}', which joints.def wires")
    limit = element.find("limit")
    if limit is None:
        raise Refused(f"{path}:{element.line}: joint '{name}' has no <limit>")
    lower, upper = (number(path, limit, name, key) for key in ("lower", "upper"))
    if not lower < upper:
        raise Refused(f"{path}:{limit.line}: lower limit of '{name}' is not below its upper limit")
    low, high = pot_window(sign, centre_deg)
    if lower < low or upper > high:
        raise Refused(
            f"{path}:{limit.line}: limits {lower:.4f}..{upper:.4f} rad of '{name}' lie outside what "
            f"its potentiometer sees, {low:.4f}..{high:.4f} rad; change them or pot_centre in "
            "joints.def")
    # The small term forgives the last digit of a decimal number such as 1.5707.
    return (math.ceil(lower * ANGLE_PER_RAD - 1e-6), math.floor(upper * ANGLE_PER_RAD + 1e-6))


def header(urdf, joints, limits):
    lines = ["// Joint limits in 100 microradians, made by tools/repo/gen/limits.py from the URDF.",
             "// SPDX-License-Identifier: Apache-2.0",
             "#ifndef KAZ_GENERATED_LIMITS_H", "#define KAZ_GENERATED_LIMITS_H", ""]
    for (name, *_), (lower, upper) in zip(joints, limits):
        lines.append(f"#define KZ_LIMIT_LOWER_{name} ({lower})")
        lines.append(f"#define KZ_LIMIT_UPPER_{name} ({upper})")
    return "\n".join(lines + ["", "#endif", ""])


def main(arguments):
    if len(arguments) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    urdf, joints_def, target = arguments
    try:
        root = parse_urdf(urdf)
        joints = read_joints(joints_def)
        text = header(urdf, joints, [limits_of(urdf, root, joint) for joint in joints])
    except (Refused, OSError) as error:
        print(f"limits.py: {error}", file=sys.stderr)
        return 1
    with open(target, "w", encoding="utf-8") as out:
        out.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
