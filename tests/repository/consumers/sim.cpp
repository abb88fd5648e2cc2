// A simulated robot, its board executing the firmware, falls when it is pushed.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>

#include "sim/runtime/simulation/simulation.h"

int main(int count, char** arguments) {
  if (count != 2) return std::puts("usage: sim PREFIX/share/kaz"), 2;
  const std::string data = arguments[1];
  kaz::sim::SimulationOptions options;
  options.mcu = kaz::sim::McuKind::h8;
  options.image_path = data + "/firmware/kaz.mot";
  options.world_path = data + "/worlds/empty.sdf";
  options.robot_path = data + "/robot/kaz/kaz.urdf";
  options.camera_path = data + "/robot/kaz/camera.json";
  auto simulation = kaz::sim::Simulation::create(options);
  if (!simulation) return std::puts(simulation.error().message.c_str()), 1;
  const double before = (*simulation)->world().link_pose("trunk").translation().z();
  if (!(*simulation)->world().push("trunk", {2, 0, 0})) return 1;  // N s
  for (int ms = 0; ms < 1500; ++ms) {
    const auto stepped = (*simulation)->step();
    if (!stepped) return std::puts(stepped.error().message.c_str()), 1;
  }
  const double after = (*simulation)->world().link_pose("trunk").translation().z();
  std::printf("the trunk sank from %.3f to %.3f m\n", before, after);
  return after < before - 0.05 ? 0 : 1;
}
