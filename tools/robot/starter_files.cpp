// Files beside a robot's URDF.
// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/starter_files.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "shared/base/files.hpp"
#include "tools/base/paths.h"

namespace kaz::tools {

std::string starter_bus_file(const sim::RobotModel& robot) {
  std::string text =
      "{\n  \"protocol\": \"feetech\",\n  \"supply_volts\": 7.4,\n  \"supply_ohm\": 0.1,\n"
      "  \"servos\": [\n";
  for (std::size_t i = 0; i < robot.motors(); ++i) {
    text += "    {\"joint\": ";
    text += nlohmann::json(robot.joints[i].name).dump();
    text += ", \"id\": " + std::to_string(i + 1) + ", \"model\": \"sts3215\", \"zero\": 2048}";
    text += i + 1 < robot.motors() ? ",\n" : "\n";
  }
  return text + "  ]\n}\n";
}

Result<std::vector<std::string>> write_starter_files(const sim::RobotModel& robot,
                                                     const std::string& urdf_path) {
  constexpr std::size_t kMaxBytes = 1 << 20;
  std::vector<std::pair<std::string, std::string>> files{{"bus.json", starter_bus_file(robot)}};
  for (const char* name : {"motor.xml", "sensors.xml"}) {
    const std::string source = KAZ_TRY(data_file(std::string("robot/kaz/") + name));
    std::string text = KAZ_TRY(read_whole_file(source, kMaxBytes));
    files.emplace_back(name, std::move(text));
  }
  std::vector<std::string> written;
  for (const auto& [name, text] : files) {
    const auto path = std::filesystem::path(urdf_path).replace_filename(name);
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) continue;
    KAZ_TRY(write_whole_file(path.string(), text));
    written.push_back(name);
  }
  return written;
}

}  // namespace kaz::tools
