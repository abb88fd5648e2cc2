#!/usr/bin/env python3
# Steps of kaz.VectorEnv per second, as a table: engines, many robots beside one, threads.
# SPDX-License-Identifier: Apache-2.0
"""Periods of 20 ms per CPU second, summed over robots: medians of alternating runs. Rows with `elapsed` are
per second of elapsed time. Resets: CPU time per robot, ms.

usage: PYTHONPATH=build/release/python python3 python/benchmark/batch.py [--quick] [--json FILE]
"""

import argparse
import json
import statistics
import time

import numpy

import kaz


def rate(engine, robots, threads, clock, seconds, **more):
    env = kaz.VectorEnv(more.pop("task", "stand"), num_envs=robots, engine=engine, threads=threads,
                        episode_s=1e6, **more)
    env.task.impulse = (0, 0)
    env.reset(seed=1)
    random = numpy.random.default_rng(2)
    actions = [random.uniform(-0.3, 0.3, env.action_space.shape) for _ in range(16)]
    for _ in range(1 if seconds < 1 else 25):  # until the emulator has translated the firmware
        env.step(actions[0])
    steps, begun = 0, clock()
    while clock() - begun < seconds:
        env.step(actions[steps % 16])
        steps += 1
    return steps * robots / (clock() - begun)


def reset_ms(engine, robots, seconds, **more):
    """Returns the CPU time of one robot's new episode."""
    env = kaz.VectorEnv("stand", num_envs=robots, engine=engine, threads=1, **more)
    env.reset(seed=1)
    for _ in range(2):  # robots that have run
        env.step(numpy.zeros(env.action_space.shape))
    resets, begun = 0, time.process_time()
    while time.process_time() - begun < seconds:
        env.reset()
        resets += 1
    return 1000 * (time.process_time() - begun) / (resets * robots)


def main():
    options = argparse.ArgumentParser(description=__doc__,
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--quick", action="store_true", help="short runs that only show that it works")
    options.add_argument("--json", metavar="FILE")
    given = options.parse_args()
    repeats, seconds = (1, 0.3) if given.quick else (5, 3)
    cases = {f"{engine}, {robots} robot{'s' if robots > 1 else ''}": (engine, robots, 1, time.process_time)
             for engine in ("none", "native", "h8") for robots in (1, 16, 256)}
    cases["native, 16 robots, 1 thread, elapsed"] = ("native", 16, 1, time.monotonic)
    cases["native, 16 robots, 2 threads, elapsed"] = ("native", 16, 2, time.monotonic)
    pictures = {f"{engine}, {eyes} pictures, {robots} robot{'s' if robots > 1 else ''}":
                (engine, robots, dict(task="look", pictures=eyes))
                for engine in ("native", "h8") for eyes in ("ideal", "real") for robots in (1, 16)}
    resets = {f"reset, {engine}, {robots} robot{'s' if robots > 1 else ''}, ms": (engine, robots)
              for engine in ("none", "native", "h8") for robots in (1, 16)}
    measured = {name: [] for name in (*cases, *pictures, *resets)}
    for _ in range(repeats):
        for name, (engine, robots, threads, clock) in cases.items():
            measured[name].append(rate(engine, robots, threads, clock, seconds))
        for name, (engine, robots, more) in pictures.items():
            measured[name].append(rate(engine, robots, 1, time.process_time, seconds, **more))
        for name, (engine, robots) in resets.items():
            measured[name].append(reset_ms(engine, robots, seconds / 3))
    print("| | periods per second |\n|---|---|")
    for name, values in measured.items():
        print(f"| {name} | {statistics.median(values):.{3 if name in resets else 0}f} |")
    if given.json:
        with open(given.json, "w", encoding="utf-8") as file:
            json.dump({name: statistics.median(values) for name, values in measured.items()}, file, indent=2)


if __name__ == "__main__":
    main()
