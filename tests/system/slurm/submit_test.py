#!/usr/bin/env python3
# A submission to Slurm that is interrupted: the job's number is not lost, and the job is submitted once.
# SPDX-License-Identifier: Apache-2.0
"""usage: submit_test.py KAZ

Stand-ins for sbatch and squeue: sbatch takes two seconds, and a signal to its process group ends it.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from compared import HANG_S, check  # noqa: E402

KAZ = str(pathlib.Path(sys.argv[1]).resolve())
SBATCH = """#!/bin/sh
here=$(dirname "$0")
printf '%s\\n' "$@" > "$here/arguments"
echo begun >> "$here/called"
sleep 2
echo "sbatch: warning: the job has no time limit" >&2
echo "42;somewhere"
echo submitted >> "$here/called"
"""


def begun(folder, out):
    environment = dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}")
    command = [KAZ, "evaluate", "stand", "--mcu", "native", "--episodes", "4", "--slurm", "2"]
    return subprocess.Popen([*command, "--out", str(out)], env=environment, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, start_new_session=True)


def wait_for(what, condition):
    until = time.monotonic() + HANG_S
    while not condition():
        check(time.monotonic() < until, f"waited in vain for {what}")
        time.sleep(0.05)


def submissions(folder):
    called = folder / "called"
    return called.read_text().split() if called.exists() else []


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for program, text in (("sbatch", SBATCH), ("squeue", "#!/bin/sh\necho RUNNING\n")):
            (folder / program).write_text(text)
            (folder / program).chmod(0o755)
        interrupted(folder, folder / "100%j")
        killed(folder, folder / "killed")
        refused(folder, folder / "back\\slash")


def interrupted(folder, out):
    """Ctrl-C in a terminal: the whole foreground process group gets the signal."""
    first = begun(folder, out)
    wait_for("sbatch", lambda: submissions(folder) == ["begun"])
    os.killpg(first.pid, signal.SIGINT)
    _, said = first.communicate(timeout=HANG_S)
    check(first.returncode == 130 and "job 42 continues" in said, f"interrupted: {first.returncode}, {said}")
    pattern = [line for line in (folder / "arguments").read_text().splitlines() if "--output=" in line]
    check(pattern == [f"--output={str(out).replace('%', '%%')}/slurm/%A_%a.out"], f"output is {pattern}")

    # The same command waits for that job, and a third at the same time is refused.
    second = begun(folder, out)
    said = second.stdout.readline()
    check(said == "job 42 is still running\n", f"the second call says: {said}")
    _, third = begun(folder, out).communicate(timeout=HANG_S)
    check("another run (process" in third, f"a second coordinator: {third}")
    second.send_signal(signal.SIGINT)
    second.communicate(timeout=HANG_S)
    check(submissions(folder) == ["begun", "submitted"], f"submitted: {submissions(folder)}")


def killed(folder, out):
    (folder / "called").unlink()
    first = begun(folder, out)
    wait_for("sbatch", lambda: submissions(folder) == ["begun"])
    first.kill()
    first.communicate()
    wait_for("the job's number", lambda: submissions(folder) == ["begun", "submitted"])
    second = begun(folder, out)
    said = second.stdout.readline()
    check(said == "job 42 is still running\n", f"after a kill: {said}")
    second.kill()
    second.communicate()


def refused(folder, out):
    first = begun(folder, out)
    _, said = first.communicate(timeout=HANG_S)
    check(first.returncode == 2 and "contains a backslash" in said,
          f"a backslash: {first.returncode}, {said}")
    check(not out.exists(), f"{out} was made")


main()
