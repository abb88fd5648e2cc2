// The robot of a URDF falls when it is pushed.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <string>

#include "sim/body/world/world.h"

int main(int count, char** arguments) {
  if (count != 2) return std::puts("usage: body PREFIX/share/kaz"), 2;
  const std::string data = arguments[1];
  auto world = kaz::sim::World::load(data + "/worlds/empty.sdf", data + "/robot/kaz/kaz.urdf", {});
  if (!world) return std::puts(world.error().message.c_str()), 1;
  const std::array<kaz::sim::MotorDrive, 18> off{};
  const double before = (*world)->link_pose("trunk").translation().z();
  if (!(*world)->push("trunk", {2, 0, 0})) return 1;  // N s
  for (int i = 0; i < 2000; ++i) (*world)->step(off, 10);
  const double after = (*world)->link_pose("trunk").translation().z();
  std::printf("the trunk sank from %.3f to %.3f m\n", before, after);
  return after < before - 0.05 ? 0 : 1;
}
