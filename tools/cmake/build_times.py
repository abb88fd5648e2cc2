# Where the time of a build went: its log by target, and its slowest steps.
# SPDX-License-Identifier: Apache-2.0
"""usage: build_times.py BUILD_FOLDER [--top N]

Times are of the wall clock from begin to end of each step of the last build that made it; beside other
steps and
other programs they are longer than the step alone."""

import argparse
import collections
import pathlib
import re
import sys


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    arguments.add_argument("build", type=pathlib.Path)
    arguments.add_argument("--top", type=int, default=20)
    options = arguments.parse_args()
    log = options.build / ".ninja_log"
    if not log.is_file():
        sys.exit(f"{log}: no such file; build first: ./tools/dev build")
    steps = {}
    for line in log.read_text().splitlines()[1:]:
        begin, end, _, output, *_ = line.split("\t")
        steps[output] = (int(end) - int(begin)) / 1000
    targets, counts = collections.Counter(), collections.Counter()
    for output, seconds in steps.items():
        found = re.search(r"CMakeFiles/([^/]+)\.dir/", output)
        name = found.group(1) if found else output.split("/")[0] + "/ (links, generated files)"
        targets[name] += seconds
        counts[name] += 1
    print(f"{len(steps)} steps, {sum(steps.values()):.0f} s one after the other\n\nby target:")
    for name, seconds in targets.most_common(options.top):
        print(f"{seconds:8.0f} s {counts[name]:5} steps  {name}")
    print("\nslowest steps:")
    for output, seconds in sorted(steps.items(), key=lambda step: -step[1])[:options.top]:
        print(f"{seconds:8.1f} s  {output}")


main()
