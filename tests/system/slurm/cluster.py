#!/usr/bin/env python3
# A real Slurm of two nodes on this machine, as root, without systemd: for tests, and to try.
# SPDX-License-Identifier: Apache-2.0
"""usage: cluster.py FOLDER     until Ctrl-C; then in another terminal: export SLURM_CONF=FOLDER/slurm.conf

Needs root and Debian's slurmctld, slurmd, slurm-client, munge. Nothing outside of FOLDER is changed.
"""

import os
import pathlib
import signal
import socket
import subprocess
import sys
import time

from compared import HANG_S

NODES = ("k1", "k2")
CONFIGURATION = """
ClusterName=kaz
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
ReturnToService=2
MailProg=/bin/true
MaxArraySize=100001
MaxJobCount=100000
KillWait=2
SlurmdTimeout=30
NodeName=k[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{second}] CPUs={cpus} State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class Unavailable(Exception):
    """No Slurm can run here; the text says why."""


def free_ports(count):
    probes = [socket.socket() for _ in range(count)]
    try:
        for probe in probes:
            probe.bind(("127.0.0.1", 0))
        return [probe.getsockname()[1] for probe in probes]
    finally:
        for probe in probes:
            probe.close()


class Cluster:
    def __init__(self, folder, processors=0):
        """processors: of a node; 0: all of this machine, which the nodes then have twice."""
        self.processors = processors or os.cpu_count()
        self.folder = pathlib.Path(folder).resolve()
        self.processes = {}
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))
        if os.geteuid() != 0:
            raise Unavailable("not root")
        for program in ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol"):
            if not any(os.access(f"{place}/{program}", os.X_OK) for place in ("/usr/sbin", "/usr/bin")):
                raise Unavailable(f"{program} is not installed (slurmctld slurmd slurm-client munge)")

    def __enter__(self):
        self.folder.mkdir(parents=True, exist_ok=True)
        os.chmod(self.folder, 0o755)
        (self.folder / "state").mkdir(exist_ok=True)
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        ports = free_ports(3)
        # slurmd refuses more processors than there are.
        text = CONFIGURATION.format(host=socket.gethostname(), folder=self.folder, port=ports[0],
                                    first=ports[1], second=ports[2], cpus=self.processors)
        if ports[2] != ports[1] + 1:
            text = text.replace(f"Port=[{ports[1]}-{ports[2]}]", f"Port=[{ports[1]},{ports[2]}]")
        (self.folder / "slurm.conf").write_text(text)
        try:
            self._start("munged", "munged", "--foreground", "--force", f"--key-file={key}",
                        f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munged.pid",
                        f"--log-file={self.folder}/munged.log", f"--seed-file={self.folder}/munged.seed")
            self._wait("munge's socket", lambda: (self.folder / "munge.socket").exists())
            self._start("slurmctld", "slurmctld", "-D", "-c")
            for node in NODES:
                self.start_node(node)
            self._wait("two idle nodes", self._both_idle)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in reversed(list(self.processes)):
            self.stop(name)

    def _both_idle(self):
        return self.run("sinfo", "-h", "-o", "%D %t").stdout.split() == ["2", "idle"]

    def _start(self, name, *command):
        log = open(self.folder / f"{name}.out", "ab")
        self.processes[name] = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log,
                                                stdin=subprocess.DEVNULL, start_new_session=True)
        log.close()

    def _wait(self, what, condition, seconds=HANG_S):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if condition():
                return
            ended = [name for name, process in self.processes.items() if process.poll() is not None]
            if ended:
                text = (self.folder / f"{ended[0]}.out").read_text(errors="replace")[-300:]
                raise Unavailable(f"{ended[0]} ended: {text.strip()}")
            time.sleep(0.2)
        raise Unavailable(f"waited {seconds} s in vain for {what}")

    def start_node(self, node):
        (self.folder / f"spool-{node}").mkdir(exist_ok=True)
        self._start(f"slurmd-{node}", "slurmd", "-D", "-N", node)

    def run(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=HANG_S)

    def stop(self, name):
        process = self.processes.pop(name)
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def kill_node(self, node):
        """As when its power goes: the daemon, and all that it has started, at once."""
        for pid in self._descendants(self.processes[f"slurmd-{node}"].pid, node):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.processes.pop(f"slurmd-{node}").wait()
        self.run("scontrol", "update", f"nodename={node}", "state=down", "reason=power")

    def _descendants(self, root, node):
        """The daemon; the steps of this node, which are no children of it, by SLURMD_NODENAME."""
        found = [root]
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (folder / "environ").read_bytes()
                command = (folder / "cmdline").read_bytes()
            except OSError:
                continue
            mine = str(self.folder).encode() in environment
            if mine and f"SLURMD_NODENAME={node}".encode() in environment.split(b"\0"):
                found.append(int(folder.name))
            elif mine and b"slurmstepd" in command and self._parent_has(folder, found):
                found.append(int(folder.name))
        return found

    @staticmethod
    def _parent_has(folder, found):
        stat = (folder / "stat").read_text()
        return int(stat[stat.rindex(")") + 2:].split()[1]) in found


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    try:
        with Cluster(sys.argv[1]) as cluster:
            print(f"two nodes are idle (Ctrl-C ends them); export SLURM_CONF={cluster.folder}/slurm.conf",
                  flush=True)
            signal.pause()
    except KeyboardInterrupt:
        pass
    except Unavailable as why:
        sys.exit(f"cluster.py: {why}")


if __name__ == "__main__":
    main()
