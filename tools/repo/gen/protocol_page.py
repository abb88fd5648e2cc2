#!/usr/bin/env python3
# Writes the message table with its texts, and the joints, as JSON for the page of the board.
# SPDX-License-Identifier: Apache-2.0
"""usage: protocol_page.py ROOT OUT

What shared/protocol/grammar.json has, each message's and field's text, and name and limits of each joint.
"""
import json
import os
import sys

import limits
from protocol_grammar import grammar
from protocol_table import Refused, read_messages


def table(root):
    data = json.loads(grammar(root))
    data["about"] = "The messages of Kaz's servo board, made by tools/repo/gen/protocol_page.py"
    for message, source in zip(data["messages"], read_messages(root), strict=True):
        message["kind"], message["text"] = source.kind, source.text
        for field, source_field in zip(message["fields"], source.fields, strict=True):
            field["text"] = source_field.text
    urdf = f"{root}/shared/robot/kaz/kaz.urdf"
    model = limits.parse_urdf(urdf)
    data["joints"] = []
    with open(f"{root}/shared/board/joints.def", encoding="utf-8") as source:
        lines = limits.JOINT_LINE.findall(source.read())
    wiring = [[cell.strip() for cell in line.split(",")] for line in lines if line.strip()[0].isdigit()]
    for joint, wire in zip(limits.read_joints(f"{root}/shared/board/joints.def"), wiring, strict=True):
        lower, upper = limits.limits_of(urdf, model, joint)
        data["joints"].append({"name": joint[0], "lower": lower, "upper": upper, "pwm": int(wire[2]),
                               "port": int(wire[3]), "bit": int(wire[4]), "mux": int(wire[5]),
                               "input": int(wire[6]), "sign": int(wire[7])})
    return data


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    root, target = arguments
    try:
        text = json.dumps(table(root), ensure_ascii=False, indent=1) + "\n"
        with open(target + ".new", "w", encoding="utf-8") as out:
            out.write(text)
        os.replace(target + ".new", target)
    except (Refused, limits.Refused, OSError) as error:
        print(f"protocol_page.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
