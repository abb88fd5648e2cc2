#!/usr/bin/env python3
# Random C programs, compiled for the host and for the H8S, must give the same checksum.
# SPDX-License-Identifier: Apache-2.0
"""Random C programs by csmith, compiled for the host and for the H8S, must give the same checksum.

Each seed makes one program, without unions, bit-fields, packed structs and floats. At -O0 host and
emulator must agree. At -O2 a difference counts as the old compiler's when -O0 agrees and the reference
engine prints, counts and takes states exactly as the fast one does on the same object.

Verdicts stand in OUT/results.jsonl, one line a seed; a second run goes on behind them. What fails is kept in
OUT/SEED. Exit status 0: every program that counts passed.
"""

import argparse
import concurrent.futures
import errno
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
SAFE_MATH = [pathlib.Path("/usr/include/csmith/safe_math.h"),
             pathlib.Path("/usr/include/csmith-2.3.0/safe_math.h")]
SHAPE = ["--no-unions", "--no-bitfields", "--no-packed-struct", "--no-float", "--no-argc",
         "--no-inline-function", "--concise"]
SMALL = ["--max-funcs", "5", "--max-block-depth", "3", "--max-expr-complexity", "6",
         "--max-array-dim", "2", "--max-array-len-per-dim", "6"]
H8_CC = ["h8300-hms-gcc", "-ms", "-mint32", "-ffreestanding", "-std=gnu99", "-fno-strict-aliasing", "-w"]
HOST_CC = ["gcc", "-m32", "-O1", "-std=gnu99", "-fwrapv", "-fno-strict-aliasing", "-w"]
HOST_CPU_S = 1
# A kernel without 32-bit programs is helped out by this, some ten times as slow.
HOST_EMULATOR, HOST_EMULATOR_CPU_S = "qemu-i386", 10
HANG_S = 600.0  # of a busy machine


class Discard(Exception):
    """The program says nothing about the emulator."""


def run(command, **more):
    return subprocess.run(command, capture_output=True, text=True, timeout=HANG_S, check=False, **more)


def must(command):
    done = run(command)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stderr.strip()[-800:]}")
    return done


def limit_cpu(seconds):
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def run_on_host(program):
    try:
        return run([program], preexec_fn=lambda: limit_cpu(HOST_CPU_S))
    except OSError as error:
        if error.errno != errno.ENOEXEC:
            raise
    if not shutil.which(HOST_EMULATOR):
        raise SystemExit("run.py: this machine's kernel runs no 32-bit programs: install qemu-user")
    return run([HOST_EMULATOR, program], preexec_fn=lambda: limit_cpu(HOST_EMULATOR_CPU_S))


def safe_functions():
    """Name to text of each function of csmith's safe arithmetic that has no floats."""
    for path in SAFE_MATH:
        if path.exists():
            text = path.read_text()
            break
    else:
        raise SystemExit(f"run.py: no {SAFE_MATH[0]}: install libcsmith-dev")
    functions = {}
    for part in re.split(r"(?m)^STATIC ", text)[1:]:
        name = re.search(r"FUNC_NAME\((\w+)\)", part).group(1)
        body = part[:part.rindex("}") + 1]
        if "float" in body or "double" in body:
            continue
        body = body.replace(f"FUNC_NAME({name})", f"safe_{name}")
        body = re.sub(r"\bLOG_INDEX\b|\bLOG_EXEC\b", "", body)
        body = re.sub(r"\bUNDEFINED\b", "", body)
        functions["safe_" + name] = "static " + re.sub(r"\n\s*\n+", "\n", body) + "\n"
    return functions


def self_contained(text, functions):
    """The program with the header and the safe arithmetic it calls in its place."""
    used = sorted(set(re.findall(r"\bsafe_\w+", text)))
    header = (HERE / "csmith.h").read_text() + "".join(functions[name] for name in used)
    return text.replace('#include "csmith.h"', header, 1) + "\n"


class Runner:
    def __init__(self, args):
        self.args = args
        self.out = pathlib.Path(args.out)
        self.functions = safe_functions()
        self.common = self.out / "common"
        self.common.mkdir(parents=True, exist_ok=True)
        must(["h8300-hms-as", HERE / "start.s", "-o", self.common / "start.o"])
        must([*H8_CC, "-O0", "-c", HERE / "runtime.c", "-o", self.common / "runtime.o"])
        must([*HOST_CC, "-c", HERE / "host.c", "-o", self.common / "host.o"])

    def emulate(self, image, *options):
        done = run([self.args.kaz, "mcu", "run", "--flat", "--semihost", *options, image])
        return done.returncode, done.stdout, done.stderr

    def build(self, place, level):
        image = place / f"o{level}.x"
        must([*H8_CC, f"-O{level}", "-c", place / "program.c", "-o", place / f"o{level}.o"])
        must(["h8300-hms-ld", "-m", "h8300s", "-T", HERE / "flat.ld", self.common / "start.o",
              place / f"o{level}.o", self.common / "runtime.o", "-o", image])
        return image

    def judge(self, seed, place):
        """What became of one seed: ok, compiler, or an error."""
        place.mkdir(parents=True, exist_ok=True)
        shape = SHAPE + ([] if self.args.large else SMALL)
        made = run(["csmith", "--seed", str(seed), *shape], cwd=place)
        if made.returncode != 0:
            raise Discard("csmith made none")
        (place / "program.c").write_text(self_contained(made.stdout, self.functions))
        must([*HOST_CC, place / "program.c", self.common / "host.o", "-o", place / "host"])
        wanted = run_on_host(place / "host")
        if wanted.returncode < 0:
            raise Discard("takes long on the host")
        if wanted.returncode != 0:
            raise Discard(f"status {wanted.returncode} on the host")
        if wanted.stdout.strip("0\n") == "":
            raise Discard("has nothing to hash")
        image = self.build(place, 0)
        got = self.emulate(image)
        if got[:2] != (0, wanted.stdout):
            return f"-O0: {got} for {wanted.stdout!r}"
        image = self.build(place, 2)
        got = self.emulate(image, "--count")
        slow = self.emulate(image, "--count", "--engine", "reference")
        if got != slow:
            return f"-O2: {got} by the fast engine, {slow} by the reference"
        return "ok" if got[:2] == (0, wanted.stdout) else "compiler"

    def one(self, seed):
        place = self.out / str(seed)
        began = time.monotonic()
        try:
            verdict = self.judge(seed, place)
        except Discard as why:
            verdict = f"discarded: {why}"
        except subprocess.TimeoutExpired as late:
            verdict = f"time limit: {late.cmd[0]}"
        except RuntimeError as wrong:
            verdict = f"tool: {wrong}"
        keep = verdict != "ok" and not verdict.startswith("discarded")
        if not (keep or self.args.keep):
            shutil.rmtree(place, ignore_errors=True)
        return {"seed": seed, "verdict": verdict, "seconds": round(time.monotonic() - began, 2)}


def kind(verdict):
    return verdict if verdict in ("ok", "compiler") else verdict.split(":")[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kaz", required=True, help="the program kaz")
    parser.add_argument("--out", required=True, help="folder for results and failures")
    parser.add_argument("--count", type=int, default=100, help="programs that count (default 100)")
    parser.add_argument("--first", type=int, default=1, help="first seed (default 1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="side by side")
    parser.add_argument("--large", action="store_true", help="csmith's own sizes instead of small programs")
    parser.add_argument("--fresh", action="store_true", help="forget results of earlier runs")
    parser.add_argument("--keep", action="store_true", help="keep the files of programs that pass too")
    args = parser.parse_args()
    args.kaz = str(pathlib.Path(args.kaz).resolve())
    out = pathlib.Path(args.out)
    out.mkdir(parents=True, exist_ok=True)
    log = out / "results.jsonl"
    if args.fresh and log.exists():
        log.unlink()
    results = {}
    if log.exists():
        for line in log.read_text().splitlines():
            row = json.loads(line)
            results[row["seed"]] = row["verdict"]
    runner = Runner(args)
    tally = {}
    for verdict in results.values():
        tally[kind(verdict)] = tally.get(kind(verdict), 0) + 1

    def counted():
        return sum(n for name, n in tally.items() if name != "discarded")

    seeds = (seed for seed in iter_seeds(args.first) if seed not in results)
    shown = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool, log.open("a") as to:
        waiting = set()
        while counted() < args.count or waiting:
            while counted() + len(waiting) < args.count and len(waiting) < args.jobs:
                waiting.add(pool.submit(runner.one, next(seeds)))
            done, waiting = concurrent.futures.wait(
                waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in done:
                row = future.result()
                to.write(json.dumps(row) + "\n")
                to.flush()
                tally[kind(row["verdict"])] = tally.get(kind(row["verdict"]), 0) + 1
                if kind(row["verdict"]) not in ("ok", "compiler", "discarded"):
                    print(f"seed {row['seed']}: {row['verdict']}", flush=True)
            if time.monotonic() - shown > 10:
                shown = time.monotonic()
                print(f"{counted()} of {args.count}: {tally}", flush=True)
    wrong = counted() - tally.get("ok", 0) - tally.get("compiler", 0)
    print(f"{counted()} programs agree at -O0 but for {wrong}; "
          f"at -O2 {tally.get('compiler', 0)} differ by the compiler; "
          f"{tally.get('discarded', 0)} discarded")
    return 1 if wrong else 0


def iter_seeds(first):
    while True:
        yield first
        first += 1


if __name__ == "__main__":
    sys.exit(main())
