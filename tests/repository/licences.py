# Whose each file is and under which licence: REUSE 3.0, by Debian's package `reuse`.
# SPDX-License-Identifier: Apache-2.0
"""usage: licences.py ROOT

Runs `reuse lint` on a copy of what git has, or would add: what a build leaves in the tree does not count, and
the test is the same in an unpacked source archive. Besides: LICENSE, which hosts look for, is the text in
LICENSES, and .reuse/dep5 has no pattern for nothing, and none for everything."""

import fnmatch
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1])
faults = []


def names():
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-coz", "--exclude-standard"],
                            capture_output=True, text=True)
    if listed.returncode == 0:
        found = listed.stdout.split("\0")
    else:
        found = (path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*"))
    return sorted({name for name in found if name and (ROOT / name).is_file()
                   and name.split("/")[0] not in ("build", "out", ".git") and "__pycache__" not in name})


def check_reuse(files):
    program = shutil.which("reuse", path="/usr/bin:/bin")
    if not program:
        faults.append("the program `reuse` is missing: apt-get install reuse, or ./tools/dev setup")
        return
    with tempfile.TemporaryDirectory() as copy:
        for name in files:
            target = pathlib.Path(copy, name)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, target)
        done = subprocess.run([program, "--root", copy, "lint"], capture_output=True, text=True, cwd=copy)
    counted = re.search(r"Files with license information: (\d+) / (\d+)", done.stdout)
    if done.returncode != 0 or not counted:
        faults.append(f"`reuse lint` ends with {done.returncode}; a file without a header gets a pattern in "
                      f".reuse/dep5, with its source:\n{done.stdout}{done.stderr}")
    elif counted[1] != counted[2] or int(counted[1]) < 0.99 * len(files):
        faults.append(f"`reuse lint` saw {counted[0]}, of {len(files)} files in the tree")
    # Such files pass, with what .reuse/dep5 says of them alone.
    if "cannot be parsed" in done.stderr:
        faults.append(f"a line looks like a licence's and is none:\n{done.stderr}")


def check_patterns(files):
    text = (ROOT / ".reuse/dep5").read_text()
    for value in re.findall(r"^Files:((?:.*\n)(?: .*\n)*)", text, re.M):
        for pattern in value.split():
            if pattern == "*":
                faults.append(".reuse/dep5: a pattern for all files hides where a new one comes from")
            elif not any(fnmatch.fnmatchcase(name, pattern) for name in files):
                faults.append(f".reuse/dep5: no file is named {pattern}")


if (ROOT / "LICENSE").read_bytes() != (ROOT / "LICENSES/Apache-2.0.txt").read_bytes():
    faults.append("LICENSE and LICENSES/Apache-2.0.txt differ")
listed = names()
check_patterns(listed)
check_reuse(listed)
print("\n".join(faults) if faults else f"{len(listed)} files have their licence")
sys.exit(1 if faults else 0)
