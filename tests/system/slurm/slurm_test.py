#!/usr/bin/env python3
# An evaluation on a real Slurm of two nodes, one of which loses its power: the result is that of one machine.
# SPDX-License-Identifier: Apache-2.0
"""usage: slurm_test.py KAZ [EPISODES TASKS KILLS]; ends with 77 where no Slurm can run.

With numbers: the nodes share the processors, and one is killed so many times while it has tasks.
Prints what the cluster costs.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import cluster  # noqa: E402
from compared import HANG_S, check, same_result  # noqa: E402

KAZ = str(pathlib.Path(sys.argv[1]).resolve())
LONG = len(sys.argv) > 2
EPISODES, TASKS, KILLS = (int(word) for word in sys.argv[2:5]) if LONG else (24, 8, 1)
PROCESSORS = max(1, os.cpu_count() // 2) if LONG else 0
COMMAND = ["evaluate", "stand", "--mcu", "native", "--episodes", str(EPISODES)]


def kaz(environment, *words, **more):
    return subprocess.run([KAZ, *words], env=environment, capture_output=True, text=True,
                          timeout=20000 if LONG else HANG_S, **more)


def begun(slurm, words):
    return subprocess.Popen([KAZ, *words], env=slurm.environment, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            made = cluster.Cluster(folder / "slurm", PROCESSORS)
            with made as slurm:
                run(slurm, folder)
        except cluster.Unavailable as why:
            print(f"skipped: no Slurm can run here: {why}")
            sys.exit(77)


def run(slurm, folder):
    begun_at = time.monotonic()
    alone = kaz(dict(os.environ), *COMMAND, "--jobs", "2", "--out", str(folder / "alone"))
    check(alone.returncode == 0, f"alone: {alone.stderr}")
    alone_s = time.monotonic() - begun_at
    begun_at = time.monotonic()

    # Ctrl-C ends the waiting and not the tasks; the same command waits again.
    # In the name of an output file, %j is a symbol of Slurm's.
    array = folder / "array 100%j"
    words = [*COMMAND, "--slurm", str(TASKS), "--out", str(array)]
    waiting = begun(slurm, words)
    first = waiting.stdout.readline()
    check("job " in first, f"the job has no number: {first} {waiting.stderr.read() if not first else str()}")
    waiting.send_signal(signal.SIGINT)
    _, said = waiting.communicate(timeout=HANG_S)
    check(waiting.returncode == 130 and "continues" in said, f"interrupted: {waiting.returncode}, {said}")

    waiting = begun(slurm, words)
    first = waiting.stdout.readline()
    check("is still running" in first, f"the second call says: {first}")
    # A node loses its power while it has tasks; they are requeued, to the other, or to it when it is back.
    killed, until = 0, time.monotonic() + (20000 if LONG else HANG_S)
    while killed < KILLS and time.monotonic() < until and waiting.poll() is None:
        if "k2" in slurm.run("squeue", "-h", "-t", "R", "-o", "%N").stdout:
            time.sleep(20 if LONG else 0)  # amid its work
            slurm.kill_node("k2")
            slurm.start_node("k2")
            killed += 1
            print("k2 lost its power while it had a task", flush=True)
        time.sleep(0.05)
    check(killed == KILLS or not LONG, f"k2 was killed {killed} times only")
    out, said = waiting.communicate(timeout=20000 if LONG else HANG_S)
    check(waiting.returncode == 0, f"on Slurm: {waiting.returncode}: {out} {said}")
    print(f"alone {alone_s:.1f} s, on two nodes {time.monotonic() - begun_at:.1f} s", flush=True)
    same_result(folder / "alone", array)
    parts = sorted(path.name for path in (array / "parts").iterdir() if "." not in path.name)
    check(parts == sorted(str(i) for i in range(1, TASKS + 1)), f"parts are {parts}")
    check(list((array / "slurm").glob("*_1.out")), f"no output of task 1 in {array}/slurm")

    # All is there: the same command only merges. Another one is refused.
    again = kaz(slurm.environment, *words)
    check(again.returncode == 0 and "job " not in again.stdout, f"again: {again.stdout} {again.stderr}")
    other = kaz(slurm.environment, *COMMAND, "--seed", "9", "--slurm", str(TASKS), "--out", str(array))
    check(other.returncode == 2 and "another evaluation" in other.stderr, f"other options: {other.stderr}")

    # What sbatch refuses, and tasks that end without a result.
    refused = kaz(slurm.environment, *COMMAND, "--slurm", "2", "--sbatch", "--partition=none", "--out",
                  str(folder / "refused"))
    check(refused.returncode == 3 and "sbatch refused" in refused.stderr, f"refused: {refused.stderr}")
    failing = kaz(slurm.environment, *COMMAND, "--slurm", "2", "--sbatch", "--export=KAZ_DATA=/nowhere",
                  "--out",
                  str(folder / "failing"))
    check(failing.returncode == 3 and "ended without a result" in failing.stderr,
          f"failing: {failing.stderr}")
    nobody = kaz(dict(os.environ, PATH="/nowhere"), *COMMAND, "--slurm", "2", "--out", str(folder / "nobody"))
    check(nobody.returncode == 3, f"without sbatch: {nobody.returncode} {nobody.stderr}")
    print(f"{EPISODES} episodes in {TASKS} tasks on two nodes: as on one machine")


main()
