// A simulated robot in this process: its firmware's C, its world, and the host's client of the board.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>

#include "host/robot/robot.h"
#include "tools/lockstep/lockstep.h"

int main(int count, char** arguments) {
  if (count != 2) return std::puts("usage: lockstep PREFIX/share/kaz"), 2;
  const std::string data = arguments[1];
  kaz::sim::SimulationOptions options;
  options.world_path = data + "/worlds/empty.sdf";
  options.robot_path = data + "/robot/kaz/kaz.urdf";
  options.camera_path = data + "/robot/kaz/camera.json";
  auto simulation = kaz::sim::Simulation::create(options);
  if (!simulation) return std::puts(simulation.error().message.c_str()), 1;
  kaz::lockstep::LockstepClock clock(**simulation);
  kaz::lockstep::LockstepLink link(**simulation);
  auto robot = kaz::host::Robot::connect(link, clock);
  if (!robot) return std::puts(robot.error().message.c_str()), 1;
  if (!robot->enable(1) || !robot->set_targets({{{0, 0.3}}}, std::chrono::milliseconds(500))) return 1;
  if (!robot->clock().sleep_until(clock.now() + std::chrono::seconds(1))) return 1;
  const double angle = robot->state()->angle[0];
  std::printf("neck_pan is at %.2f rad\n", angle);
  return angle > 0.25 && angle < 0.35 ? 0 : 1;
}
