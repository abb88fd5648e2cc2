# All tests beside programs that take every processor.
# SPDX-License-Identifier: Apache-2.0
"""usage: busy.py [--rounds N] [--loops N] [--build FOLDER] [--out FOLDER] [--fresh]

Runs every test of CTest's, N times (default 3), beside N endless loops (default 8). OUT/round-N.jsonl gets
each result as soon as it is there: the same command goes on where it was interrupted, --fresh begins anew.
A round passes if no test fails and at most 5 were skipped because the machine was too slow.

Exit status: 0 every round has passed, 1 one has not, 2 wrong arguments, 3 the tests are not built, 130
interrupted."""

import argparse
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
MAX_SKIPPED = 5
RESULT = re.compile(r"\s*\d+/\d+ Test\s+#(\d+): (.*?) \.+\s*(Passed|\*\*\*\S.*?)\s+([\d.]+) sec")
TOO_SLOW = "machine too slow: "  # tests/real_time/main.cpp


def listed(build):
    """Number and name of each test."""
    text = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], capture_output=True,
                          text=True, check=True).stdout
    return {number: test["name"] for number, test in enumerate(json.loads(text)["tests"], 1)
            if "command" in test}


def kill_tree(pid):
    """A process and those that it started, also in sessions of their own."""
    parents = {}
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parents[int(path.parent.name)] = int(path.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue  # it has ended
    tree = [pid]
    for parent in tree:
        tree += [child for child, its_parent in parents.items() if its_parent == parent]
    for one in tree:
        try:
            os.kill(one, signal.SIGKILL)
        except ProcessLookupError:
            pass


def run_round(options, tests, path):
    """Runs what `path` has no result of. True: it has come to its end."""
    done = [json.loads(line)["test"] for line in path.read_text().splitlines()] if path.exists() else []
    numbers = [number for number, name in tests.items() if name not in set(done)]
    print(f"{path.name}: {len(done)} of {len(tests)} tests have been run", flush=True)
    if not numbers:
        return True
    chosen = options.out / "tests.txt"
    chosen.write_text("0,0,0," + ",".join(map(str, numbers)))
    loops = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(options.loops)]
    # Twice as many jobs as `./tools/dev test` has: the tests get a greater share of the processors.
    ctest = subprocess.Popen(["ctest", "--test-dir", options.build, "-j", str(6 * (os.cpu_count() or 1)),
                              "-I", chosen, "-V"], stdout=subprocess.PIPE, text=True, errors="replace")
    slow, count, shown = set(), len(done), time.monotonic()
    try:
        with path.open("a") as results, path.with_suffix(".log").open("a") as log:
            for line in ctest.stdout:
                log.write(line)
                if TOO_SLOW in line:
                    slow.add(line.partition(":")[0])
                result = RESULT.match(line)
                if not result:
                    continue
                outcome = {"Passed": "passed", "***Skipped": "skipped"}.get(result[3], "failed")
                if outcome == "skipped" and result[1] in slow:
                    outcome = "too slow"
                count += 1
                results.write(json.dumps({"test": result[2].strip(), "outcome": outcome,
                                          "seconds": float(result[4])}) + "\n")
                results.flush()
                if outcome in ("failed", "too slow") or time.monotonic() - shown > 30:
                    shown = time.monotonic()
                    print(f"[{count}/{len(tests)}] {result[2].strip()}: {outcome}", flush=True)
        return ctest.wait() in (0, 8)
    finally:
        for process in [*loops, ctest]:
            kill_tree(process.pid)
            process.wait()


def main():
    parser = argparse.ArgumentParser(prog="./tools/dev study busy",
                                     description="Runs all tests on a busy machine.")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--loops", type=int, default=8, help="endless loops beside the tests")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/busy")
    parser.add_argument("--fresh", action="store_true", help="forget the results of earlier runs")
    options = parser.parse_args()
    if options.rounds < 1 or options.loops < 0:
        parser.error("--rounds is 1 or more, --loops 0 or more")
    if not (options.build / "CTestTestfile.cmake").exists():
        print(f"{options.build} has no tests: ./tools/dev build", file=sys.stderr)
        return 3
    options.out.mkdir(parents=True, exist_ok=True)
    if options.fresh:
        for old in options.out.glob("round-*"):
            old.unlink()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    tests, passed = listed(options.build), 0
    for number in range(1, options.rounds + 1):
        path = options.out / f"round-{number}.jsonl"
        began = time.monotonic()
        try:
            if not run_round(options, tests, path):
                print("ctest has ended before the last test", file=sys.stderr)
                return 1
        except KeyboardInterrupt:
            print(f"interrupted; the same command goes on: {path}", file=sys.stderr)
            return 130
        rows = [json.loads(line) for line in path.read_text().splitlines()]
        by = {kind: sorted(row["test"] for row in rows if row["outcome"] == kind)
              for kind in ("passed", "failed", "too slow", "skipped")}
        good = not by["failed"] and len(by["too slow"]) <= MAX_SKIPPED
        passed += good
        print(f"round {number}: {'passed' if good else 'FAILED'}, {(time.monotonic() - began) / 60:.0f} min; "
              f"{len(by['passed'])} tests passed; failed: {', '.join(by['failed']) or 'none'}; machine too "
              f"slow for: {', '.join(by['too slow']) or 'none'}", flush=True)
    print(f"{passed} of {options.rounds} rounds passed")
    return 0 if passed == options.rounds else 1


sys.exit(main())
