// Reads `lost_s` and `mcu` of the simulator's status.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/time_lost.h"

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "host/robot/control_socket.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/time.hpp"

namespace kaz::tools {
namespace {

constexpr double kMaxLost_s = 1e9;  // a larger value is invalid
constexpr std::chrono::milliseconds kInterruptedPatience{300};

// Returns an empty path if the port has no control socket.
std::string control_socket_beside(const std::string& port) {
  const std::string path = port + ".ctl";
  std::error_code none;
  return std::filesystem::is_socket(path, none) && access(path.c_str(), W_OK) == 0 ? path : "";
}

}  // namespace

host::LatenessMeter::TimeLost time_lost_behind(const std::string& port,
                                               host::Interrupt& interrupt) {
  const std::string path = control_socket_beside(port);
  if (path.empty()) return nullptr;
  return [path, &interrupt]() -> Result<Time> {
    std::optional<host::CleanUp> clean_up;
    if (interrupt.ends_waiting()) clean_up.emplace(interrupt, kInterruptedPatience);
    const auto reply = KAZ_TRY(host::query_control_socket(path, "status", &interrupt));
    const auto status = parse_bounded_json(reply).value_or(nullptr);
    if (!status.is_object() || !status.contains("lost_s") || !status["lost_s"].is_number())
      return Time::zero();  // a program that does not measure it
    const double lost_s = status["lost_s"].get<double>();
    return from_seconds(lost_s >= 0 && lost_s < kMaxLost_s ? lost_s : 0);
  };
}

std::string simulated_mcu(const std::string& port, const host::Interrupt& interrupt) {
  const std::string path = control_socket_beside(port);
  if (path.empty()) return "";
  const auto reply = host::query_control_socket(path, "status", &interrupt);
  const auto status = parse_bounded_json(reply.value_or("")).value_or(nullptr);
  if (!status.is_object() || !status.contains("mcu") || !status["mcu"].is_string()) return "";
  return status["mcu"].get<std::string>();
}

}  // namespace kaz::tools
