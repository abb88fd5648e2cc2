# Adds a rig's inertia and gravity torque to the headers of servo logs.
# SPDX-License-Identifier: Apache-2.0
"""usage: add_rig.py RIGS OUT LOG...

RIGS is a CSV file with the columns mass_kg, length_m, inertia_kgm2 and gravity_nm. Each line has the values
of one rig's CAD model. Each LOG (CSV or BAM's JSON) is copied to the folder OUT with the two values of the
rig whose mass and length are within 1 % of the log's. CSV logs also get the value of the column most_duty, if
RIGS has one (STS3215: 0.97).
"""

import csv
import json
import pathlib
import re
import sys

FIELDS = ("mass_kg", "length_m", "inertia_kgm2", "gravity_nm")


def with_rig(text, rigs, name):
    """The log's text with both values; those of an earlier call are replaced."""
    if text.startswith("{"):
        log = json.loads(text)
        log["inertia_kgm2"], log["gravity_nm"], _ = rig_of(log["mass"], log["length"], rigs, name)
        return json.dumps(log)
    found = dict(re.findall(r"^# (mass_kg|length_m) +(\S+)", text, re.M))
    if len(found) < 2:
        sys.exit(f"{name}: the lines `# mass_kg VALUE` and `# length_m VALUE` are needed to find the rig")
    inertia, gravity, duty = rig_of(float(found["mass_kg"]), float(found["length_m"]), rigs, name)
    rest = re.sub(r"^# (inertia_kgm2|gravity_nm) .*\n", "", text, flags=re.M)
    if duty:
        rest = f"# most_duty {duty}\n" + re.sub(r"^# most_duty .*\n", "", rest, flags=re.M)
    return f"# inertia_kgm2 {inertia}\n# gravity_nm {gravity}\n{rest}"


def rig_of(mass, length, rigs, name):
    for rig in rigs:
        if abs(rig[0] - mass) < 0.01 * mass and abs(rig[1] - length) < 0.01 * length:
            return rig[2:]
    sys.exit(f"{name}: no rig has mass {mass} kg and length {length} m; add a line to the table of rigs")


def main(table, out, *logs):
    with open(table, newline="") as lines:
        rigs = [(*(float(line[field]) for field in FIELDS), line.get("most_duty"))
                for line in csv.DictReader(lines)]
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    for log in map(pathlib.Path, logs):
        (out / log.name).write_text(with_rig(log.read_text(), rigs, log))


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
