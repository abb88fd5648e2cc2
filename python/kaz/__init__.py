# The package kaz: a simulated desktop humanoid with its emulated servo board, its client, its vision.
# SPDX-License-Identifier: Apache-2.0
"""Kaz in Python: simulate, drive, see, replay.

    import kaz
    sim = kaz.Simulation(world="ball", mcu="h8")
    with kaz.Robot(sim) as robot:
        robot.enable()
        robot.set_targets({"neck_pan": 0.4}, duration=0.5)
        robot.sleep(1)
        print(robot.state().angle[0])

The same `Robot` drives a board at a port: kaz.Robot("serial:/dev/ttyUSB0"). Units: m, rad, s, N. Errors are
UsageError (a ValueError), EnvironmentFault (an OSError: ports, files) and RobotError.
"""

import os as _os
import pathlib as _pathlib

# Robot, worlds and firmware, as `kaz` itself looks for them.
_share = _pathlib.Path(__file__).absolute().parent / "share"
if _share.is_dir():
    _os.environ.setdefault("KAZ_DATA", str(_share))

from . import _kaz, env, vision  # noqa: E402
from ._kaz import (  # noqa: E402
    HOME, JOINT_LIMITS, JOINTS, Camera, CameraModel, EnvironmentFault, Pair, Posture, Robot, RobotError,
    Simulation, UsageError, __version__, behaviors, run_behavior)
from .env import Env, VectorEnv  # noqa: E402
from .recording import Recording  # noqa: E402

__all__ = [
    "HOME", "JOINTS", "JOINT_LIMITS", "Camera", "CameraModel", "Env", "EnvironmentFault", "Pair", "Posture",
    "Recording", "Robot", "RobotError", "Simulation", "UsageError", "VectorEnv", "__version__", "behaviors",
    "env", "run_behavior", "vision"]
