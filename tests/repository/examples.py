# Runs each command that README.md and docs/ show in a block marked `sh`, in a folder of its own, with the
# program on the PATH, and Debian's own Python before others. A block marked `sh background` runs beside those
# that follow it in the same file.
# SPDX-License-Identifier: Apache-2.0
"""usage: examples.py ROOT BIN background|others: the pages that have a block of that kind, or none

Exit status: 0 all ran, 1 one failed, 75 a page with a program in the background failed three times while this
machine was too slow (tests/real_time/main.cpp); with KAZ_TEST_ALONE=1 that is 1."""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

ROOT, BIN = pathlib.Path(sys.argv[1]), sys.argv[2]
HANG_S = 1200  # of a busy machine
ATTEMPTS, SLOW_SHARE = 3, 0.25
BLOCK = re.compile(r"^```sh( background)?\n(.*?)^```$", re.M | re.S)


def wait_until_ready(output):
    """Returns at the line with which kaz says so."""
    for line in output:
        print(line, end="", flush=True)
        if line.startswith("ready: "):
            return
    raise Failed("the program in the background ended")


class Failed(Exception):
    pass


def waited_s():
    """Time in which at least one program waited for a processor (PSI); 0 where the kernel does not say."""
    try:
        return 1e-6 * int(pathlib.Path("/proc/pressure/cpu").read_text().split()[4].partition("=")[2])
    except OSError:
        return 0


def run_page(path, may_be_slow):
    """Runs its examples, each time in an empty folder; returns their number."""
    for attempt in range(1, ATTEMPTS + 1):
        began, before = time.monotonic(), waited_s()
        try:
            with tempfile.TemporaryDirectory() as scratch:
                return run_file(path, scratch)
        except Failed as why:
            share = (waited_s() - before) / (time.monotonic() - began)
            if not may_be_slow or share < SLOW_SHARE:
                sys.exit(str(why))
            print(f"{why}\nmachine too slow: programs waited for a processor {100 * share:.0f} % of the time "
                  f"(limit {100 * SLOW_SHARE:.0f}); failed {attempt} of {ATTEMPTS} times", flush=True)
    sys.exit(75)


def run_file(path, folder):
    environment = dict(os.environ, PATH=f"{BIN}:/usr/bin:{os.environ['PATH']}", KAZ_SOURCE=str(ROOT),
                       KAZ_PYTHON=str(pathlib.Path(BIN).parent / "python"))
    background = []
    ran = 0
    try:
        for mode, block in BLOCK.findall(path.read_text()):
            print(f"{path.relative_to(ROOT)}:\n{block}", flush=True)
            command = ["bash", "-euo", "pipefail", "-c", block]
            ran += 1
            if mode:
                background.append(subprocess.Popen(command, cwd=folder, env=environment, text=True,
                                                   stdout=subprocess.PIPE, process_group=0))
                wait_until_ready(background[-1].stdout)
                continue
            done = subprocess.run(command, cwd=folder, env=environment, timeout=HANG_S)
            if done.returncode != 0:
                raise Failed(f"{path.relative_to(ROOT)}: the example above ended with {done.returncode}")
    finally:
        for process in background:
            os.killpg(process.pid, signal.SIGINT)
            process.communicate(timeout=HANG_S)
    return ran


total = 0
for document in sorted([ROOT / "README.md", *ROOT.glob("docs/**/*.md")]):
    # What runs in the background does so in real time, and no other such test beside it.
    if (sys.argv[3] == "background") != ("```sh background\n" in document.read_text()):
        continue
    total += run_page(document, sys.argv[3] == "background" and "KAZ_TEST_ALONE" not in os.environ)
print(f"{total} examples ran")
sys.exit(0 if total else "no example was found")
