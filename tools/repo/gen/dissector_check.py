#!/usr/bin/env python3
# Runs the golden vectors through the dissector in tshark, and compares every field.
# SPDX-License-Identifier: Apache-2.0
"""usage: dissector_check.py ROOT TSHARK"""
import json
import os
import struct
import subprocess
import sys
import tempfile

from protocol_table import read_messages, received


def main(root, tshark):
    with open(f"{root}/shared/protocol/vectors.json", encoding="utf-8") as file:
        vectors = json.load(file)
    damaged = [b"\0" + piece + b"\0" for stream in vectors["streams"]
               for piece in bytes.fromhex(stream["wire"]).split(b"\0") if piece]
    frames = [bytes.fromhex(vector["wire"]) for vector in vectors["messages"]] + damaged
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "vectors.pcap")
        with open(path, "wb") as pcap:
            pcap.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 147))
            for frame in frames:
                pcap.write(struct.pack("<IIII", 0, 0, len(frame), len(frame)) + frame)
        names = ["kaz.result", "kaz.message", "kaz.address", "kaz.sequence"] + [
            f"kaz.{message.name}.{field.name}" for message in read_messages(root)
            for field in message.fields]
        command = [tshark, "-X", f"lua_script:{root}/shared/protocol/wireshark/kaz.lua", "-r", path,
                   "-T", "fields", "-E", "separator=;", "-E", "occurrence=a", "-E", "aggregator=,"]
        for name in names:
            command += ["-e", name]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = done.stdout.splitlines()
    if done.returncode != 0 or len(lines) != len(frames):
        print(f"tshark ended with {done.returncode} and {len(lines)} lines of {len(frames)}: "
              f"{done.stderr}", file=sys.stderr)
        return 1
    wrong = compared = 0
    rows = [dict(zip(names, line.split(";"))) for line in lines]
    for vector, row in zip(vectors["messages"], rows):
        expected = {"kaz.result": "FRAME", "kaz.message": vector["message"],
                    "kaz.address": str(vector["address"]), "kaz.sequence": str(vector["sequence"])}
        for name, value in vector["fields"].items():
            numbers = value if isinstance(value, list) else [value]
            expected[f"kaz.{vector['message']}.{name}"] = ",".join(map(str, numbers))
        for name in names:
            compared += 1
            if row[name] != expected.get(name, ""):
                wrong += 1
                print(f"{vector['name']}: {name} is '{row[name]}', not '{expected.get(name, '')}'",
                      file=sys.stderr)
    for frame, row in zip(damaged, rows[len(vectors["messages"]):]):
        compared += 1
        if row["kaz.result"] != received(frame)[0][0]:
            wrong += 1
            print(f"{frame.hex()}: {row['kaz.result']}", file=sys.stderr)
    print(f"{len(frames)} packets, {compared} values compared, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1], sys.argv[2]))
