# Every file that reads bytes from outside has a fuzz target, or a reason why not.
# SPDX-License-Identifier: Apache-2.0
"""usage: fuzzed.py ROOT

Holds tools/fuzz/targets.txt against the tree and the table in docs/howto/fuzzing.md. A file reads if it
calls one of READS; comments do not count."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1])
FOLDERS = ("shared", "sim", "host", "hil", "vision", "tools")
READS = re.compile(
    r"\bifstream\b|\bf(?:open|read|getc|gets)\(|\brecv(?:from|msg)?\(|(?<!\w)::p?read\(|\bmmap\("
    r"|\bstd::cin\b|\bgetline\(|\bparse_bounded_json\b|\btinyxml2\b|\bFileStorage\b|\bfrom_chars\("
    r"|\bparse_number<|\bstrto[a-z]+\(|\bsto[dfil]+\(|\bsscanf\(|\bsdf::Root\b|\bparseURDF"
    r"|\bjpeg_read_header\b|\bpng_create_read_struct\b|\bpng_image_begin_read"
    r"|\bStateReader from\b|\bLittleEndianFields\b|\blink_?\.read\("
    r"|\bkz_receive(?:_some)?\(")
TESTS = re.compile(r"_test\.(?:c|cpp|h)$|_testing\.|_example\.cpp$|/testdata/|/oracle"
                   r"|^tools/(?:benchmark|fuzz)/|^sim/h8s/(?:fuzz|example)/")
faults = []


def sources():
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard", *FOLDERS],
                            capture_output=True, text=True)
    names = listed.stdout.split() if listed.returncode == 0 else [
        path.relative_to(ROOT).as_posix() for folder in FOLDERS for path in (ROOT / folder).rglob("*")]
    return [name for name in names
            if name.endswith((".c", ".h", ".cpp", ".hpp")) and not TESTS.search(name)
            and (ROOT / name).is_file()]


def reading(name):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", (ROOT / name).read_text(), flags=re.S)
    return READS.search(text)


targets, reads, reasons = {}, {}, {}
for number, line in enumerate((ROOT / "tools/fuzz/targets.txt").read_text().splitlines(), 1):
    words = line.split()
    if not words or words[0].startswith("#"):
        continue
    if words[0] == "target" and len(words) in (4, 5):
        targets[words[1]] = words[2]
    elif words[0] == "reads" and len(words) > 2:
        reads[words[1]] = words[2:]
    elif words[0] == "none" and len(words) > 3:
        reasons[words[1]] = " ".join(words[2:])
    else:
        faults.append(f"tools/fuzz/targets.txt:{number}: this line is of no form")

product = sources()
for name in product:
    if name not in reads and name not in reasons and (found := reading(name)):
        faults.append(f"{name}: reads bytes ({found.group(0)}) and has no line in tools/fuzz/targets.txt")
for name in [*reads, *reasons]:
    if not (ROOT / name).is_file():
        faults.append(f"tools/fuzz/targets.txt: names {name}, which is not there")
    elif name in reasons and (name in reads or not reading(name)):
        faults.append(f"tools/fuzz/targets.txt: {name} needs no reason: it has a target, or reads nothing")
for name, used in reads.items():
    for target in used:
        if target not in targets:
            faults.append(f"tools/fuzz/targets.txt: {name} names the target {target}, which is not there")
for target, folder in targets.items():
    seeds = list((ROOT / folder).glob("*")) if (ROOT / folder).is_dir() else []
    if not seeds:
        faults.append(f"tools/fuzz/targets.txt: target {target} has no seeds in {folder}")
    if not any(target in used for used in reads.values()):
        faults.append(f"tools/fuzz/targets.txt: target {target} drives no parser")

rows = {}
for used, parsers in re.findall(r"^\| ([^|]*) \| [\d,]+ \| ([^|]*) \|$",
                                (ROOT / "docs/howto/fuzzing.md").read_text(), re.M):
    for name in re.findall(r"`([^`]+)`", parsers):
        rows[name] = re.findall(r"`(\w+)`", used)
for name, used in reads.items():
    if rows.get(name) != used:
        faults.append(f"docs/howto/fuzzing.md: the row of {name} must name {', '.join(used)}; "
                      "./tools/dev fuzz --table writes the table")

print("\n".join(faults) if faults else f"{len(reads)} parsers have {len(targets)} fuzz targets")
sys.exit(1 if faults else 0)
