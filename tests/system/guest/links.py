# The behaviors' own program against the emulated board, over each kind of link and the kernel's video.
# SPDX-License-Identifier: Apache-2.0
"""The virtual robot runs outside of a virtual machine and follows its clock; in the machine the same
executable as outside is the host, with the kernel's drivers below it. Exit status: 0 passed, 1 failed, 77
something is missing (it says what)."""

import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import boards  # noqa: E402
import kernel_can  # noqa: E402
import losses  # noqa: E402
import machine  # noqa: E402
from robot_guest import LINKS, in_guest, link_of, outside  # noqa: E402

NAMES = {"lockstep": "in one process", "pty": "in real time, two processes",
         **{link.name: link.what for link in LINKS}}


class Table:
    """Runs that are done, one JSON object a line in `path`: those of this executable are not run again."""

    def __init__(self, path, sha256):
        self.path, self.sha256, self.lock = path, sha256, threading.Lock()
        self.rows = []
        if path.exists():
            self.rows = [json.loads(line) for line in path.read_text().splitlines()]
        self.rows = [row for row in self.rows if row["sha256"] == sha256]

    def has(self, behavior, name, seed):
        return any((row["behavior"], row["link"], row["seed"]) == (behavior, name, seed)
                   for row in self.rows)

    def add(self, behavior, name, seed, result, took_s):
        colour = result.get("vision", {}).get("color") or {}
        link = result.get("link", {})
        row = {"sha256": self.sha256, "behavior": behavior, "link": name, "seed": seed,
               "done": result["outcome"] == "done", "sentence": result.get("sentence", ""),
               "round_trip_s": link.get("round_trip_mean_s"), "retries": link.get("retries"),
               "age_ms": colour.get("age_ms", {}).get("median"), "took_s": round(took_s, 1)}
        with self.lock:
            self.rows.append(row)
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
        return row

    def text(self, behavior):
        lines = [f"| {behavior} over | what it is | done | round trip, ms | repeated requests | "
                 "age of pictures, ms |", "|---|---|---|---|---|---|"]
        for name, what in NAMES.items():
            rows = [row for row in self.rows if (row["behavior"], row["link"]) == (behavior, name)]
            mean = lambda values: f"{sum(values) / len(values):.1f}" if values else "-"  # noqa: E731
            trips = [1e3 * row["round_trip_s"] for row in rows if row["round_trip_s"] is not None]
            ages = [row["age_ms"] for row in rows if row["age_ms"] is not None]
            retries = [row["retries"] for row in rows if row["retries"] is not None]
            if rows:
                lines.append(f"| {name} | {what} | {sum(row['done'] for row in rows)} of {len(rows)} | "
                             f"{mean(trips)} | {sum(retries) if retries else '-'} | {mean(ages)} |")
        return "\n".join(lines)


def run_table(options, behaviors, names):
    """One run of each seed over each link before the next seed: where it is interrupted, all have as many.
    Rows of fewer than 9 of 10 are wrong."""
    table = Table(options.out / "runs.jsonl", options.hash)

    def run(behavior, name, seed):
        began = time.monotonic()
        folder = options.out / f"{behavior}-{name}"
        if name in ("lockstep", "pty"):
            result = outside(options, folder, name, behavior, seed, options.seconds)
        else:
            result, _ = in_guest(options, folder, link_of(name), behavior, seed, options.seconds)
        row = table.add(behavior, name, seed, result, time.monotonic() - began)
        print(f"   {behavior} over {name}, seed {seed}: {'done' if row['done'] else row['sentence']} "
              f"({row['took_s']:.0f} s)", file=sys.stderr, flush=True)

    wanted = [(behavior, name, seed) for seed in range(1, options.runs + 1) for behavior in behaviors
              for name in names if not table.has(behavior, name, seed)]
    # In real time, so beside nothing else.
    for one in [one for one in wanted if one[1] == "pty"]:
        run(*one)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done in [pool.submit(run, *one) for one in wanted if one[1] != "pty"]:
            done.result()
    texts = [table.text(behavior) for behavior in behaviors]
    (options.out / "table.md").write_text(f"kaz: sha256 {options.hash}\n\n" + "\n\n".join(texts) + "\n")
    print("\n" + "\n\n".join(texts), flush=True)
    wrong = []
    for behavior in behaviors:
        for name in names:
            rows = [row for row in table.rows if (row["behavior"], row["link"]) == (behavior, name)]
            if sum(row["done"] for row in rows) < 0.9 * len(rows):
                wrong.append(f"{behavior} over {name}: fewer than 9 of 10")
    return wrong


def run_parts(options, parts):
    """Parts are (name, function), whose lines and faults are printed in this order."""
    def timed(function):
        began = time.monotonic()
        crashes = []
        try:
            while True:
                try:
                    lines, wrong = function()
                    break
                except machine.Crashed as crash:
                    crashes.append(f"   {crash}; this part runs again")
                    if len(crashes) > 3:
                        raise
            lines = crashes + lines
        except (RuntimeError, OSError, subprocess.SubprocessError, machine.Missing) as error:
            lines, wrong = [], [str(error)]
        return lines, wrong, time.monotonic() - began

    bad = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        # The longest, which is the last one, begins first.
        under_way = {name: pool.submit(timed, function) for name, function in reversed(parts)}
        for name, _ in parts:
            lines, wrong, took_s = under_way[name].result()
            for line in lines:
                print(line, flush=True)
            print(f"   {name}: {took_s:.0f} s", file=sys.stderr, flush=True)
            for sentence in wrong:
                print(f"   FAILED {name}: {sentence}", file=sys.stderr, flush=True)
            bad += wrong
    return bad


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=pathlib.Path, required=True,
                        help="folder with kaz, kernel_can_test, guest_init, guest_feed")
    parser.add_argument("--kernels", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--fetch", action="store_true", help="get a kernel if there is none")
    parser.add_argument("--short", action="store_true",
                        help="no runs, one loss of each kind, some cases of conformance: two minutes")
    parser.add_argument("--table", action="store_true",
                        help="only runs of the behaviors; goes on where it was interrupted")
    parser.add_argument("--runs", type=int, default=10, help="of each behavior over each link")
    parser.add_argument("--losses", type=int, default=20, help="of each kind, in one run")
    parser.add_argument("--only", default="",
                        help="names of links, or of kernel-can, boards, separated by commas")
    parser.add_argument("--behaviors", default="track-ball,catch-ball")
    parser.add_argument("--seconds", type=float, default=6, help="that the head follows the ball")
    parser.add_argument("--jobs", type=int, default=2, help="machines side by side")
    return parser.parse_args()


def main():
    options = parse_arguments()
    if options.fetch:
        machine.fetch(options.kernels)
    try:
        options.kernel = machine.kernel(options.kernels)
    except machine.Missing as missing:
        print(f"SKIPPED: not tested over real drivers (UART, USB, CAN, TCP, V4L2): {missing}; "
              "`./tools/dev study guest` gets it")
        return 77
    options.bin = options.bin.resolve()
    options.kaz = options.bin / "kaz"
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    options.calibration = options.out / "eyes.yml"
    subprocess.run([options.kaz, "sim", "--eyes", "ideal", "--write-calibration", options.calibration],
                   check=True, stdout=subprocess.DEVNULL)
    options.hash = hashlib.sha256(options.kaz.read_bytes()).hexdigest()
    print(f"kaz: sha256 {options.hash}, the same file outside and in the machine\n"
          f"kernel: {options.kernel.name}", flush=True)
    only = [name for name in options.only.split(",") if name]
    taken = lambda name: not only or name in only  # noqa: E731
    bad = []
    if not options.short and options.runs:
        bad += run_table(options, [name for name in options.behaviors.split(",") if name],
                         [name for name in NAMES if taken(name)])
    if not options.table:
        times = 1 if options.short else options.losses
        reactions = ["hold"] if options.short else ["hold", "limp"]
        print("\n" + losses.HEAD, flush=True)
        parts = [(f"{loss.what}, {reaction}",
                  lambda loss=loss, reaction=reaction: losses.loss_row(options, loss, times, reaction))
                 for loss in losses.LOSSES for reaction in reactions
                 if taken(loss.link) and (loss.board or reaction == "hold")]
        if taken("kernel-can"):
            parts.append(("kernel-can", lambda: kernel_can.kernel_can(options)))
        if taken("boards"):
            parts.append(("boards", lambda: boards.two_boards(options, options.short)))
        bad += run_parts(options, parts)
    print(f"\n{'passed' if not bad else f'{len(bad)} faults'}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
