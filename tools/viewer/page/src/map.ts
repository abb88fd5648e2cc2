// The robot's map from above: free floor, obstacles, path, the robot.
// SPDX-License-Identifier: Apache-2.0
import type { Grid, Pose } from "./ros1";

export function drawMap(canvas: HTMLCanvasElement, grid: Grid, path: Pose[], robot: Pose | undefined): void {
  canvas.width = grid.width;
  canvas.height = grid.height;
  const context = canvas.getContext("2d");
  if (!context || grid.width === 0) return;
  const picture = context.createImageData(grid.width, grid.height);
  grid.cells.forEach((cell, i) => {
    const row = grid.height - 1 - Math.floor(i / grid.width);
    picture.data.set(cell < 0 ? [128, 128, 128, 40] : cell > 50 ? [213, 94, 0, 255] : [160, 200, 230, 255],
      4 * (row * grid.width + i % grid.width));
  });
  context.putImageData(picture, 0, 0);
  const at = (pose: Pose): [number, number] => [
    (pose.position[0] - grid.origin.position[0]) / grid.resolution,
    grid.height - (pose.position[1] - grid.origin.position[1]) / grid.resolution];
  context.strokeStyle = "#000";
  context.lineWidth = 1.5;
  context.beginPath();
  path.forEach((pose, i) => { i === 0 ? context.moveTo(...at(pose)) : context.lineTo(...at(pose)); });
  context.stroke();
  if (robot) {
    context.fillStyle = "#0072b2";
    context.beginPath();
    context.arc(...at(robot), 4, 0, 2 * Math.PI);
    context.fill();
  }
}
