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

The same `Robot` drives a board at a port: kaz.Robot("serial:/dev/ttyUSB0"). Units: m, rad, s, N. Calls raise
UsageError (a ValueError), EnvironmentFault (an OSError, for ports and files) or RobotError.

Threads: each object accepts one call at a time. A second thread's call raises RuntimeError, "in use by
another thread". Robot.stop() and Robot.close() are always accepted. Both switch the motors off and end the
running call. The ended call raises Stopped (a RobotError). A Robot in a Simulation and the Simulation count
as one object.
"""

import importlib.machinery as _machinery
import os as _os
import pathlib as _pathlib
import re as _re
import sys as _sys

# Like the program `kaz`, the compiled module searches KAZ_DATA for robot, worlds and firmware.
_share = _pathlib.Path(__file__).absolute().parent / "share"
if _share.is_dir():
    _os.environ.setdefault("KAZ_DATA", str(_share))


def _what_to_do(error):
    """Returns a message if numpy is missing, or if Kaz has no compiled module for this Python.

    Returns None for other errors.
    """
    folder = _pathlib.Path(__file__).absolute().parent
    this = f"{_sys.executable} (Python {_sys.version_info[0]}.{_sys.version_info[1]})"
    modules = sorted(module.name for module in folder.glob("_kaz.*.so"))
    try:
        built_for = (folder / "built_for.txt").read_text().strip()  # written by CMake into a build folder
    except OSError:
        tag = _re.match(r"_kaz\.cpython-(\d)(\d+)-", modules[0]) if modules else None
        built_for = f"Python {tag[1]}.{tag[2]}" if tag else ""
    if (error.name or "").split(".")[0] == "numpy":
        other = f"use {built_for}, or " if built_for and built_for != this else ""
        return f"kaz needs numpy, but {this} has no numpy: {other}install numpy for this Python"
    if any((folder / f"_kaz{suffix}").exists() for suffix in _machinery.EXTENSION_SUFFIXES):
        return None
    if modules:
        return f"kaz is built for {built_for}, but this program runs on {this}: use {built_for}"
    tree = _pathlib.Path(__file__).resolve().parents[2]
    if not (tree / "tools/dev").exists():
        return f"kaz's compiled module is missing in {folder}: install kaz again"
    return (f"kaz's compiled module is not built: run {tree}/tools/dev build kaz_python, then start "
            f"{built_for or '/usr/bin/python3'} with PYTHONPATH={tree}/build/release/python")


try:
    from . import _kaz, env, vision
    from ._kaz import (
        HOME, JOINT_LIMITS, JOINTS, Camera, CameraModel, EnvironmentFault, Pair, Posture, Robot, RobotError,
        Simulation, Stopped, UsageError, __version__, behaviors, run_behavior)
    from .env import Env, VectorEnv
    from .recording import Recording
except ImportError as _error:
    _sentence = _what_to_do(_error)
    if _sentence is None:
        raise
    raise ImportError(_sentence, name=_error.name) from None

__all__ = [
    "HOME", "JOINTS", "JOINT_LIMITS", "Camera", "CameraModel", "Env", "EnvironmentFault", "Pair", "Posture",
    "Recording", "Robot", "RobotError", "Simulation", "Stopped", "UsageError", "VectorEnv", "__version__",
    "behaviors", "env", "run_behavior", "vision"]
