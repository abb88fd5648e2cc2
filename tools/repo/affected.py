# Builds and runs the tests that depend on changed files.
# SPDX-License-Identifier: Apache-2.0
"""usage: affected.py [--all] [--list] [--build FOLDER] [FILE ...]

FILE ... are sources and headers of C and C++, without them those that git sees as changed since the last
commit. A test depends on a file if its program is linked with it, or starts a program that is. The quickest
tests come first, those without `kaz` before those that start it, until they would take 50 s on this machine
(by the times of earlier runs); --all runs all of them. --list only prints their names. The tree must have
been built once: ./tools/dev build.

Exit status: 0 all have passed, 1 a test has failed or the build has, 2 wrong arguments, 3 the tree is not
built."""

import argparse
import json
import os
import pathlib
import re
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIMIT_S = 50  # of each core: with the build behind a changed file, about a minute
SOURCES = (".c", ".cpp", ".h", ".hpp", ".def")
# Files that are linked with a changed object. Ninja's graph also has targets that are only built after it.
LINKED = re.compile(r"(\.o|\.a|\.so|(^|/)bin/[\w-]+)$")
STARTED = "bin/kaz"


def ninja(build, *words):
    done = subprocess.run(["ninja", "-C", build, *words], capture_output=True, text=True)
    return done.stdout


def changed_files():
    lines = subprocess.run(["git", "status", "--porcelain", "--no-renames"], cwd=ROOT, capture_output=True,
                           text=True, check=True).stdout.splitlines()
    return [line[3:] for line in lines if line[3:].endswith(SOURCES)]


def objects_of(build, files):
    """Each file's objects, by what the compiler read for them."""
    wanted = {os.path.normpath(ROOT / file): file for file in files}
    found = {file: set() for file in files}
    output = None
    for line in ninja(build, "-t", "deps").splitlines():
        if not line.startswith(" "):
            output = line.partition(": #deps")[0]
        elif line:
            file = wanted.get(os.path.normpath(build / line.strip()))
            if file:
                found[file].add(output)
    return found


def users_of(build, nodes, through_programs):
    """What is linked with `nodes`, or, through programs, built from them."""
    reached, new = set(nodes), set(nodes)
    while new:
        outputs = set()
        into = False
        for line in ninja(build, "-t", "query", *sorted(new)).splitlines():
            if line.startswith("  "):
                into = into if line.startswith("    ") else line.strip() == "outputs:"
                if into and line.startswith("    ") and LINKED.search(line.strip()):
                    outputs.add(line.strip())
            else:
                into = False
        new = {node for node in outputs - reached if through_programs or node != STARTED}
        reached |= new
    return reached


def tests_of(build, programs):
    """Number and name of each test of these programs."""
    listed = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], capture_output=True,
                            text=True, check=True).stdout
    paths = {str(build / program) for program in programs}
    tests = []
    for number, test in enumerate(json.loads(listed)["tests"], 1):
        if paths.intersection(test.get("command", [])):
            tests.append((number, test["name"]))
    return tests


def costs(build):
    """Seconds of each test in earlier runs."""
    path = build / "Testing/Temporary/CTestCostData.txt"
    known = {}
    for line in path.read_text().splitlines() if path.exists() else []:
        words = line.rsplit(" ", 2)
        if len(words) == 3:
            known[words[0]] = float(words[2])
    return known


def main():
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # --list | head
    parser = argparse.ArgumentParser(prog="./tools/dev check",
                                     description="Runs the tests that depend on changed files.")
    parser.add_argument("files", nargs="*", metavar="FILE")
    parser.add_argument("--all", action="store_true", help="also run the slow tests")
    parser.add_argument("--list", action="store_true", help="print the names of the tests, and run none")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    options = parser.parse_args()
    for file in options.files:
        if not (ROOT / file).is_file():
            parser.error(f"{file} is not a file of this tree")
    build = options.build.resolve()
    if not (build / ".ninja_deps").exists():
        print(f"{build} is not built: run ./tools/dev build", file=sys.stderr)
        return 3
    files = options.files or changed_files()
    if not files:
        print("no source or header has changed since the last commit: give a file", file=sys.stderr)
        return 2
    found = objects_of(build, files)
    for file in (file for file in files if not found[file]):
        print(f"{file}: no target compiles this file; if the file is new, run ./tools/dev build",
              file=sys.stderr)
        return 2
    objects = set().union(*found.values())
    direct = users_of(build, objects, False)
    programs = users_of(build, objects, True)
    known = costs(build)
    ranked = sorted((name, number, f"bin/{name.partition('.')[0]}_test" not in direct, known.get(name, 1.0))
                    for number, name in tests_of(build, programs))
    ranked.sort(key=lambda test: (test[2], test[3]))
    cores = os.cpu_count() or 1
    chosen, time_s = [], 0.0
    for test in ranked:
        if options.all or time_s + test[3] <= LIMIT_S * cores:
            chosen.append(test)
            time_s += test[3]
    left_out = len(ranked) - len(chosen)
    slow = f"; --all also runs the {left_out} slow tests" if left_out else ""
    print(f"{len(ranked)} tests depend on {', '.join(files)}; {len(chosen)} of them run now, about "
          f"{time_s / cores:.0f} s{slow}", flush=True)
    if options.list:
        print("\n".join(test[0] for test in chosen))
        return 0
    names = {f"bin/{test[0].partition('.')[0]}_test" for test in chosen}
    targets = sorted(names & programs) + ([STARTED] if STARTED in programs else [])
    if subprocess.run(["ninja", "-C", build, *targets]).returncode != 0:
        return 1
    numbers = build / "Testing/affected.txt"
    numbers.write_text("0,0,0," + ",".join(str(test[1]) for test in chosen))
    return subprocess.run(["ctest", "--test-dir", build, "-j", str(3 * cores), "--output-on-failure",
                           "-I", numbers]).returncode and 1


sys.exit(main())
