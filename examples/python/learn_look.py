#!/usr/bin/env python3
# Learns to look at a rolling ball: an evolution strategy on kaz.VectorEnv, 40 lines; needs the package kaz.
# SPDX-License-Identifier: Apache-2.0
"""Learns to turn the head from the ball's direction in the eye, and plots the reward.

usage: PYTHONPATH=build/release/python python3 learn_look.py [GENERATIONS]

A policy is a matrix from 8 numbers (the ball's direction, the last action, the neck's two angles, 1) to two
joints. 32 robots try 16 changes of it, each in both directions. The policy follows the better ones.
"""

import sys

import numpy

import kaz

GENERATIONS = int(sys.argv[1]) if len(sys.argv) > 1 else 40
ROBOTS, STEP, SIGMA = 32, 0.3, 0.1
random = numpy.random.default_rng(1)
env = kaz.VectorEnv("look", num_envs=ROBOTS, engine="native", episode_s=1.2, autoreset_mode="disabled")
policy = numpy.zeros((2, 8))
neck = [kaz.JOINTS.index("neck_pan"), kaz.JOINTS.index("neck_tilt")]


def earned(policies, seed):
    """Returns the mean reward of each policy, with the same balls for all."""
    observation, _ = env.reset(seed=[seed] * ROBOTS)
    total, periods = numpy.zeros(ROBOTS), 0
    done = numpy.zeros(ROBOTS, bool)
    while not done.any():
        ones = numpy.ones((ROBOTS, 1))
        seen = numpy.hstack([observation[:, -3:], observation[:, 21:23], observation[:, neck], ones])
        actions = numpy.tanh(numpy.einsum("rij,rj->ri", policies, seen))
        observation, reward, ended, cut, _ = env.step(actions)
        total, periods, done = total + reward, periods + 1, ended | cut
    return total / periods


history = []
for generation in range(GENERATIONS):
    noise = random.normal(size=(ROBOTS // 2,) + policy.shape)
    both = numpy.concatenate([noise, -noise])
    reward = earned(policy + SIGMA * both, 1000 + generation)
    better = (reward - reward.mean()) / (reward.std() + 1e-9)
    policy += STEP * numpy.einsum("r,rij->ij", better, both) / ROBOTS
    history.append(float(earned(numpy.repeat(policy[None], ROBOTS, 0), 1)[0]))
    print(f"{generation + 1:3d}  cosine to the ball {history[-1]:.3f}", flush=True)
numpy.save("look.npy", policy)
try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plot
    plot.plot(range(1, GENERATIONS + 1), history)
    plot.xlabel("generation"), plot.ylabel("cosine of the angle to the ball")
    plot.savefig("look.png")
except ImportError:
    print("python3-matplotlib is not installed: no look.png")
