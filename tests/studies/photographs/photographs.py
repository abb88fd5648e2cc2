# Recall and false finds of the ball detector on labelled photographs, by place and apparent diameter.
# SPDX-License-Identifier: Apache-2.0
"""usage: photographs.py --kaz KAZ FOLDER --out DIR

FOLDER has one folder per place, at any depth with pictures NAME.jpg and labels NAME.txt. A line of a
label file is "class x y width height", in fractions of the picture; class 0 is the ball. For each place,
`kaz vision learn-color` learns the color from pictures of the other places, and `kaz vision run` searches
all pictures of the place.

Pictures for learning: of each other place the five largest balls that are whole and not almost white, at
most ten in all. The marked region is the middle half of the label, in both directions.

Found: the center is within half of the label's larger side, and the diameter is within 30 % of that side.
All other finds are false; a second find of the same ball is false too. The apparent diameter is the
label's larger side. balls.csv, beside this file, lists the balls that are cut off, hidden in part or
almost white. It was made by eye before the first run. Writes table.md, table.csv and finds.csv into DIR."""

import argparse
import collections
import csv
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys

PER_PLACE, MAX_PICTURES = 5, 10
SIZES = ((20, math.inf, ">= 20 px"), (10, 20, "10 to 20 px"), (0, 10, "< 10 px"))
Ball = collections.namedtuple("Ball", "picture index u v width height visible pale")
Find = collections.namedtuple("Find", "u v diameter")


def size_of_jpeg(data):
    """Width and height in px, from the frame header."""
    at = 2
    while at + 9 < len(data):
        kind, length = data[at + 1], struct.unpack(">H", data[at + 2:at + 4])[0]
        if 0xC0 <= kind <= 0xCF and kind not in (0xC4, 0xC8, 0xCC):
            return struct.unpack(">HH", data[at + 5:at + 9])[::-1]
        at += 2 + length
    raise ValueError("no frame header")


def balls_of(folder, picture, notes):
    width, height = size_of_jpeg((folder / f"{picture}.jpg").read_bytes())
    balls = []
    for line in (folder / f"{picture}.txt").read_text().splitlines():
        kind, *numbers = line.split()
        if kind != "0":
            continue
        x, y, w, h = map(float, numbers[:4])
        note = notes.get((picture, str(len(balls))), {"visible": "whole", "almost_white": "0"})
        balls.append(Ball(picture, len(balls), x * width - 0.5, y * height - 0.5, w * width, h * height,
                          note["visible"], note["almost_white"] == "1"))
    return balls


def diameter(ball):
    return max(ball.width, ball.height)


def learning_balls(places, judged):
    """The balls for learning: PER_PLACE of each place except `judged`, the largest first."""
    chosen = []
    for place, pictures in sorted(places.items()):
        whole = [b for balls in pictures.values() for b in balls if b.visible == "whole" and not b.pale]
        if place != judged:
            chosen += sorted(whole, key=diameter, reverse=True)[:PER_PLACE]
    return sorted(chosen, key=diameter, reverse=True)[:MAX_PICTURES]


def region_of(ball):
    """The middle half of the label as X,Y,W,H."""
    return ",".join(str(round(n)) for n in (ball.u - ball.width / 4, ball.v - ball.height / 4,
                                            ball.width / 2, ball.height / 2))


def match(balls, finds):
    """Pairs each ball with at most one find, nearest first; returns (index of ball: find, unpaired finds)."""
    pairs = []
    for i, ball in enumerate(balls):
        for j, find in enumerate(finds):
            off = math.hypot(find.u - ball.u, find.v - ball.v) / diameter(ball)
            if off <= 0.5 and abs(find.diameter / diameter(ball) - 1) <= 0.3:
                pairs.append((off, i, j))
    found, used = {}, set()
    for _, i, j in sorted(pairs):
        if i not in found and j not in used:
            found[i] = finds[j]
            used.add(j)
    return found, [find for j, find in enumerate(finds) if j not in used]


def on_a_ball(find, balls):
    """Whether a false find lies on a labelled ball: its diameter is wrong, or it is a second find."""
    return any(math.hypot(find.u - b.u, find.v - b.v) <= diameter(b) / 2 for b in balls)


def group_of(ball):
    low = next(name for least, most, name in SIZES if least <= diameter(ball) < most)
    return low, "whole" if ball.visible == "whole" else "cut off or hidden"


def kaz(*arguments):
    ran = subprocess.run(list(map(str, arguments)), capture_output=True, text=True)
    if ran.returncode:
        sys.exit(f"photographs: {' '.join(map(str, arguments))}: {ran.stderr.strip()}")


def flat(picture):
    return picture.replace("/", "_")


def search(program, folder, place, places, out):
    """Finds in the pictures of a place: {picture: [Find, ...]}, best first."""
    learned = learning_balls(places, place)
    color = out / f"{place}.color.json"
    marked = [word for ball in learned
              for word in ("--in", folder / f"{ball.picture}.jpg", "--region", region_of(ball))]
    kaz(program, "vision", "learn-color", *marked, "--out", color)
    pictures = out / f"{place}.pictures"
    shutil.rmtree(pictures, ignore_errors=True)
    pictures.mkdir()
    for picture in places[place]:
        (pictures / f"{flat(picture)}.jpg").symlink_to((folder / f"{picture}.jpg").resolve())
    kaz(program, "vision", "run", "--in", pictures, "--color", color, "--out", out / f"{place}.run")
    result = json.loads((out / f"{place}.run/result.json").read_text())
    finds = {one["picture"]: [Find(*b["center_px"], 2 * b["radius_px"])
                              for b in one["balls"]]
             for one in result["pictures"]}
    return {picture: finds[f"{flat(picture)}.jpg"] for picture in places[place]}


def tables(places, finds):
    """Rows (place, diameter, visible, balls, found), rows (place, pictures, finds, false, on a ball), and
    all balls and false finds."""
    counts, falses, lines = collections.Counter(), [], []
    for place, pictures in places.items():
        number = wrong = on_ball = 0
        for picture, balls in pictures.items():
            found, rest = match(balls, finds[picture])
            number += len(finds[picture])
            wrong += len(rest)
            on_ball += sum(on_a_ball(find, balls) for find in rest)
            lines += [(picture, b.index, *group_of(b), int(b.pale), int(i in found))
                      for i, b in enumerate(balls)]
            lines += [(picture, "", f"{f.diameter:.0f} px at {f.u:.0f} {f.v:.0f}", "false find", "", "")
                      for f in rest]
            for i, ball in enumerate(balls):
                for key in ((place, *group_of(ball)), ("all", *group_of(ball))):
                    counts[key, "balls"] += 1
                    counts[key, "found"] += i in found
        falses.append((place, len(pictures), number, wrong, on_ball))
    falses.append(("all", *(sum(row[i] for row in falses) for i in range(1, 5))))
    rows = [(*key, counts[key, "balls"], counts[key, "found"])
            for place in [*places, "all"] for _, _, size in SIZES
            for visible in ("whole", "cut off or hidden")
            for key in [(place, size, visible)] if counts[key, "balls"]]
    return rows, falses, lines


def markdown(rows, falses):
    text = "| place | diameter | visible | balls | found | recall |\n|---|---|---|---|---|---|\n"
    for row in rows:
        text += "| " + " | ".join(map(str, row)) + f" | {row[4] / row[3]:.2f} |\n"
    text += "\n| place | pictures | finds | false finds | on a ball | precision | false finds per picture |\n"
    text += "|---|---|---|---|---|---|---|\n"
    for row in falses:
        precision = f"{1 - row[3] / row[2]:.2f}" if row[2] else ""
        text += "| " + " | ".join(map(str, row)) + f" | {precision} | {row[3] / row[1]:.3f} |\n"
    return text


def write_csv(path, header, rows):
    with open(path, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])


def read_places(folder):
    """{place: {picture: [Ball, ...]}}; the name of a picture is its path in `folder` without .jpg."""
    with open(pathlib.Path(__file__).with_name("balls.csv"), newline="") as lines:
        notes = {(note["picture"], note["ball"]): note for note in csv.DictReader(lines)}
    places = collections.defaultdict(dict)
    for path in sorted(folder.rglob("*.jpg")):
        picture = str(path.relative_to(folder).with_suffix(""))
        places[picture.split("/")[0]][picture] = balls_of(folder, picture, notes)
    if len(places) < 2:
        sys.exit(f"photographs: {folder}: must contain folders of at least two places with .jpg files")
    return dict(places)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kaz", type=pathlib.Path, required=True)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    places = read_places(options.folder)
    options.out.mkdir(parents=True, exist_ok=True)
    finds = {}
    for place in places:
        finds |= search(options.kaz, options.folder, place, places, options.out)
    rows, falses, lines = tables(places, finds)
    write_csv(options.out / "table.csv", ("place", "diameter", "visible", "balls", "found"), rows)
    write_csv(options.out / "finds.csv",
              ("picture", "ball", "diameter", "visible", "almost_white", "found"), lines)
    text = markdown(rows, falses)
    (options.out / "table.md").write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
