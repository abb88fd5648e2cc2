# Draws figures 3 and 5 to 8 of the paper of 2002, each from a recorded run of the virtual robot.
# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of the 2002 paper that show a run, and a page with all of them.

Figure 3 shows track-ball, figures 5 and 6 show navigate, figure 7 shows a sweep of the head, and figure 8
shows catch-ball. The program records each run into a separate folder, and then simulates the run again.
The second simulation sends the recorded bytes to the same board in the same world. It yields the eyes'
pictures, the true poses and the outside views. Figures 1, 2 and 4 of the paper show no run."""

import argparse
import contextlib
import html
import json
import math
import os
import pathlib
import sys
import tempfile
import threading
import time

import numpy

import kaz

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import colors, pyplot
except ImportError:
    sys.exit("kaz.figures: matplotlib is missing; install it (apt-get install python3-matplotlib)")

EPILOG = """\
Drawing all figures takes two minutes and 230 MB. For other options of the robot, record your own run.
Exit status: 1 a run failed, or lacks data for a figure (the other figures are drawn); 2 wrong usage;
3 the environment failed; 130 Ctrl-C.
examples:
  python3 -m kaz.figures
  python3 -m kaz.figures --only 3,6 --seed 7 --out seven
  python3 -m kaz.figures --only 7 --mcu native --json
  kaz run navigate --goal 0.6,-0.15 --world boxes --eyes real --imu --out there
  python3 -m kaz.figures --recording there --out drawn"""
CAPTIONS = {3: "Simulation environment for vision based behavior",  # of the paper
            5: "Experimental setup: task of the robot is to approach the ball and catch it",
            6: "Visual processing and local map representation of the experiment",
            7: "Frame information messaging in visual processing modules",
            8: "Vision based behavior program in simulation world and real world"}
SHOWN_BY = {"track-ball": [3, 5], "search-ball": [3, 5], "navigate": [5, 6], "catch-ball": [3, 5, 8],
            "sweep": [7]}
STATES_PER_MS, STATES_PER_BYTE = 18432, 1600  # of the board's clock
STAND_S, DELAY_S = 2.6, 0.3  # of figure 7: time until the sweep, and from a pair of pictures to its result


class Missing(Exception):
    """A run lacks the data of a figure."""


class Run:
    """A recorded run, which is simulated again. Simulated time passes only in frames()."""

    def __init__(self, path):
        self.path = path / "recording.mcap" if path.is_dir() else path
        self.recording = kaz.Recording(self.path)
        facts = self.recording.facts
        if "world" not in facts or not self.recording.topics.get("/truth/joints"):
            raise kaz.UsageError(f"{self.path}: not a run of the virtual robot: record one by kaz run --out")
        read = {"world": str, "mcu": str, "sensors": str, "imu": "true".__eq__, "dynamics": str, "seed": int,
                "physics_step_ms": float, "eyes": str, "eye_width": int, "renderer": str,
                "supply_volts": float}
        backend = json.loads(facts.get("backend", "{}"))
        self.options = {name: convert(facts[name]) for name, convert in read.items()}
        self.options |= {name: backend[name] for name in ("robot_file", "image") if backend.get(name)}
        self.behavior, self.duration_s = facts.get("behavior", "sweep"), self.recording.duration_s
        self.angles = self.recording.array("/truth/joints")["angle"]
        # The host writes a byte in the millisecond of its start bit; `state` is the end of its stop bit.
        self.bytes = [(round(1000 * at) - 1 + (int(state) - STATES_PER_BYTE) // STATES_PER_MS, int(value))
                      for at, message in self.recording.messages("/wire/to_board")
                      for value, state in zip(message["value"], message["state"])]
        self.restart()

    def restart(self):
        self.sim = kaz.Simulation(**self.options)
        for line in self.recording.facts["faults"].splitlines():
            if " link_" not in line:  # the recorded bytes are those that arrived
                self.sim.add_fault(line)
        self.sim.pairs()  # opens the eyes
        self.ms, self.sent = 0, 0
        self.eyes = [self.sim.link_pose("left_eye")]  # world from the left eye's optical frame, every ms

    def frames(self, end_s):
        """Simulates until `end_s`; yields each pair of pictures when it arrives."""
        while self.ms < round(1000 * end_s):
            first = self.sent
            while self.sent < len(self.bytes) and self.bytes[self.sent][0] <= self.ms:
                self.sent += 1
            self.sim.write(bytes(value for _, value in self.bytes[first:self.sent]))
            self.sim.step(0.001)
            self.ms += 1
            self.eyes.append(self.sim.link_pose("left_eye"))
            if self.ms % 200 == 0 and self.ms <= len(self.angles):
                self.sim.read(1 << 20)
                if numpy.abs(self.angles[self.ms - 1] - self.sim.joints()["angle"]).max() > 1e-6:
                    raise kaz.UsageError(
                        f"{self.path}: the repeated run differs from the recording at {self.ms / 1000} s, "
                        "for example because of another version of Kaz: record the run again")
            yield from self.sim.pairs()

    def eye_at(self, seconds):
        return self.eyes[round(1000 * seconds)]

    def ball(self):
        """Returns the ball's true position; None in a world without a ball."""
        return self.sim.object_position("ball") if self.recording.topics.get("/truth/ball") else None

    def outside(self):
        """Draws robot and ball from the robot's front right."""
        trunk, ball = self.sim.link_pose("trunk")[:3, 3], self.ball()
        ball = trunk + [0.5, 0, -0.2] if ball is None else ball
        middle = (trunk + ball) / 2 + [0, 0, 0.03]
        eye = middle + (0.55 + 1.1 * numpy.linalg.norm(trunk - ball)) * numpy.array([0.8, -0.38, 0.48])
        return self.sim.picture(list(eye), list(middle), 1280, 960, 0.78)


class FloorMap:
    """A map of floor and obstacles, simpler than the map of the robot. x: forward, y: left; m."""

    CELL = 0.01
    edges = numpy.arange(-2, 2 + CELL / 2, CELL)
    grid = numpy.stack(numpy.meshgrid(*2 * [edges[:-1] + CELL / 2], [0], indexing="ij"), -1)[:, :, 0]

    def __init__(self):
        self.odds = numpy.zeros(self.grid.shape[:2])  # log-odds of an obstacle

    def add(self, floor, disparity, camera, eye):
        """Adds a picture to the map. floor: mask of the floor; eye: pose of the optical frame in the map."""
        fb = camera.fx * camera.baseline_m
        # Cell center p in the optical frame: u = fx p_x / p_z + cx. A sigma of the depth is 0.2 px z^2 / fb.
        p = (self.grid - eye[:3, 3]) @ eye[:3, :3]
        z = numpy.maximum(p[..., 2], 0.05)
        u = numpy.rint(camera.fx * p[..., 0] / z + camera.cx).astype(int)
        v = numpy.rint(camera.fy * p[..., 1] / z + camera.cy).astype(int)
        side = camera.width // 20  # an object that is cut off at a side may be labeled floor
        seen = (z > 0.05) & (z < 1.5) & (numpy.abs(u - camera.width // 2) < camera.width // 2 - side) \
            & (v >= 0) & (v < camera.height)
        seen[seen] = floor[v[seen], u[seen]]
        weight = numpy.minimum(1, self.CELL * fb / (0.2 * z ** 2))
        # Obstacle: four points, higher than 1.5 cm and three sigma, lower than the robot, away from its body.
        rows, columns = numpy.nonzero((disparity > fb / 1.5) & ~floor)
        depth = fb / disparity[rows, columns]
        rays = numpy.stack([(columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy,
                            numpy.ones(len(rows))], -1) @ eye[:3, :3].T
        x, y, height = (depth[:, None] * rays + eye[:3, 3]).T
        least = numpy.maximum(0.015, 0.6 * depth ** 2 / fb * numpy.abs(rays[:, 2]))
        high = (height > least) & (height < 0.36) & (numpy.hypot(x, y) > 0.13)
        points = numpy.histogram2d(x[high], y[high], [self.edges, self.edges])[0]
        self.odds = numpy.clip(self.odds + weight * (1.2 * (points >= 4) - 0.6 * seen), -3, 10)

    def floor(self):
        return self.odds < -0.1

    def area(self):
        return float(self.floor().sum() * self.CELL ** 2)

    def codes(self):
        return numpy.select([self.floor(), self.odds > 0.1], [255, 0], 128)


def planes_of(pair, eye):
    """Returns the disparity, the plane labels, and the mask of the floor's pixels.
    A plane is floor if it is level within 0.1 rad and its height z is 0 within 2 cm."""
    disparity = kaz.vision.DepthFinder().find(pair.left, pair.right, pair.camera)
    planes, label = kaz.vision.PlaneFinder().find(disparity, pair.camera)
    floor = [number for number, plane in enumerate(planes, 1) if eye[2, :3] @ plane["normal"] > math.cos(0.1)
             and abs(eye[2, :3] @ plane["middle"] + eye[2, 3]) < 0.02]
    return disparity, label, numpy.isin(label, floor)


def matrix(pose, place="position", turn="orientation"):
    """Returns the matrix of a recorded pose that is turned about the vertical axis only."""
    yaw = 2 * math.atan2(pose[turn]["z"], pose[turn]["w"])
    c, s = math.cos(yaw), math.sin(yaw)
    x, y = pose[place]["x"], pose[place]["y"]
    return numpy.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


# ---- Layout

def fill(figure, panels, columns):
    """Draws panels in rows. A panel is (content, caption). content: a picture, or a function that draws."""
    axes = figure.subplots(-(-len(panels) // columns), columns, squeeze=False)
    for (shown, caption), axis in zip(panels, axes.flat):
        axis.set(xticks=[], yticks=[])
        shown(axis) if callable(shown) else axis.imshow(shown)
        axis.set_xlabel(caption, loc="left", fontsize=9)


def page(panels, columns, width):
    figure = pyplot.figure(figsize=(width, len(panels) / columns * (0.75 * width / columns + 0.25)),
                           layout="constrained")
    fill(figure, panels, columns)
    return figure


def show_cells(axis, codes, forward, left, cmap="gray"):
    """Shows the cells of a map from -2 to 2 m. forward, left: visible range (min, max), m."""
    axis.imshow(codes[::-1, ::-1], cmap, vmin=0, vmax=255, extent=(2, -2, -2, 2), interpolation="nearest")
    axis.set(ylim=forward, xlim=left[::-1])


# ---- The figures. Each function returns the figure and the numbers that it shows.

def figure3(run):
    find_ball, find_flow = kaz.vision.BallDetector().find, kaz.vision.FlowFinder().find
    best, best_score, before, ball_before = None, 0, None, None
    for pair in run.frames(run.duration_s):
        ball = find_ball(pair.left, pair.camera)
        if ball and ball_before and ball["radius_px"] >= 4:
            right, down = ball["u"] - ball_before["u"], ball["v"] - ball_before["v"]
            score = math.hypot(right, down) + max(0, down)  # the paper's ball falls
            if math.hypot(right, down) <= 14 and score > best_score:
                disparity = kaz.vision.DepthFinder().find(pair.left, pair.right, pair.camera)
                flow = find_flow(before.left, pair.left, pair.camera)
                if (disparity > 0).mean() >= 0.3 and numpy.isfinite(flow[..., 0]).mean() >= 0.3:
                    moved_px, interval_ms = math.hypot(right, down), 1000 * (pair.time - before.time)
                    best, best_score = (pair, interval_ms, ball, moved_px, disparity, flow), score
        before, ball_before = pair, ball
    if best is None:
        raise Missing("no picture of the run has the ball in motion, depth and optical flow at once")
    pair, interval_ms, ball, moved_px, disparity, flow = best
    run.restart()
    list(run.frames(pair.time))
    detector = kaz.vision.BallDetector()
    detector.find(pair.left, pair.camera)
    outside, mask = run.outside().copy(), detector.mask()
    height, width = mask.shape
    outside[12:12 + height, 1256 - 2 * width:1256 - width] = pair.left
    outside[12:12 + height, 1268 - width:1268] = pair.right

    def draw_depth(axis):
        depth = numpy.ma.masked_invalid(kaz.vision.depth_of(disparity, pair.camera))
        axis.imshow(depth, pyplot.get_cmap("jet_r").with_extremes(bad="black"), colors.LogNorm(0.2, 3))

    def draw_flow(axis):
        axis.imshow(pair.left // 2 + 128)
        v, u = numpy.mgrid[6:flow.shape[0]:12, 6:flow.shape[1]:12]
        axis.quiver(u, v, *2 * flow[v, u].transpose(2, 0, 1), angles="xy", scale_units="xy", scale=1,
                    color="tab:blue", pivot="tip", width=0.004)

    gray = (0.35 * pair.left.mean(axis=2, keepdims=True)).astype("u1").repeat(3, axis=2)
    return page([(outside, f"(A) robot and view simulator, {pair.time:.2f} s; both eyes' pictures"),
                 (numpy.where(mask[..., None], pair.left, gray),
                  f"(B) color extraction: the ball, {ball['distance_m']:.2f} m away by its size"),
                 (draw_depth, "(C) depth: red 0.2 m, green 0.8 m, blue 3 m, black unknown"),
                 (draw_flow, f"(D) optical flow of {interval_ms:.0f} ms, arrows twice as long")], 2, 9.4), {
        "exposure_s": pair.time, "ball_distance_m": ball["distance_m"], "ball_radius_px": ball["radius_px"],
        "ball_moved_px": moved_px,
        "ball_pixels": int(mask.sum()), "depth_known": float((disparity > 0).mean()),
        "flow_known": float(numpy.isfinite(flow[..., 0]).mean())}


def figure5(run):
    pose = run.sim.link_pose("trunk")
    turned = numpy.array([pose[:3, 0] * [1, 1, 0], pose[:3, 1] * [1, 1, 0], [0, 0, 1]]).T
    start, ball = pose[:3, 3] * [1, 1, 0], run.ball()
    to_ball = turned.T @ (ball - start) if ball is not None else numpy.array([1, 0, 0])
    middle, extent = start + turned @ to_ball / 2, numpy.linalg.norm(to_ball)
    high = 1.1 + 1.3 * extent
    side = middle + (1 + 1.3 * extent) * (turned @ [-0.27, -0.77, 0.58])

    def draw_above(axis):
        above = middle + turned @ [-0.02 * high, 0, high]
        axis.imshow(run.sim.picture(list(above), list(middle), 960, 720, 0.8))
        scale = 480 / math.tan(0.4) / high  # px per m on the floor, about
        for name, at in (("robot", -to_ball / 2), ("ball", to_ball / 2)):
            if name == "robot" or ball is not None:
                axis.text(510 - scale * at[1], 360 - scale * at[0], name, color="white", fontsize=12)

    text = "before the robot moves" if ball is None else f"the ball is {extent:.2f} m from the robot"
    return page([(run.sim.picture(list(side), list(middle), 960, 720, 0.7), text),
                 (draw_above, "the same scene from above")], 2, 11), \
        {} if ball is None else {"ball_m": to_ball[:2].tolist()}


def figure6(run):
    path = next((one for one in run.recording.messages("/map/path") if len(one[1]["poses"]) > 1), None)
    if path is None:
        raise Missing("the run has no planned path")
    planned, route = path[0], numpy.array([[pose["pose"]["position"][axis] for axis in "xy"]
                                           for pose in path[1]["poses"]])
    begin = max((at for at, state in run.recording.messages("/behavior")
                 if state.get("phase") == "look around" and at < planned), default=planned)
    world_from_map = next(matrix(one["transform"], "translation", "rotation")
                          for at, poses in run.recording.messages("/tf") if at >= planned
                          for one in poses["transforms"] if one["child_frame_id"] == "map")
    nearest = {}  # for each of five directions, the picture nearest to it
    for pair in run.frames(planned):
        pan = math.degrees(run.angles[round(1000 * pair.time) - 1, kaz.JOINTS.index("neck_pan")])
        wanted = min((60, 30, 0, -30, -60), key=lambda angle: abs(angle - pan))
        if pair.time >= begin and abs(pan - wanted) < abs(nearest.get(wanted, (999,))[0] - wanted):
            nearest[wanted] = pan, pair, numpy.linalg.inv(world_from_map) @ run.eye_at(pair.time)
    if not nearest:
        raise Missing("the robot took no picture while it looked around")
    views, floors, facts = [], [], []
    for _, (pan, pair, eye) in sorted(nearest.items(), reverse=True):
        disparity, label, floor = planes_of(pair, eye)
        cells = FloorMap()
        cells.add(floor, disparity, pair.camera, eye)
        red = numpy.where(label[..., None] > 0, 0.45 * pair.left + [118, 26, 21], pair.left).astype("u1")
        views.append((red, f"(A) {pair.time:.2f} s, head {round(pan):+d}°"))
        floors.append((lambda axis, codes=cells.codes(): show_cells(axis, codes, (0, 1.2), (-0.8, 0.8)),
                       f"(B) floor: {cells.area():.2f} m²"))
        facts.append({"exposure_s": pair.time, "pan_deg": pan, "floor_m2": cells.area()})
    grid = next(grid for at, grid in run.recording.messages("/map") if at >= planned)
    chance = grid["data"].reshape(400, 400).T / 100  # of an obstacle; [x, y], from -2 m to 2 m; < 0: unknown
    floor, sure = (chance >= 0) & (chance < 0.5), numpy.abs(2 * chance - 1)
    window = [(0.01 * known[0] - 2.15, 0.01 * known[-1] - 1.85)
              for known in (numpy.flatnonzero((chance >= 0).any(axis)) for axis in (1, 0))]
    ball, length = run.ball(), float(numpy.hypot(*numpy.diff(route, axis=0).T).sum())

    def draw_merged(axis):
        show_cells(axis, numpy.select([chance < 0, floor], [128, 165 + 90 * sure], 70 * (1 - sure)), *window)

    def draw_path(axis):
        axis.set(xticks=numpy.arange(-2, 2, 0.1), yticks=numpy.arange(-2, 2, 0.1))
        axis.tick_params(length=0, labelbottom=False, labelleft=False)
        axis.grid(color="0.3", linewidth=0.4)
        show_cells(axis, numpy.select([chance < 0, floor], [128, 255], 0), *window)
        axis.plot(route[:, 1], route[:, 0], "-o", color="tab:red", linewidth=3)
        axis.plot(route[0, 1], route[0, 0], "^", color="black", fillstyle="none", markersize=12)
        if ball is not None:
            x, y = (numpy.linalg.inv(world_from_map) @ [*ball, 1])[:2]
            axis.plot(y, x, "+", color="tab:blue", markersize=14, markeredgewidth=3)

    figure = pyplot.figure(figsize=(13, 9.6), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(4, 5.6))
    fill(top, views + floors, len(views))
    fill(bottom, [
        (draw_merged, "(C) merged map: floor white, brighter if certain, obstacles black, unseen gray"),
        (draw_path, f"(D) path (red), {length:.2f} m; true ball (blue); grid of 10 cm")], 2)
    obstacle = (chance >= 0) & ~floor
    return figure, {"frames": facts, "floor_m2": 1e-4 * int(floor.sum()), "planned_s": planned,
                    "obstacle_m2": 1e-4 * int(obstacle.sum()),
                    "path_m": route.tolist(), "path_length_m": length}


def boxes_of(recording):
    """Returns pose and half the sides, x and y, of each box in the recorded world."""
    return [(matrix(marker["pose"]), numpy.array([marker["scale"][axis] for axis in "xy"]) / 2)
            for marker in recording.messages("/scene")[0][1]["markers"]
            if marker["type"] == 1 and marker["scale"]["z"] > 0.001]  # not the floor


def figure7(run):
    boxes = boxes_of(run.recording)
    if not boxes:
        raise Missing(f"the world {run.options['world']} has no box")
    seen = [(pair, run.ms / 1000 + DELAY_S) for pair in run.frames(run.duration_s) if pair.time > STAND_S]
    if not seen:
        raise Missing(f"the recording has no pictures after {STAND_S} s")
    maps, rows = (FloorMap(), FloorMap()), []
    for pair, arrival in seen:
        eyes = run.eye_at(pair.time), run.eye_at(min(arrival, run.duration_s))
        disparity, _, floor = planes_of(pair, eyes[0])
        for cells, eye in zip(maps, eyes):
            cells.add(floor, disparity, pair.camera, eye)
        rows.append([math.degrees(math.atan2(eye[1, 2], eye[0, 2])) for eye in eyes]
                    + [cells.area() for cells in maps] + [100 * floor.mean()])
    times, rows = [pair.time for pair, _ in seen], numpy.array(rows)
    inside = sum((numpy.abs((FloorMap.grid - pose[:3, 3]) @ pose[:3, :2]) < half).all(-1)
                 for pose, half in boxes) > 0

    def draw(cells):
        def on(axis):
            show_cells(axis, cells.codes(), (0, 1), (-0.7, 0.7), colors.ListedColormap(
                ["tab:red", "0.6", "seagreen"]))
            for pose, half in boxes:
                x, y = numpy.array([[1, 1, -1, -1, 1], [1, -1, -1, 1, 1]]) * half[:, None]
                x, y = pose[:2, :2] @ [x, y] + pose[:2, 3:]
                axis.plot(y, x, color="black")
        return on

    figure = pyplot.figure(figsize=(11, 9), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(3, 6))
    fill(top, [(seen[numpy.abs(rows[:, 0]).argmin()][0].left, "left eye; the head turns at 60°/s"),
               (draw(maps[0]), "posture at the exposure: floor green, obstacles red"),
               (draw(maps[1]), f"posture when the result arrives, {DELAY_S} s later")], 3)
    for axis, title, columns in zip(bottom.subplots(3, 1, sharex=True), (
            "Pan of the head, degrees", "Floor found in the left picture, %", "Floor in the map, m²"),
            ((0, 1), (4,), (2, 3))):
        for column, color, label in zip(columns, ("tab:blue", "tab:red"), (
                "posture at the exposure (frame information)", "posture when the result arrives")):
            axis.plot(times, rows[:, column], color=color, label=label)
        axis.set_title(title, loc="left", fontsize=10)
        axis.grid(alpha=0.4)
    axis.legend(fontsize=9)
    axis.set_xlabel("exposure of the picture, s")
    facts = {"pictures": len(seen), "delay_s": DELAY_S, "boxes_m2": 1e-4 * int(inside.sum())}
    for name, cells in zip(("with_frame_information", "without"), maps):
        facts[name] = {"floor_m2": cells.area(),
                       "floor_in_boxes_m2": 1e-4 * int((cells.floor() & inside).sum())}
    return figure, facts


def figure8(run):
    phases = [(at, state["phase"]) for at, state in run.recording.messages("/behavior")
              if state.get("behavior") == "catch-ball"] + [(run.duration_s, "")]
    views, eyes, facts, pair = [], [], [], None
    for phase, name, after in (("search", "search", 0.5), ("look", "track", 0.4), ("walk", "approach", 5),
                               ("close", "catch", 0), ("hold", "hold", 1.2)):
        number = next((number for number, (_, one) in enumerate(phases) if one == phase), None)
        if number is None:
            continue
        at = min(phases[number][0] + after, phases[number + 1][0])
        for pair in run.frames(at):
            pass
        ball = kaz.vision.BallDetector().find(pair.left, pair.camera)

        def draw_eye(axis, picture=pair.left, ball=ball):
            axis.imshow(picture)
            if ball:
                axis.add_patch(pyplot.Circle((ball["u"], ball["v"]), ball["radius_px"] + 2, color="yellow",
                                             fill=False))
        views.append((run.outside(), f"{name}, {at:.1f} s"))
        eyes.append((draw_eye, f"left eye: ball {ball['distance_m']:.2f} m away" if ball else
                     "left eye: ball not found"))
        facts.append({"shown": name, "time_s": at, "distance_m": ball["distance_m"] if ball else None})
    if not views:
        raise Missing("the run has no search, tracking or catch")
    return page(views + eyes, len(views), 13.4), {"moments": facts}


# ---- Runs, files and arguments

def record_sweep(out, **options):
    """Records the crouching robot while its head turns to the right, and then back at another tilt."""
    pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    sim = kaz.Simulation(recording=out + "/recording.mcap", **options)
    sim.pairs()
    robot = kaz.Robot(sim)
    robot.set_gains([name for name in kaz.JOINTS if "hand" not in name], kp=20, kd=0.15)
    robot.set_gains(["neck_pan", "neck_tilt"], kp=12, kd=0.15)
    robot.enable()
    robot.set_targets(dict(zip(kaz.JOINTS, kaz.HOME)) | {
        "neck_pan": math.radians(50), "neck_tilt": math.radians(35)}, duration=2)
    robot.sleep(STAND_S)
    for pan, tilt in ((-50, 35), (50, 20)):
        robot.set_targets({"neck_tilt": math.radians(tilt)}, duration=0.4)
        robot.sleep(0.5)
        robot.set_targets({"neck_pan": math.radians(pan)}, duration=100 / 60)
        robot.sleep(100 / 60)
    robot.sleep(DELAY_S + 0.1)
    sim.finish_recording()
    return {"success": True}


@contextlib.contextmanager
def progress(text, quiet):
    """Prints the text and the elapsed time every 2 s, unless `quiet` is true."""
    ended, begin = threading.Event(), time.monotonic()

    def report():
        while not quiet and not ended.wait(2):
            print(f"kaz.figures: {text}, {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)
    threading.Thread(target=report, daemon=True).start()
    try:
        yield
    finally:
        ended.set()


def write(path, save):
    """Calls save() with a temporary path, and then renames the file to `path`."""
    part = path.with_name("part-" + path.name)
    save(part)
    os.replace(part, path)


def page_text(result):
    text = '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Figures</title></head>'
    text += "<body>\n<h1>Figures of the paper</h1>\n"
    for number, facts in sorted(result["figures"].items()):
        text += f"<h2>Figure {number}: {CAPTIONS[int(number)]}</h2>\n<img src='figure{number}.png' " \
                f"alt='figure {number}'>\n<pre>{json.dumps(facts, indent=1)}</pre>\n"
    for number, why in result["not_drawn"].items():
        text += f"<p>Figure {number} is missing: {html.escape(why)}</p>\n"
    return text + "</body></html>\n"


def arguments():
    parser = argparse.ArgumentParser("python3 -m kaz.figures", description=__doc__, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.error = lambda why: parser.exit(2, f"kaz.figures: {why}; see python3 -m kaz.figures --help\n")
    option = parser.add_argument
    option("--out", metavar="DIR", default="kaz-figures", type=pathlib.Path,
           help="folder for the figures, figures.html, result.json and the runs (default: %(default)s)")
    option("--only", metavar="LIST", help="draw only these figures, separated by commas: 3, 5, 6, 7, 8")
    option("--recording", metavar="PATH", type=pathlib.Path,
           help="draw figures of your own run, given by its recording.mcap or its folder")
    option("--seed", metavar="N", type=int, help="seed of the runs, from 0 (default: 1)")
    option("--mcu", choices=("h8", "native"), help="microcontroller of the runs (default: h8)")
    option("--goal", metavar="X,Y[,DEGREES]|ball", help="goal of the run in figures 5 and 6 (default: ball)")
    option("--world", metavar="NAME|FILE", help="world of figures 5 and 6, with a ball (default: boxes)")
    option("--yard", metavar="NAME|FILE", help="world of figure 7, with boxes on a floor (default: yard)")
    option("--json", action="store_true", help="print result.json, without progress messages")
    given = parser.parse_args()
    only = (given.only or ",".join(map(str, CAPTIONS))).split(",")
    for one in only:
        if one not in map(str, CAPTIONS):
            parser.error(f"--only {one}: give 3, 5, 6, 7 or 8, separated by commas")
    given.only = sorted(map(int, only)) if given.only else []
    if (given.seed or 0) < 0:
        parser.error(f"--seed {given.seed}: give a number from 0")
    for name in ("seed", "mcu", "goal", "world", "yard"):
        if given.recording and getattr(given, name) is not None:
            parser.error(f"--{name} is set by the recording; leave it out with --recording")
    return given


def check_worlds(boxes, yard):
    """Raises UsageError before anything runs. yard: None without figure 7."""
    kaz.Simulation(world=boxes, mcu="native", eyes="none")
    if yard is None:
        return
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "yard.mcap")
        kaz.Simulation(world=yard, mcu="native", eyes="none", recording=str(path)).finish_recording()
        if not boxes_of(kaz.Recording(path)):
            raise kaz.UsageError(f"--yard {yard}: the world has no box; give a world like yard")


def runs_of(given):
    """Records each run, or uses the given recording. Yields for each run: the figures to draw, the
    name of the run, the path of the recording, and a sentence if the run failed (else "")."""
    if given.recording:
        run = Run(given.recording)
        shown = SHOWN_BY.get(run.behavior, [])
        if not set(given.only or shown[:1] or [0]) <= set(shown):
            raise kaz.UsageError(f"{run.path}: a run of {run.behavior} shows figures {shown or 'none'}; "
                                 "change --only, or give another recording")
        yield given.only or shown, run.behavior, run.path, ""
        return
    same = {"seed": 1 if given.seed is None else given.seed, "mcu": given.mcu or "h8", "eyes": "real"}
    boxes, yard = given.world or "boxes", given.yard or "yard"
    check_worlds(boxes, yard if 7 in (given.only or CAPTIONS) else None)
    for figures, name, world, settings in (
            ([5, 6], "navigate", boxes, {"goal": given.goal or "ball"}),
            ([3], "track-ball", "ball", {"seconds": 8}), ([7], "sweep", yard, {}),
            ([8], "catch-ball", "catch", {})):
        figures = [number for number in figures if number in (given.only or CAPTIONS)]
        if figures:
            out = given.out / name
            with progress(f"recording {name}", given.json):
                if name == "sweep":
                    report = record_sweep(str(out), world=world, **same)
                else:
                    report = kaz.run_behavior(name, world=world, settings=settings, out=str(out), imu=True,
                                              **same)
            yield figures, name, out, "" if report["success"] else report["sentence"]


def draw(given, result):
    for figures, name, path, sentence in runs_of(given):
        if sentence:
            result["failed_runs"][name] = sentence
            print(f"kaz.figures: {name} did not succeed: {sentence}", file=sys.stderr)
        for number in figures:
            try:
                with progress(f"drawing figure {number}", given.json):
                    figure, facts = globals()[f"figure{number}"](Run(path))
                    given.out.mkdir(parents=True, exist_ok=True)
                    for ending in ("png", "jpg"):
                        write(given.out / f"figure{number}.{ending}", figure.savefig)
                    pyplot.close(figure)
            except Missing as error:
                result["not_drawn"][str(number)] = str(error)
                print(f"kaz.figures: figure {number}: {error}", file=sys.stderr)
            else:
                facts = json.loads(json.dumps(facts), parse_float=lambda text: round(float(text), 6))
                result["figures"][str(number)] = {"run": name} | facts


def main():
    given = arguments()
    result = {"outcome": "interrupted", "figures": {}, "not_drawn": {}, "failed_runs": {}}
    status = 130
    try:
        draw(given, result)
        status = 1 if result["not_drawn"] or result["failed_runs"] else 0
        result["outcome"] = "failed" if status else "done"
    except KeyboardInterrupt:
        print("kaz.figures: interrupted; completed figures are kept", file=sys.stderr)
    except (kaz.UsageError, kaz.RobotError, OSError) as error:
        print(f"kaz.figures: {error}", file=sys.stderr)
        return 2 if isinstance(error, kaz.UsageError) else 3
    if given.out.is_dir():
        write(given.out / "result.json", lambda part: part.write_text(json.dumps(result, indent=2) + "\n"))
        write(given.out / "figures.html", lambda part: part.write_text(page_text(result)))
    print(json.dumps(result, indent=2) if given.json else
          f"figures, figures.html and result.json are in {given.out}")
    return status


if __name__ == "__main__":
    sys.exit(main())
