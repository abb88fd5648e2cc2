# kaz.vision: the robot's vision on numpy pictures.
# SPDX-License-Identifier: Apache-2.0
"""Finds balls, depth, flow and planes in pictures, which are arrays of height x width x 3 bytes (RGB).

    pair = sim.pairs()[-1]
    ball = kaz.vision.BallDetector().find(pair.left, pair.camera)      # a dict, or None
    disparity = kaz.vision.DepthFinder().find(pair.left, pair.right, pair.camera)   # px; 0: unknown
"""

from ._kaz import BallDetector, DepthFinder, FlowFinder, PlaneFinder

__all__ = ["BallDetector", "DepthFinder", "FlowFinder", "PlaneFinder", "depth_of"]


def depth_of(disparity, camera):
    """Returns the depth along the optical axis (m) for a disparity image (px); NaN where unknown."""
    import numpy
    with numpy.errstate(divide="ignore", invalid="ignore"):
        return numpy.where(disparity > 0, camera.fx * camera.baseline_m / disparity, numpy.nan)
