#!/usr/bin/env python3
# Steps of kaz.VectorEnv per second, as a table: engines, many robots beside one, threads.
# SPDX-License-Identifier: Apache-2.0
"""Periods of 20 ms of one robot per CPU second, medians of alternating runs; `threads`: per second.

usage: PYTHONPATH=build/release/python python3 python/benchmark/batch.py [--quick] [--json FILE]
"""

import argparse
import json
import statistics
import time

import numpy

import kaz


def rate(engine, robots, threads, clock, seconds):
    env = kaz.VectorEnv("stand", num_envs=robots, engine=engine, threads=threads, episode_s=1e6)
    env.task.impulse = (0, 0)
    env.reset(seed=1)
    random = numpy.random.default_rng(2)
    actions = [random.uniform(-0.3, 0.3, env.action_space.shape) for _ in range(16)]
    for action in actions[:3]:
        env.step(action)
    steps, begun = 0, clock()
    while clock() - begun < seconds:
        env.step(actions[steps % 16])
        steps += 1
    return steps * robots / (clock() - begun)


def main():
    options = argparse.ArgumentParser(description=__doc__,
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--quick", action="store_true", help="only show that it works")
    options.add_argument("--json", metavar="FILE")
    given = options.parse_args()
    repeats, seconds = (1, 0.3) if given.quick else (5, 3)
    cases = {f"{engine}, {robots} robot{'s' if robots > 1 else ''}": (engine, robots, 1, time.process_time)
             for engine in ("none", "native", "h8") for robots in (1, 16, 256)}
    cases["native, 16 robots, 1 thread, elapsed"] = ("native", 16, 1, time.monotonic)
    cases["native, 16 robots, 2 threads, elapsed"] = ("native", 16, 2, time.monotonic)
    measured = {name: [] for name in cases}
    for _ in range(repeats):
        for name, (engine, robots, threads, clock) in cases.items():
            measured[name].append(rate(engine, robots, threads, clock, seconds))
    print("| | periods per second |\n|---|---|")
    for name, values in measured.items():
        print(f"| {name} | {statistics.median(values):.0f} |")
    if given.json:
        with open(given.json, "w", encoding="utf-8") as file:
            json.dump({name: statistics.median(values) for name, values in measured.items()}, file, indent=2)


if __name__ == "__main__":
    main()
