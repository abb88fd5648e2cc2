#!/usr/bin/env python3
# An evaluation on several hosts by GNU parallel, one of which is lost: the result is that of one machine.
# SPDX-License-Identifier: Apache-2.0
"""usage: hosts_test.py KAZ; ends with 77 where there is no GNU parallel.

The hosts are this machine: `:`, and names that a stand-in for ssh takes, which runs the command here.
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from compared import HANG_S, check, same_result  # noqa: E402

KAZ = str(pathlib.Path(sys.argv[1]).resolve())
COMMAND = ["evaluate", "stand", "--mcu", "native", "--episodes", "12"]
SSH = """#!/bin/sh
# Options of ssh, then the host, then the command.
while [ "${1#-}" != "$1" ]; do case $1 in -[lpio]) shift;; esac; shift; done
host=$1; shift
[ "$1" = -- ] && shift
echo "$host" >> "$(dirname "$0")/called"
[ "$host" = lost ] && exit 255
# sshd sets the login shell, with which parallel's wrapper begins the command.
SHELL=/bin/sh exec sh -c "$*"
"""


def kaz(environment, *words):
    return subprocess.run([KAZ, *words], env=environment, capture_output=True, text=True, timeout=HANG_S)


def main():
    version = subprocess.run(["parallel", "--version"], capture_output=True, text=True) if shutil.which(
        "parallel") else None
    if version is None or "GNU parallel" not in version.stdout:
        print("skipped: GNU parallel is not installed")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        run(pathlib.Path(name))


def run(folder):
    alone = kaz(dict(os.environ), *COMMAND, "--jobs", "2", "--out", str(folder / "alone"))
    check(alone.returncode == 0, f"alone: {alone.stderr}")
    ssh = folder / "ssh"
    ssh.write_text(SSH)
    ssh.chmod(0o755)
    environment = dict(os.environ, PARALLEL_SSH=str(ssh), PARALLEL_HOME=str(folder), HOME=str(folder))
    environment.pop("SHELL", None)  # as where a service or a container begins it
    hosts = folder / "hosts"
    hosts.write_text("1/:\n1/near\n1/lost\n")
    # A name in which shells and parallel find words, a command, a variable and replacement strings.
    many = folder / "many 'hosts\";touch PLANTED;true {} {#} {= $_ = 1 =} $HOME\\ \n%"
    words = [*COMMAND, "--parallel-hosts", str(hosts), "--parallel-tasks", "6", "--out", str(many)]

    # Ctrl-C ends what runs; parts that are there stay, and the same command runs the rest.
    begun = subprocess.Popen([KAZ, *words], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             text=True)
    until = time.monotonic() + HANG_S
    while not list(many.glob("parts/[0-9]")) and time.monotonic() < until and begun.poll() is None:
        time.sleep(0.02)
    begun.send_signal(signal.SIGINT)
    _, said = begun.communicate(timeout=HANG_S)
    check(begun.returncode == 130 and "continues" in said, f"interrupted: {begun.returncode}, {said}")
    kept = {path: path.stat().st_mtime_ns for path in many.glob("parts/[0-9]/result.json")}
    whole = kaz(environment, *words)
    check(whole.returncode == 0, f"on hosts: {whole.returncode}: {whole.stdout} {whole.stderr}")
    same_result(folder / "alone", many)
    check(not list(pathlib.Path(".").glob("PLANTED*")) and not list(folder.glob("PLANTED*")),
          "a part of the folder's name was run as a command")
    called = (folder / "called").read_text().split()
    check("near" in called and "lost" in called, f"hosts called: {called}")
    for path, when in kept.items():
        check(path.stat().st_mtime_ns == when, f"{path} was made again")
    parts = sorted(path.name for path in (many / "parts").iterdir())
    check(parts == [str(i) for i in range(1, 7)], f"parts are {parts}")

    again = kaz(environment, *words)
    check(again.returncode == 0, f"again: {again.stderr}")
    other = kaz(environment, *COMMAND, "--seed", "9", *words[len(COMMAND):])
    check(other.returncode == 2 and "another evaluation" in other.stderr, f"other options: {other.stderr}")

    # Tasks that end without a result, no parallel, no file.
    to = ["--parallel-hosts", str(hosts), "--parallel-tasks", "2", "--out"]
    hosts.write_text("2/:\n")
    failing = kaz(dict(environment, KAZ_DATA="/nowhere"), *COMMAND, *to, str(folder / "failing"))
    check(failing.returncode == 3 and "ended without a result" in failing.stderr,
          f"failing: {failing.returncode} {failing.stderr}")
    check((folder / "failing/parallel/out").read_text().strip(), "nothing says why they failed")
    nobody = kaz(dict(environment, PATH="/nowhere"), *COMMAND, *to, str(folder / "nobody"))
    check(nobody.returncode == 3 and "needs the command parallel" in nobody.stderr,
          f"without parallel: {nobody.returncode} {nobody.stderr}")
    hosts.unlink()
    none = kaz(environment, *COMMAND, *to, str(folder / "none"))
    check(none.returncode == 2 and "hosts" in none.stderr, f"without hosts: {none.returncode} {none.stderr}")
    print("12 episodes in 6 tasks on three hosts, one of them lost: as on one machine")


main()
