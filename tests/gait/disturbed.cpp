// Files of a robot and a world that differ a little from seed to seed.
// SPDX-License-Identifier: Apache-2.0
#include "tests/gait/disturbed.h"

#include <unistd.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <sstream>
#include <utility>

#include "shared/base/random.hpp"

namespace kaz::gait {
namespace {

namespace fs = std::filesystem;

Result<std::string> read(const fs::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) return fail(Fault::usage, path.string() + ": cannot be read");
  return text.str();
}

Result<void> write(const fs::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out)
    return fail(Fault::environment, path.string() + ": cannot be written; is the disk full?");
  return {};
}

std::string digits(double value) {
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}

// The number after each `before`, up to the next quote, replaced by what `change` makes of it.
std::string with_numbers(const std::string& text, const std::string& before,
                         const std::function<double(double)>& change) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t at = 0; (at = text.find(before, from)) != std::string::npos;) {
    at += before.size();
    const std::size_t end = text.find('"', at);
    if (end == std::string::npos) break;
    out.append(text, from, at - from);
    out += digits(change(std::stod(text.substr(at, end - at))));
    from = end;
  }
  return out.append(text, from, std::string::npos);
}

// Each <inertial> by a factor of its own.
std::string with_other_masses(const std::string& urdf, std::uint64_t seed) {
  std::string out;
  std::size_t from = 0;
  std::uint64_t number = 0;
  for (std::size_t at = 0; (at = urdf.find("<inertial>", from)) != std::string::npos;) {
    std::size_t end = urdf.find("</inertial>", at);
    if (end == std::string::npos) break;
    const double factor = 1 + 0.05 * noise(seed, Noise::mass, number++);
    const auto scaled = [factor](double value) { return factor * value; };
    std::string inertial = with_numbers(urdf.substr(at, end - at), "<mass value=\"", scaled);
    for (const char* moment : {"ixx=\"", "iyy=\"", "izz=\"", "ixy=\"", "ixz=\"", "iyz=\""})
      inertial = with_numbers(inertial, moment, scaled);
    out.append(urdf, from, at - from).append(inertial);
    from = end;
  }
  return out.append(urdf, from, std::string::npos);
}

std::string with_motors(std::string xml, Motors motors) {
  const auto set = [&xml](const std::string& name, double value) {
    xml = with_numbers(xml, name + " value=\"", [value](double) { return value; });
  };
  if (motors == Motors::product) return xml;
  // A motor that says nothing of heat stays cold, one without backlash has none.
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
  // No floor of less than a fifth of its friction, however far out its seed is.
  const double mu = around.mu * std::max(0.2, 1 + around.mu_spread * noise(seed, Noise::friction, 0));
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

Result<DisturbedFiles> DisturbedFiles::make(const std::string& robot, const Surroundings& around,
                                            std::uint64_t seed) {
  static std::atomic<int> count = 0;
  std::error_code wrong;
  const fs::path folder = fs::temp_directory_path(wrong) /
                          ("kaz_gait_" + std::to_string(getpid()) + "_" + std::to_string(++count));
  if (wrong || !fs::create_directories(folder, wrong))
    return fail(Fault::environment, folder.string() + ": cannot be made: " + wrong.message());
  DisturbedFiles files(folder);
  const fs::path from = robot;
  for (const char* name : {"kaz.urdf", "motor.xml", "camera.json", "sensors.xml"}) {
    auto text = read(from / name);
    if (!text) return tl::unexpected(text.error());
    if (name == std::string("kaz.urdf")) *text = with_other_masses(*text, seed);
    if (name == std::string("motor.xml")) *text = with_motors(*text, around.motors);
    if (auto written = write(folder / name, *text); !written)
      return tl::unexpected(written.error());
  }
  if (auto written = write(files.world(), world_of(around, seed)); !written)
    return tl::unexpected(written.error());
  return files;
}

DisturbedFiles::DisturbedFiles(DisturbedFiles&& other) noexcept
    : folder_(std::exchange(other.folder_, {})) {}

DisturbedFiles::~DisturbedFiles() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace kaz::gait
