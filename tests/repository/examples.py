# Runs each command that README.md and docs/ show in a block marked `sh`, in a folder of its own, with the
# program on the PATH, and Debian's own Python before others. A block marked `sh background` runs beside those
# that follow it in the same file.
# SPDX-License-Identifier: Apache-2.0
"""usage: examples.py ROOT BIN background|others: the pages that have a block of that kind, or none"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

ROOT, BIN = pathlib.Path(sys.argv[1]), sys.argv[2]
HANG_S = 1200  # of a busy machine
BLOCK = re.compile(r"^```sh( background)?\n(.*?)^```$", re.M | re.S)


def wait_until_ready(output):
    """Returns at the line with which kaz says so."""
    for line in output:
        print(line, end="", flush=True)
        if line.startswith("ready: "):
            return
    sys.exit("the program in the background ended")


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
                sys.exit(f"{path.relative_to(ROOT)}: the example above ended with "
                         f"{done.returncode}")
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
    with tempfile.TemporaryDirectory() as scratch:
        total += run_file(document, scratch)
print(f"{total} examples ran")
sys.exit(0 if total else "no example was found")
