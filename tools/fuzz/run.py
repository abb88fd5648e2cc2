# Runs the fuzz targets of targets.txt, several at a time, and writes their table.
# SPDX-License-Identifier: Apache-2.0
"""usage: run.py [SECONDS | --each SECONDS] [--only NAME[,NAME...]] [--jobs N] [--build FOLDER] [--out FOLDER]
              [--table | --status]

Runs N targets at a time. SECONDS of N cores are divided equally between the targets; --each is the time of
each target. Both are CPU time: beside other programs a target runs for longer, not for less.

OUT/runs.jsonl records CPU time and executions of each target every minute, with the target's version: a
hash of the code of its parsers and of its own, without comments, includes and messages. A target that has
had its time in its present version is not run again. The same command thus continues an interrupted
campaign, and more SECONDS extend it. The corpus in OUT/NAME grows from run to run. A failing input stays in
OUT/NAME-crash-* and the like, its log in OUT/NAME-found-*.log, and the other targets go on. --status lists
the recorded time. --table measures how much of each parser the corpora and the seeds reach, and writes the
targets' rows of docs/results/fuzz-campaign.csv.

Exit status: 0 nothing found, 1 something found, also if interrupted, 2 wrong arguments, 3 a program is
missing, 130 interrupted, nothing found."""

import argparse
import csv
import functools
import hashlib
import json
import math
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import time

# Exit statuses without a finding: the end, after SIGINT, and SIGUSR1 before libFuzzer handles it.
QUIET = (0, 72, -signal.SIGUSR1)
# By another program or the kernel: libFuzzer reports a finding with a status of its own.
KILLED = (-signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT)
ROOT = pathlib.Path(__file__).resolve().parents[2]
MANIFEST = ROOT / "tools/fuzz/targets.txt"
TABLE = ROOT / "docs/results/fuzz-campaign.csv"
# Many targets write each case to a file, and ext4 waits for the disk when a truncated file is closed.
MEMORY = "/dev/shm"
ENVIRONMENT = dict(os.environ)
if os.access(MEMORY, os.W_OK):
    ENVIRONMENT.setdefault("TMPDIR", MEMORY)
PROGRESS_S = 60
# libFuzzer's limit is wall time: this many times the CPU time, it only matters if run.py is killed.
WALL_PER_CPU = 20
COLUMNS = ["target", "version", "executions", "cpu_min", "parsers"]


def manifest():
    targets, reads = {}, {}
    for line in MANIFEST.read_text().splitlines():
        words = line.split()
        if words[:1] == ["target"]:
            targets[words[1]] = {"seeds": ROOT / words[2], "program": words[3], "arguments": words[4:]}
        elif words[:1] == ["reads"]:
            reads[words[1]] = line.partition(" (")[0].split()[2:]
    return targets, reads


TOKEN = re.compile(rb"""R"(?P<d>[^()\\\s]{0,16})\(.*?\)(?P=d)"|\b\d[\w.]*(?:'\w+[\w.]*)*"""
                   rb"""|'(?:[^'\\\n]|\\.)+'|(?P<text>(?:"(?:[^"\\\n]|\\.)*"\s*)+)""", re.DOTALL)
WORDS = re.compile(rb"[a-z] [a-z]")
END_OF_FUNCTION = b"\0"


@functools.cache
def code(path):
    """The file without comments, layout, includes and words: a change of these needs no new campaign."""
    bare = subprocess.run(["g++", "-fpreprocessed", "-dD", "-E", "-P", "-x", "c++", path],
                          capture_output=True, check=True).stdout
    bare = re.sub(rb"^#include .*(?<!\.def\")$", b"", bare, flags=re.M)
    bare = re.sub(rb"^}$", b"}" + END_OF_FUNCTION, bare, flags=re.M)
    # A text with two words in a row is a part of a message.
    words = b" ".join(TOKEN.sub(without_words, bare).split())
    return re.sub(rb" ?([(){},;?:+=]) ?", rb"\1", words)


def without_words(token):
    joined = re.sub(rb'(?<!\\)"\s*"', b"", token[0])
    return b'"" ' if token["text"] and WORDS.search(joined) else token[0]


def version(name, target, reads):
    """Hash of what a campaign of the target is evidence for: the code of its parsers and its own."""
    folder = target["seeds"]
    while folder.name != "seeds":
        folder = folder.parent
    own = [code(path) for path in [*folder.parent.glob("*.cpp"), *folder.parent.glob("*.h")]]
    start = f"Complaint try_{name}(Bytes bytes){{".encode()
    # The functions of other targets in the same file do not belong to it.
    other = rb" ?Complaint try_(?!%s\()[^\0]*\0" % name.encode()
    own = [re.sub(other, b"", text) for text in own if start in text] or own
    parsers = [code(ROOT / file) for file, used in reads.items() if name in used]
    # Sorted by content: a file may move.
    content = b"".join(sorted(hashlib.sha256(text).digest() for text in [*own, *parsers]))
    return hashlib.sha256(content).hexdigest()[:8]


def recorded(options, targets):
    """What each target has had in its present version."""
    sums = {name: {"cpu_s": 0.0, "executions": 0} for name in targets}
    runs = options.out / "runs.jsonl"
    for line in runs.read_text().splitlines() if runs.exists() else []:
        run = json.loads(line)
        if run["target"] in targets and run.get("version") == targets[run["target"]]["version"]:
            for key in sums[run["target"]]:
                sums[run["target"]][key] += run[key]
    return sums


def last(pattern, text, default=0):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else default


def children_cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Run:
    """One running target."""

    def __init__(self, name, target, options, seconds):
        self.name, self.began, self.cpu_s = name, time.monotonic(), 0.0
        self.version, self.budget_s, self.is_stopping = target["version"], seconds, False
        self.recorded = {"cpu_s": 0.0, "executions": 0}
        self.program = [options.build / "bin" / target["program"], *target["arguments"]]
        self.out, self.before = options.out, set(options.out.glob(f"{name}-*"))
        corpus = options.out / name
        corpus.mkdir(parents=True, exist_ok=True)
        self.log_path = options.out / f"{name}.log"
        self.log = self.log_path.open("wb")
        command = [*self.program,
                   f"-max_total_time={math.ceil(WALL_PER_CPU * seconds)}", "-timeout=300",
                   "-rss_limit_mb=3000", "-print_final_stats=1",
                   f"-artifact_prefix={options.out}/{name}-", corpus, target["seeds"]]
        # Its own group: Ctrl-C reaches it through stop() alone.
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=self.log,
                                        stderr=subprocess.STDOUT, start_new_session=True, env=ENVIRONMENT)

    def has_ended(self):
        """poll() reaps one process alone, so what it adds to the children's CPU time is this run's."""
        before = children_cpu_s()
        if self.process.poll() is None:
            return False
        self.cpu_s = children_cpu_s() - before
        return True

    def cpu_until_now(self):
        """Of a process that runs."""
        try:
            fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return self.cpu_s
        return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")  # utime, stime, cutime, cstime

    def stop_when_used(self):
        """libFuzzer ends after the present case, with 0."""
        if not self.is_stopping and self.cpu_until_now() >= self.budget_s:
            self.is_stopping = True
            self.process.send_signal(signal.SIGUSR1)

    def record(self, cpu_s, executions, **more):
        """The part since the last call, in runs.jsonl."""
        now = {"cpu_s": round(cpu_s, 1), "executions": executions}
        part = {key: round(max(0, now[key] - self.recorded[key]), 1) for key in now}
        self.recorded = now
        with (self.out / "runs.jsonl").open("a") as runs:
            runs.write(json.dumps({"target": self.name, "version": self.version, **part, **more}) + "\n")

    def executions_until_now(self):
        text = self.log_text()
        return (last(r"stat::number_of_executed_units:\s*(\d+)", text) or last(r"(?m)^#(\d+)\s", text))

    def log_text(self):
        with self.log_path.open("rb") as log:
            log.seek(max(0, self.log_path.stat().st_size - 200_000))
            return log.read().decode(errors="replace")

    def stop(self):
        if not self.has_ended():
            os.killpg(self.process.pid, signal.SIGINT)
            before = children_cpu_s()
            self.process.wait()
            self.cpu_s = children_cpu_s() - before

    def was_only_slow(self):
        """Whether all that was found are cases that took too long beside other programs, but not alone."""
        cases = set(self.out.glob(f"{self.name}-*")) - self.before
        if not cases or not all(case.name.startswith(f"{self.name}-timeout-") for case in cases):
            return False
        for case in cases:
            # Also its own group: an interruption must not look like a slow case.
            command = [*self.program, "-timeout=600", f"-artifact_prefix={self.out}/{self.name}-", case]
            alone = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
            if alone.returncode != 0:
                return False
        for case in cases:
            case.unlink()
        return True

    def keep_log(self):
        """The next run of the target writes its log anew."""
        kept = self.out / f"{self.name}-found-{time.strftime('%Y%m%d-%H%M%S')}-{self.process.pid}.log"
        kept.write_bytes(self.log_path.read_bytes())

    def result(self):
        self.log.close()
        found = self.process.returncode not in (*QUIET, *KILLED)
        return {"target": self.name, "seconds": round(time.monotonic() - self.began, 1),
                "cpu_s": round(self.cpu_s, 1), "executions": self.executions_until_now(),
                "edges": last(r" cov: (\d+)", self.log_text()), "found": found}


def fuzz(options, targets):
    # At least a second each, and no more than asked for in all.
    share = options.each or max(1, options.seconds * options.jobs // len(targets))
    done = recorded(options, targets)
    left = {name: share - done[name]["cpu_s"] for name in targets}  # of each target's CPU time, s
    waiting = [name for name in targets if left[name] >= 1]
    print(f"{len(targets)} targets, {share} s of CPU time each, {options.jobs} at a time; "
          f"{len(targets) - len(waiting)} have had it; corpora and logs in {options.out}", flush=True)
    running, results, interrupted, ended = [], [], [], set(targets) - set(waiting)
    shown = time.monotonic()

    def finish(run):
        running.remove(run)
        result = run.result()
        left[run.name] -= result["cpu_s"]
        if result["found"] and not interrupted and run.was_only_slow():
            result["found"] = False
            print(f"{run.name}: a case took over 300 s beside other programs, alone it ends in time",
                  flush=True)
        goes_on = not result["found"] and not interrupted and left[run.name] >= 1 and result["cpu_s"] > 0
        if goes_on:
            running.append(Run(run.name, targets[run.name], options, left[run.name]))
        else:
            ended.add(run.name)
        results.append(result)
        run.record(**{key: result[key] for key in ("cpu_s", "executions", "edges", "found")})
        outcome = ("FOUND SOMETHING" if result["found"] else
                   "killed" if run.process.returncode in KILLED else "nothing found")
        print(f"[{len(ended):2}/{len(targets)}] {run.name:14} {result['seconds']:6.0f} s, "
              f"CPU {result['cpu_s']:5.0f} s {result['executions']:>11,} runs {result['edges']:>6} edges  "
              f"{outcome}{', goes on' if goes_on else ''}", flush=True)
        if result["found"]:
            run.keep_log()
            tail = run.log_path.read_text(errors="replace").splitlines()[-12:]
            print("\n".join("    " + line[:160] for line in tail), flush=True)

    def show(run):
        cpu_s, executions = run.cpu_until_now(), run.executions_until_now()
        run.record(cpu_s, executions)
        print(f"[{len(ended):2}/{len(targets)}] {run.name:14} CPU {share - left[run.name] + cpu_s:5.0f} of "
              f"{share} s {executions:>11,} runs", flush=True)

    # No exception: it would lose a run that has just ended and is being judged.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: interrupted.append(True))
    while not interrupted and (waiting or running):
        while not interrupted and waiting and len(running) < options.jobs:
            name = waiting.pop(0)
            running.append(Run(name, targets[name], options, left[name]))
        for run in running[:]:
            if run.has_ended():
                finish(run)
            else:
                run.stop_when_used()
        if time.monotonic() - shown >= PROGRESS_S:
            shown = time.monotonic()
            for run in running:
                show(run)
        time.sleep(0.2)
    for run in running[:]:
        run.stop()
        finish(run)
    found = [result["target"] for result in results if result["found"]]
    total = sum(result["executions"] for result in results)
    print(f"{total:,} runs of {len({result['target'] for result in results})} targets, "
          f"{sum(result['seconds'] for result in results) / 3600:.2f} hours in all, "
          f"{sum(result['cpu_s'] for result in results) / 3600:.2f} of CPU time")
    if found:
        print(f"found something: {', '.join(found)}; the inputs are {options.out}/NAME-*, logs beside "
              "them: keep each in the seeds of its target, with the correction")
        return 1
    return 130 if interrupted else 0


def coverage(options, name, target):
    """By file of the tree: functions reached, all, their edges reached, all; over corpus and seeds."""
    corpus = options.out / name
    folders = [target["seeds"], *([corpus] if corpus.is_dir() else [])]
    done = subprocess.run([options.build / "bin" / target["program"], *target["arguments"], "-runs=0",
                           "-print_coverage=1", "-timeout=300",
                           f"-artifact_prefix={options.out}/{name}-coverage-", *folders],
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
    if done.returncode != 0:
        sys.exit(f"target {name} ended with {done.returncode} on its own corpus: run ./tools/dev fuzz first")
    sums = {}
    for reached, of, path in re.findall(
            r"^(?:UN)?COVERED_FUNC: hits: \d+ edges: (\d+)/(\d+) .* (/\S+?):\d+(?::\d+)?$", done.stderr,
            re.M):
        path = pathlib.Path(os.path.normpath(path))
        if ROOT in path.parents:
            file = path.relative_to(ROOT).as_posix()
            more = (1 if int(reached) else 0, 1, int(reached), int(of))
            sums[file] = tuple(a + b for a, b in zip(sums.get(file, (0, 0, 0, 0)), more))
    return sums


def reached(file, sums):
    if sums[1]:
        return f"{file} {sums[0]}/{sums[1]} {100 * sums[2] / sums[3]:.0f} %"
    return f"{file} {'emulated' if file.startswith('firmware/') else 'inlined'}"


def write_table(options, targets, reads, all_targets):
    with TABLE.open(newline="") as table:
        rows = {row["target"]: row for row in csv.DictReader(table)}
    done = recorded(options, targets)
    for number, (name, target) in enumerate(targets.items(), 1):
        print(f"[{number:2}/{len(targets)}] {name}", flush=True)
        sums = coverage(options, name, target)
        parsers = "; ".join(reached(file, sums.get(file, (0, 0, 0, 0)))
                            for file, used in reads.items() if name in used)
        measured = target["version"] if done[name]["executions"] else "none"
        rows[name] = dict(zip(COLUMNS, (name, measured, done[name]["executions"],
                                        f"{done[name]['cpu_s'] / 60:.1f}", parsers)))
    with TABLE.open("w", newline="") as table:
        writer = csv.DictWriter(table, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[name] for name in all_targets if name in rows)
    print(f"{TABLE}: rows of {', '.join(targets)}")
    return 0


def show_status(options, targets):
    for name, sums in recorded(options, targets).items():
        print(f"{name:14} {targets[name]['version']} CPU {sums['cpu_s']:7.0f} s "
              f"{sums['executions']:>13,} runs")
    return 0


def main():
    parser = argparse.ArgumentParser(prog="./tools/dev fuzz",
                                     description="Fuzzes the parsers of external bytes.")
    parser.add_argument("seconds", nargs="?", type=int, default=600)
    parser.add_argument("--each", type=int, metavar="SECONDS", help="CPU time of each target")
    parser.add_argument("--only", default="", metavar="NAME[,NAME]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/fuzz")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/fuzz")
    parser.add_argument("--table", action="store_true",
                        help="write the targets' rows of docs/results/fuzz-campaign.csv")
    parser.add_argument("--status", action="store_true", help="list the CPU time of each target so far")
    parser.add_argument("--programs", action="store_true",
                        help="print the names of the programs to build, and exit")
    options = parser.parse_args()
    all_targets, reads = manifest()
    targets = all_targets
    for name, target in targets.items():
        target["version"] = version(name, target, reads)
    if options.only:
        wanted = options.only.split(",")
        for name in wanted:
            if name not in targets:
                parser.error(f"there is no target '{name}'; give one of {', '.join(targets)}")
        targets = {name: targets[name] for name in wanted}
    if options.programs:
        print("\n".join(dict.fromkeys(target["program"] for target in targets.values())))
        return 0
    if options.seconds < 1 or options.jobs < 1 or options.each is not None and options.each < 1:
        parser.error("SECONDS, --each and --jobs must be at least 1")
    if options.status:
        return show_status(options, targets)
    for target in targets.values():
        program = options.build / "bin" / target["program"]
        if not program.exists():
            print(f"{program} is missing: ./tools/dev fuzz builds it", file=sys.stderr)
            return 3
    options.out.mkdir(parents=True, exist_ok=True)
    return write_table(options, targets, reads, all_targets) if options.table else fuzz(options, targets)


if __name__ == "__main__":
    sys.exit(main())
