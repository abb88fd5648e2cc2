# kaz.VectorEnv: many robots for learning and evaluation. Interface: Gymnasium's vector environments.
# SPDX-License-Identifier: Apache-2.0
"""VectorEnv(task, num_envs=8, engine="native"): robots that run in C++ threads, cloned from one loaded world.

    env = kaz.VectorEnv("stand", num_envs=16, engine="native")
    observations, infos = env.reset(seed=1)
    for _ in range(500):
        actions = numpy.zeros(env.action_space.shape, numpy.float32)
        observations, rewards, terminations, truncations, infos = env.step(actions)

engine: the simulated parts of the robot. With "none", PD loops on the true angles replace the firmware, and
observed angles are the true angles. "native" also simulates the firmware's C code, the serial line and the
potentiometers. "h8" runs the firmware image in the emulator instead of the C code.

An action has a number from -1 to 1 for each controlled joint. The number times `reach` (rad) is the joint's
offset from the posture HOME. A period is 20 ms. If Gymnasium is missing, the spaces are `Box` and `Dict` from
this module. Both have the most important members of Gymnasium's classes.
"""

import os

import numpy

from ._kaz import HOME, JOINTS, BallDetector, Batch, UsageError

try:
    from gymnasium.spaces import Box, Dict  # type: ignore
except ImportError:
    class Box:  # type: ignore
        """Space of arrays whose numbers are between `low` and `high`."""

        def __init__(self, low, high, shape=None, dtype=numpy.float32, seed=None):
            self.dtype = numpy.dtype(dtype)
            self.low = numpy.broadcast_to(numpy.asarray(low, dtype), shape or numpy.shape(low)).copy()
            self.high = numpy.broadcast_to(numpy.asarray(high, dtype), self.low.shape).copy()
            self.shape = self.low.shape
            self._random = numpy.random.default_rng(seed)

        def sample(self):
            if self.dtype.kind == "u":
                return self._random.integers(self.low, self.high, dtype=self.dtype, endpoint=True)
            low, high = numpy.maximum(self.low, -1e6), numpy.minimum(self.high, 1e6)
            return self._random.uniform(low, high).astype(self.dtype)

        def contains(self, x):
            x = numpy.asarray(x)
            return x.shape == self.shape and numpy.can_cast(x.dtype, self.dtype) and bool(
                numpy.all(x >= self.low) and numpy.all(x <= self.high))

        def __contains__(self, x):
            return self.contains(x)

        def seed(self, seed=None):
            self._random = numpy.random.default_rng(seed)

    class Dict:  # type: ignore
        """Space of dicts: each name has its own space."""

        def __init__(self, spaces):
            self.spaces = dict(spaces)

        def __getitem__(self, name):
            return self.spaces[name]

        def sample(self):
            return {name: space.sample() for name, space in self.spaces.items()}

        def contains(self, x):
            return isinstance(x, dict) and x.keys() == self.spaces.keys() and all(
                space.contains(x[name]) for name, space in self.spaces.items())

        def __contains__(self, x):
            return self.contains(x)

        def seed(self, seed=None):
            for space in self.spaces.values():
                space.seed(seed)

try:
    from gymnasium import Env as _Env  # type: ignore
    from gymnasium.vector import VectorEnv as _VectorEnv  # type: ignore
except ImportError:
    class _Env:  # type: ignore
        """Replaces gymnasium.Env if Gymnasium is missing. The class has no `reset`, `step` or spaces."""

        metadata = {"render_modes": []}
        render_mode = None
        spec = None
        _np_random = None

        @property
        def unwrapped(self):
            return self

        @property
        def np_random(self):
            if self._np_random is None:
                self._np_random = numpy.random.default_rng()
            return self._np_random

        def __enter__(self):
            return self

        def __exit__(self, *_):
            self.close()

    class _VectorEnv(_Env):  # type: ignore
        closed = False

try:
    from gymnasium.vector import AutoresetMode as _AutoresetMode  # type: ignore
except ImportError:  # also missing in versions of Gymnasium before 1.1
    _AutoresetMode = {"next_step": "next_step", "same_step": "same_step", "disabled": "disabled"}.get
else:
    _AutoresetMode = {mode.name.lower(): mode for mode in _AutoresetMode}.get

_LEGS = [side + part for side in ("l_", "r_") for part in ("hip_roll", "hip_pitch", "knee", "ankle_pitch")]
_ARMS = [side + part for side in ("l_", "r_") for part in ("sh_pitch", "sh_roll")]
PICTURES = ("ideal", "real")
AUTORESET_MODES = ("next_step", "same_step", "disabled")


def _up(trunk):
    """Returns the z component of the trunk's z axis in the world: 1 if upright, 0 if lying."""
    x, y = trunk[:, 3], trunk[:, 4]
    return 1 - 2 * (x * x + y * y)


def _heading(trunk):
    x, y, z, w = trunk[:, 3:7].T
    return numpy.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


class _Task:
    """A task for the robots. Each array has a row for each robot."""

    world, joints, reach, features, episode_s = "empty", _LEGS, 0.4, 0, 10.0
    lowest = 0.6  # a trunk below this share of its initial height counts as fallen

    def begin(self, i, random, env):
        """Called when robot i starts an episode."""

    def before(self, env, active):
        """Called before each period. `active` marks the robots whose episode runs."""

    def look(self, env, state):
        """Returns the task's part of the observation, an array of robots x features."""
        return numpy.zeros((env.num_envs, 0))

    def judge(self, env, state, actions):
        """Returns the period's rewards, and an array that marks the robots that have reached the goal."""
        raise NotImplementedError


class Stand(_Task):
    """Stay upright under pushes of 0.2 to 0.8 N s against the trunk, from any side, every 1 to 2 s.

    A robot that only holds the posture HOME withstands pushes of 0.5 N s, and falls at 0.8 N s.

    Reward: 1 per period, minus 1/20 of the actions' mean square. A fall ends the episode.
    """

    joints = _LEGS + _ARMS
    impulse = (0.2, 0.8)

    def begin(self, i, random, env):
        if not hasattr(self, "next_push"):
            self.next_push = numpy.zeros(env.num_envs)
        self.next_push[i] = random.uniform(1, 2)

    def before(self, env, active):
        for i in numpy.flatnonzero(active & (env.time >= self.next_push)):
            random = env.randoms[i]
            size, angle = random.uniform(*self.impulse), random.uniform(0, 2 * numpy.pi)
            env.batch.push(int(i), "trunk", [size * numpy.cos(angle), size * numpy.sin(angle), 0])
            self.next_push[i] = env.time[i] + random.uniform(1, 2)

    def judge(self, env, state, actions):
        return 1 - 0.05 * numpy.mean(actions**2, axis=1), numpy.zeros(env.num_envs, bool)


class Walk(_Task):
    """Walk to within 5 cm of a place that is 0.3 to 0.6 m away, up to 17 degrees to either side.

    Features: the place relative to the trunk, m. Reward: 10 per meter of approach, plus 10 at the place,
    minus 1/100 of the actions' mean square. Arrival or a fall ends the episode.
    """

    features, episode_s = 2, 20.0

    def begin(self, i, random, env):
        if not hasattr(self, "goal"):
            self.goal, self.left = numpy.zeros((env.num_envs, 2)), numpy.zeros(env.num_envs)
        far, aside = random.uniform(0.3, 0.6), random.uniform(-0.3, 0.3)
        self.goal[i] = [far * numpy.cos(aside), far * numpy.sin(aside)]
        self.left[i] = far

    def look(self, env, state):
        off, heading = self.goal - state["trunk"][:, :2], _heading(state["trunk"])
        return numpy.stack([numpy.cos(heading) * off[:, 0] + numpy.sin(heading) * off[:, 1],
                            numpy.cos(heading) * off[:, 1] - numpy.sin(heading) * off[:, 0]], axis=1)

    def judge(self, env, state, actions):
        left = numpy.linalg.norm(self.goal - state["trunk"][:, :2], axis=1)
        there = left < 0.05
        reward = 10 * (self.left - left) + 10 * there - 0.01 * numpy.mean(actions**2, axis=1)
        self.left = left
        return reward, there


class Turn(_Task):
    """Turn on the spot by 0.5 to 2.6 rad, to either side, and stay within 10 degrees for half a second.

    Features: sine and cosine of the remaining angle. Reward: 5 per radian of progress, plus 10 on success,
    minus 1/100 of the actions' mean square. Success or a fall ends the episode.
    """

    features, episode_s, hold_s = 2, 20.0, 0.5

    def begin(self, i, random, env):
        if not hasattr(self, "goal"):
            self.goal, self.left = numpy.zeros(env.num_envs), numpy.zeros(env.num_envs)
            self.held_s = numpy.zeros(env.num_envs)
        self.goal[i] = random.uniform(0.5, 2.6) * random.choice([-1, 1])
        self.left[i], self.held_s[i] = abs(self.goal[i]), 0

    def _rest(self, state):
        off = self.goal - _heading(state["trunk"])
        return numpy.arctan2(numpy.sin(off), numpy.cos(off))

    def look(self, env, state):
        rest = self._rest(state)
        return numpy.stack([numpy.sin(rest), numpy.cos(rest)], axis=1)

    def judge(self, env, state, actions):
        left = numpy.abs(self._rest(state))
        self.held_s = numpy.where(left < numpy.radians(10), self.held_s + env.period_s, 0)
        there = self.held_s >= self.hold_s - 1e-9
        reward = 5 * (self.left - left) + 10 * there - 0.01 * numpy.mean(actions**2, axis=1)
        self.left = left
        return reward, there


class Look(_Task):
    """Keep the left eye on a ball that is pushed at the start.

    Features: the ball's direction in the eye's frame (right, down, ahead). Reward: the cosine of the angle
    between the eye's axis and the ball. A fall ends the episode.
    """

    world, joints, reach, features = "ball", ["neck_pan", "neck_tilt"], 1.2, 3

    def begin(self, i, random, env):
        speed, angle = random.uniform(0.05, 0.25), random.uniform(0, 2 * numpy.pi)
        env.batch.accelerate(i, "ball", [speed * numpy.cos(angle), speed * numpy.sin(angle), 0])

    def look(self, env, state):
        made = numpy.zeros((env.num_envs, 3))
        for i in range(env.num_envs):
            eye = env.batch.link_pose(i, "left_eye")
            way = eye[:3, :3].T @ (state["ball"][i] - eye[:3, 3])
            made[i] = way / max(1e-9, float(numpy.linalg.norm(way)))
        self.direction = made
        return made

    def judge(self, env, state, actions):
        self.look(env, state)
        return self.direction[:, 2], numpy.zeros(env.num_envs, bool)


class Catch(_Task):
    """Search for a ball, walk to it, and lift it 2 cm off the floor for half a second.

    The ball lies out of view, 0.5 m away and 70 degrees to the right. The ball is pushed at the start.

    Features: the ball's position in the left eye's frame (right, down, ahead), m. The last feature is 1 if
    the ball is seen, else 0. With pictures, kaz.vision.BallDetector computes these features from the newest
    left picture. If the detector finds no ball, the position is the last detected position, initially 0.
    Without pictures, the position is ground truth, even if the ball is out of view. The last feature is then
    always 1.

    Reward: 5 per meter by which the midpoint between the hands approaches the ball, plus 0.1 per period in
    which the ball is at least 2 cm off the floor, plus 10 on success. 1/100 of the actions' mean square is
    subtracted. Success or a fall ends the episode.
    """

    world, joints, reach, features, episode_s = "catch", list(JOINTS), 1.2, 4, 60.0
    lowest = 0.4  # the robot must stoop to reach the ball
    clear_m, hold_s = 0.02, 0.5

    def begin(self, i, random, env):
        if not hasattr(self, "left"):
            self.left, self.held_s = numpy.zeros(env.num_envs), numpy.zeros(env.num_envs)
            self.seen = numpy.zeros((env.num_envs, 4))
            self.floor = numpy.zeros(env.num_envs)
            self.detector = BallDetector()
        ball = env.batch.state()["ball"][i]
        self.left[i], self.held_s[i], self.seen[i], self.floor[i] = self._far(i, ball, env), 0, 0, ball[2]
        speed, angle = random.uniform(0, 0.1), random.uniform(0, 2 * numpy.pi)
        env.batch.accelerate(i, "ball", [speed * numpy.cos(angle), speed * numpy.sin(angle), 0])

    def _far(self, i, ball, env):
        hands = [env.batch.link_pose(i, side + "_hand")[:3, 3] for side in "lr"]
        return float(numpy.linalg.norm(ball - (hands[0] + hands[1]) / 2))

    def look(self, env, state):
        for i in range(env.num_envs):
            if env.pictures is None:
                eye = env.batch.link_pose(i, "left_eye")
                self.seen[i, :3], self.seen[i, 3] = eye[:3, :3].T @ (state["ball"][i] - eye[:3, 3]), 1
                continue
            found = self.detector.find(env.pictures[i, 0], env.batch.camera)
            self.seen[i, 3] = found is not None
            if found:
                self.seen[i, :3] = found["position"]
        return self.seen.copy()

    def judge(self, env, state, actions):
        left = numpy.array([self._far(i, state["ball"][i], env) for i in range(env.num_envs)])
        clear = state["ball"][:, 2] - self.floor >= self.clear_m
        self.held_s = numpy.where(clear, self.held_s + env.period_s, 0)
        caught = self.held_s >= self.hold_s - 1e-9
        reward = (5 * (self.left - left) + 0.1 * clear + 10 * caught
                  - 0.01 * numpy.mean(actions**2, axis=1))
        self.left = left
        return reward, caught


TASKS = {"stand": Stand, "walk": Walk, "turn": Turn, "look": Look, "catch": Catch}


class VectorEnv(_VectorEnv):
    """Robots that are reset and stepped together.

    task: a name from TASKS, or an object with the same members as these tasks. threads: number of threads; 0
    means one thread per core. autoreset_mode: "next_step" (Gymnasium's default), "same_step" (the last
    observation is in infos["final_obs"]), or "disabled" (the caller resets ended episodes with
    reset(options={"reset_mask": ...})). Other arguments, such as sensors, dynamics and imu, go to the
    simulation.

    One call at a time: while step() or reset() runs, another thread's call raises RuntimeError.

    pictures: the kind of eyes, "ideal" or "real"; not valid with engine "none". With pictures, each
    observation is a dict. "state" is the observation without pictures. "pictures" is the newest pair of
    pictures that has reached the host; the eyes take 30 pairs per second. The shape of "pictures" is
    robots x 2 (left, right) x height x width x 3 bytes (RGB). infos["picture_age_s"] is the time since the
    pair's exposure.
    """

    def __init__(self, task="stand", num_envs=8, engine="native", threads=0, autoreset_mode="next_step",
                 episode_s=None, pictures=None, **simulation):
        if task is None:
            raise TypeError(
                f"task=None: give one of {', '.join(TASKS)}, or an object with the members of kaz.env.Stand")
        if isinstance(task, str) and task not in TASKS:
            raise UsageError(
                f"no task '{task}': give one of {', '.join(TASKS)}, or an object with the members of "
                "kaz.env.Stand")
        if autoreset_mode not in AUTORESET_MODES:
            raise UsageError(f"autoreset_mode '{autoreset_mode}': give one of {', '.join(AUTORESET_MODES)}")
        if pictures is not None and pictures not in PICTURES:
            raise UsageError(f"pictures '{pictures}': give one of {', '.join(PICTURES)}, or None")
        self.task = TASKS[task]() if isinstance(task, str) else task
        self.num_envs, self.engine, self.autoreset_mode = num_envs, engine, autoreset_mode
        self.metadata = {"render_modes": [], "autoreset_mode": _AutoresetMode(autoreset_mode)}
        self.period_s = 0.02
        self.episode_s = self.task.episode_s if episode_s is None else episode_s
        simulation.setdefault("world", self.task.world)
        simulation.setdefault("imu", True)
        if pictures is not None:
            simulation.update(pictures=True, eyes=pictures)
        self.pictures = None  # of the last step or reset
        self._has_pictures = pictures is not None
        threads = threads or len(os.sched_getaffinity(0))
        self.batch = Batch(robots=num_envs, engine=engine, threads=min(threads, num_envs),
                           posture=list(HOME), period_s=self.period_s, **simulation)
        self._controlled = [JOINTS.index(name) for name in self.task.joints]
        count = len(self._controlled)
        self._home = numpy.array(HOME)
        size = len(JOINTS) + 3 + count + self.task.features
        self.single_action_space = Box(-numpy.ones(count, numpy.float32), numpy.ones(count, numpy.float32))
        self.action_space = Box(-numpy.ones((num_envs, count), numpy.float32),
                                numpy.ones((num_envs, count), numpy.float32))
        infinite = numpy.full(size, numpy.inf, numpy.float32)
        every = numpy.tile(infinite, (num_envs, 1))
        self.single_observation_space = self._space(Box(-infinite, infinite), ())
        self.observation_space = self._space(Box(-every, every), (num_envs,))
        self.time = numpy.zeros(num_envs)
        self.randoms = [None] * num_envs
        self._action = numpy.zeros((num_envs, count))
        self._done = numpy.ones(num_envs, bool)
        self._begun = False

    def _space(self, state, shape):
        if not self._has_pictures:
            return state
        camera = self.batch.camera
        return Dict({"state": state, "pictures": Box(
            0, 255, shape + (2, camera.height, camera.width, 3), numpy.uint8)})

    def reset(self, *, seed=None, options=None):
        """Resets the robots and returns observations, infos.

        seed: a number is the first robot's seed, and the following robots use seed + 1, seed + 2 and so on. A
        list contains one seed per robot. With None, the current sequences of random numbers continue.
        options["reset_mask"]: the robots to reset."""
        mask = numpy.ones(self.num_envs, bool)
        if options and "reset_mask" in options:
            mask = numpy.asarray(options["reset_mask"], bool)
            if mask.shape != (self.num_envs,):
                raise UsageError(f"reset_mask: the shape is {mask.shape}, and must be ({self.num_envs},)")
        seeds = [None] * self.num_envs
        if seed is not None:
            seeds = [seed + i for i in range(self.num_envs)] if numpy.ndim(seed) == 0 else list(seed)
            if len(seeds) != self.num_envs:
                raise UsageError(f"seed: give one seed, or a list of {self.num_envs} seeds")
        if self.batch is None:
            raise UsageError("the environment is closed: make a new environment")
        for i in numpy.flatnonzero(mask):
            if seeds[i] is not None or self.randoms[i] is None:
                self.randoms[i] = numpy.random.default_rng(seeds[i])
        self._np_random = self.randoms[0]
        self._restart(mask)
        state = self.batch.state()
        return self._observe(state), self._ages(state)

    def step(self, actions):
        if not self._begun or self.batch is None:
            raise UsageError("step: call reset() first" if not self._begun else
                             "the environment is closed: make a new environment")
        actions = numpy.asarray(actions, float)
        if actions.shape != self._action.shape:
            raise UsageError(f"actions: the shape is {actions.shape}, and must be {self._action.shape}")
        restarting = numpy.zeros(self.num_envs, bool)
        if self._done.any():
            if self.autoreset_mode == "disabled":
                raise UsageError("an episode has ended: call reset(options={'reset_mask': ...}) first")
            restarting = self._done.copy()  # "next_step"
            self._restart(restarting)
        active = ~restarting
        self._action[active] = numpy.clip(actions[active], -1, 1)
        self.task.before(self, active)
        targets = numpy.tile(self._home, (self.num_envs, 1))
        targets[:, self._controlled] += self.task.reach * self._action
        self.batch.step(targets, restarting.astype(numpy.uint8))
        self.time[active] += self.period_s
        state = self.batch.state()
        rewards, reached = self.task.judge(self, state, self._action)
        rewards = numpy.where(active, rewards, 0.0)
        trunk = state["trunk"]
        lowest = getattr(self.task, "lowest", 0.6) * self._height
        fell = (_up(trunk) < 0.6) | (trunk[:, 2] < lowest) | state["off"]
        terminations = active & (fell | reached)
        truncations = active & ~terminations & (self.time >= self.episode_s - 1e-9)
        observations = self._observe(state)
        self._done = terminations | truncations
        infos = {"time_s": self.time.copy(), "fell": active & fell, "reached": active & reached & ~fell,
                 **self._ages(state)}
        if self.autoreset_mode == "same_step" and self._done.any():
            infos["final_obs"], infos["_final_obs"] = observations, self._done.copy()
            self._restart(self._done.copy())
            state = self.batch.state()
            observations = self._observe(state)
            infos.update(self._ages(state))
        return observations, rewards, terminations, truncations, infos

    def render(self):
        raise UsageError(
            "render: not supported; give the argument `pictures`, or watch a run with `kaz run --view`")

    def close(self, **_):
        self.batch = None
        self.closed = True

    def _restart(self, mask):
        seeds = [int(self.randoms[i].integers(1 << 62)) if mask[i] else None for i in range(self.num_envs)]
        self.batch.reset(seeds)
        self.time[mask], self._action[mask], self._done[mask] = 0, 0, False
        if not self._begun:
            self._height = self.batch.state()["trunk"][:, 2].copy()
        self._height[mask] = self.batch.state()["trunk"][mask, 2]
        for i in numpy.flatnonzero(mask):
            self.task.begin(int(i), self.randoms[i], self)
        self._begun = True

    def _ages(self, state):
        return {"picture_age_s": state["picture_age"]} if self._has_pictures else {}

    def _observe(self, state):
        if self._has_pictures:
            self.pictures = self.batch.pictures()
        made = numpy.concatenate([state["measured"] - self._home, 0.1 * state["inertial"], self._action,
                                  self.task.look(self, state)], axis=1).astype(numpy.float32)
        return {"state": made, "pictures": self.pictures} if self._has_pictures else made


class Env(_Env):
    """One robot, with the interface of gymnasium.Env.

    Accepts the arguments of VectorEnv, except num_envs, threads and autoreset_mode.
    """

    metadata = {"render_modes": []}
    render_mode = None

    def __init__(self, task="stand", engine="native", episode_s=None, pictures=None, **simulation):
        for name in ("num_envs", "threads", "autoreset_mode"):
            if name in simulation:
                raise UsageError(f"{name}: only valid with VectorEnv; an Env has one robot")
        self._one = VectorEnv(task, num_envs=1, engine=engine, threads=1, autoreset_mode="disabled",
                              episode_s=episode_s, pictures=pictures, **simulation)
        self.action_space = self._one.single_action_space
        self.observation_space = self._one.single_observation_space

    def reset(self, *, seed=None, options=None):
        """Resets the robot and returns observation, infos. `options` is ignored."""
        observation, infos = self._one.reset(seed=seed)
        self._np_random = self._one.randoms[0]
        return _first(observation), {name: row[0].item() for name, row in infos.items()}

    def step(self, action):
        """Returns observation, reward, terminated, truncated, infos. After the end of an episode, call
        reset() first."""
        observation, reward, ended, cut, infos = self._one.step(numpy.asarray(action, float)[None])
        return (_first(observation), float(reward[0]), bool(ended[0]), bool(cut[0]),
                {name: row[0].item() for name, row in infos.items()})

    def render(self):
        return self._one.render()

    def close(self):
        self._one.close()


def _first(observation):
    if isinstance(observation, dict):
        return {name: row[0] for name, row in observation.items()}
    return observation[0]
