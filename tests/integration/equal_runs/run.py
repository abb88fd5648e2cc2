# The same seed many times, under different circumstances: every recording must have the same bytes.
# SPDX-License-Identifier: Apache-2.0
"""Runs `kaz run` N times with one seed and compares the recordings byte for byte.

The circumstances change from run to run: alone; beside busy processes, two for each core; with the virtual
robot saved, moved on and restored during the run; both. Where two recordings differ both are kept, and the
first byte that differs is printed. Exit status 0: all equal; 1: not.
"""
import argparse
import hashlib
import itertools
import os
import pathlib
import shutil
import subprocess
import sys
import time

CIRCUMSTANCES = [("alone", False, None), ("busy", True, None), ("restored", False, "0.37"),
                 ("busy, restored", True, "0.61")]
BUSY = "while True: sum(range(10000))"


class Busy:
    """Keeps all cores busy, with two processes for each."""

    def __init__(self, wanted):
        self.wanted = wanted
        self.processes = []

    def __enter__(self):
        if self.wanted:
            count = 2 * (os.cpu_count() or 1)
            self.processes = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(count)]

    def __exit__(self, *_):
        for process in self.processes:
            process.kill()
            process.wait()


def record(options, folder, circumstance):
    """One run; the path of its recording and its SHA-256."""
    name, busy, restore_every = circumstance
    command = [options.kaz, "run", options.behavior, "--mcu", options.mcu, "--seed",
               str(options.seed), "--out", str(folder), "--json"]
    if options.duration:
        command += ["--duration", options.duration]
    if restore_every:
        command += ["--restore-every", restore_every]
    with Busy(busy):
        done = subprocess.run(command, capture_output=True, text=True)
    recording = folder / "recording.mcap"
    if done.returncode not in (0, 1) or not recording.exists():
        sys.exit(f"the run ({name}) failed with {done.returncode}: {done.stderr.strip()}")
    return recording, hashlib.sha256(recording.read_bytes()).hexdigest()


def first_difference(a, b):
    one, other = a.read_bytes(), b.read_bytes()
    pairs = itertools.zip_longest(one, other)
    return next(at for at, (x, y) in enumerate(pairs) if x != y)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kaz", required=True, help="the program")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder for recordings")
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--behavior", default="track-ball")
    parser.add_argument("--duration", default="", help="seconds, for behaviors that take them")
    parser.add_argument("--mcu", default="h8")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.runs < 2:
        parser.error("--runs: two at least, or there is nothing to compare")

    shutil.rmtree(options.out, ignore_errors=True)
    first = wanted = None
    different = 0
    for k in range(options.runs):
        circumstance = CIRCUMSTANCES[k % len(CIRCUMSTANCES)]
        start = time.monotonic()
        folder = options.out / f"{k + 1:02}"
        recording, digest = record(options, folder, circumstance)
        size = recording.stat().st_size
        verdict = "equal"
        if first is None:
            first, wanted, verdict = recording, digest, "the one to compare with"
        elif digest != wanted:
            different += 1
            verdict = f"DIFFERENT from byte {first_difference(first, recording)} on; kept"
        else:
            shutil.rmtree(folder)
        print(f"{k + 1:3} of {options.runs}  {digest}  {size / 1e6:.1f} MB  "
              f"{time.monotonic() - start:5.1f} s  {circumstance[0]}: {verdict}", flush=True)
    if different:
        print(f"NOT EQUAL: {different} of {options.runs} recordings differ from the first; "
              f"they are in {options.out}")
        return 1
    print(f"equal: {options.runs} recordings, byte for byte")
    return 0


sys.exit(main())
