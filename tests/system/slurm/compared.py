# Two evaluations have the same result, but for who ran them when.
# SPDX-License-Identifier: Apache-2.0
import json
import pathlib
import sys

HANG_S = 1200  # of a busy machine


def check(condition, what):
    if not condition:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {what}")


def same_result(one, two):
    """All but who ran it when, and how long that took."""
    check((one / "episodes.csv").read_bytes() == (two / "episodes.csv").read_bytes() or
          without_times(one) == without_times(two), f"episodes.csv of {one} and {two} differ")
    results = []
    for folder in (one, two):
        result = json.loads((folder / "result.json").read_text())
        for key in ("provenance", "planned"):
            result.pop(key, None)
        results.append(json.dumps({k: v for k, v in result.items() if "rtf" not in k and "wall" not in k}))
    check(results[0] == results[1], f"result.json of {one} and {two} differ:\n{results[0]}\n{results[1]}")


def without_times(folder):
    rows = [line.split(",") for line in (folder / "episodes.csv").read_text().splitlines()]
    keep = [i for i, name in enumerate(rows[0]) if name not in ("rtf", "wall_s")]
    return [[row[i] for i in keep if i < len(row)] for row in rows]
