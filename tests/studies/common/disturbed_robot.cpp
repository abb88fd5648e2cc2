// Writes robot and world files with random variations by seed.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/common/disturbed_robot.h"

#include "shared/base/random.hpp"

namespace kaz::studies {
namespace {

using trials::digits, trials::with_numbers;

std::string with_motors(std::string xml, Motors motors) {
  const auto set = [&xml](const std::string& name, double value) {
    xml = with_numbers(xml, name + " value=\"", [value](double) { return value; });
  };
  if (motors == Motors::product) return xml;
  // Without these elements a motor has neither heating nor backlash.
  for (const char* name :
       {"backlash_degrees", "winding_heat_capacity", "winding_to_case", "case_heat_capacity",
        "case_to_air", "copper_per_kelvin", "air_celsius"}) {
    const std::size_t at = xml.find(std::string(name) + " value");
    if (at != std::string::npos) xml.erase(at - 1, xml.find("/>", at) + 3 - at);
  }
  if (motors == Motors::ideal) return xml;
  set("<stall_slope", 0.216);
  set("<friction", 0.05);
  set("<stiction_ratio", 1);
  set("<back_emf", 0.1885);
  return xml;
}

std::string world_of(const Surroundings& around, std::uint64_t seed) {
  // At least a fifth of the mean, whatever the seed.
  const double mu =
      around.mu * std::max(0.2, 1 + around.mu_spread * noise(seed, Noise::friction, 0));
  std::string text = R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="gait">
<model name="floor"><static>true</static><link name="l"><collision name="c">
<geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
<surface><friction><ode><mu>)" +
                     digits(mu) + R"(</mu></ode></friction></surface></collision></link></model>
)";
  if (around.ball) {
    text += "<model name=\"ball\"><pose>" + digits(around.ball->x()) + " " +
            digits(around.ball->y()) + R"( 0.02 0 0 0</pose><link name="ball">
<inertial><mass>0.015</mass><inertia><ixx>2.4e-6</ixx><iyy>2.4e-6</iyy><izz>2.4e-6</izz>
<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial><collision name="c">
<geometry><sphere><radius>0.02</radius></sphere></geometry><surface>
<friction><ode><mu>1.0</mu></ode></friction><kaz:rolling_resistance metres="0.0005"/></surface>
</collision></link></model>
)";
  }
  return text + "</world></sdf>\n";
}

}  // namespace

double noise(std::uint64_t seed, Noise what, std::uint64_t number) {
  return keyed_normal(seed, number, static_cast<std::uint64_t>(what));
}

Result<trials::RobotFolder> disturbed_files(const std::string& robot, const Surroundings& around,
                                            std::uint64_t seed) {
  const auto factor = [seed](std::uint64_t number) {
    return 1 + 0.05 * noise(seed, Noise::mass, number);
  };
  return trials::RobotFolder::make(
      robot,
      {{"kaz.urdf", [&](const std::string& urdf) { return trials::with_masses(urdf, factor); }},
       {"motor.xml", [&](const std::string& xml) { return with_motors(xml, around.motors); }}},
      world_of(around, seed));
}

}  // namespace kaz::studies
