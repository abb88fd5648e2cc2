// A temporary folder with modified copies of a robot's files; removed with the object.
// SPDX-License-Identifier: Apache-2.0
#include "tools/trials/robot_folder.h"

#include <sstream>

#include "shared/base/files.hpp"

namespace kaz::trials {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWorld = "world.sdf";
constexpr const char* kOfRobot[] = {"kaz.urdf", "motor.xml", "camera.json", "sensors.xml"};

Result<std::string> read(const fs::path& path) {
  constexpr std::size_t max_bytes = 16 << 20;
  return read_whole_file(path.string(), max_bytes,
                         "give the folder that contains kaz.urdf and the robot's other files");
}

Result<void> write(const fs::path& path, const std::string& text) {
  return write_whole_file(path.string(), text);
}

}  // namespace

std::string digits(double value) {
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}

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

std::string with_masses(const std::string& urdf,
                        const std::function<double(std::uint64_t)>& factor) {
  std::string out;
  std::size_t from = 0;
  std::uint64_t number = 0;
  for (std::size_t at = 0; (at = urdf.find("<inertial>", from)) != std::string::npos;) {
    const std::size_t end = urdf.find("</inertial>", at);
    if (end == std::string::npos) break;
    const double by = factor(number++);
    std::string inertial = urdf.substr(at, end - at);
    for (const char* value :
         {"<mass value=\"", "ixx=\"", "iyy=\"", "izz=\"", "ixy=\"", "ixz=\"", "iyz=\""})
      inertial = with_numbers(inertial, value, [by](double v) { return by * v; });
    out.append(urdf, from, at - from).append(inertial);
    from = end;
  }
  return out.append(urdf, from, std::string::npos);
}

Result<RobotFolder> RobotFolder::make(const std::string& robot,
                                      const std::map<std::string, Change>& changes,
                                      const std::string& world) {
  const auto made = KAZ_TRY(make_temporary_folder("kaz-robot-"));
  const fs::path folder = made;
  RobotFolder files(folder);
  for (const char* name : kOfRobot) {
    auto text = read(fs::path(robot) / name);
    if (!text) return tl::unexpected(text.error());
    if (const auto change = changes.find(name); change != changes.end())
      *text = change->second(*text);
    KAZ_TRY(write(folder / name, *text));
  }
  KAZ_TRY(write(files.world(), world));
  return files;
}

Result<void> RobotFolder::each(const Keep& keep) const {
  const auto world = KAZ_TRY(read(folder_ / kWorld));
  KAZ_TRY(keep(kWorld, world));
  for (const char* name : kOfRobot) {
    const auto contents = KAZ_TRY(read(folder_ / name));
    KAZ_TRY(keep(name, contents));
  }
  return {};
}

RobotFolder::~RobotFolder() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace kaz::trials
