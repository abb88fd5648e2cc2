// Reads `lost_s` of the simulator's status.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/time_lost.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/robot/control_socket.h"
#include "shared/base/time.hpp"

namespace kaz::tools {
namespace {

constexpr double kMaxLost_s = 1e9;  // more is no answer of a simulator

}  // namespace

host::LatenessMeter::TimeLost time_lost_behind(const std::string& port) {
  const std::string path = port + ".ctl";
  std::error_code none;
  if (!std::filesystem::is_socket(path, none)) return nullptr;
  // A simulator that does not answer once is not asked again: it would hold up each measurement.
  return [path, answers = true]() mutable -> std::optional<Time> {
    if (!answers) return std::nullopt;
    const auto reply = host::query_control_socket(path, "status");
    const auto status = nlohmann::json::parse(reply.value_or(""), nullptr, false);
    answers = status.is_object() && status.contains("lost_s") && status["lost_s"].is_number();
    if (!answers) return std::nullopt;
    const double lost_s = status["lost_s"].get<double>();
    answers = lost_s >= 0 && lost_s < kMaxLost_s;
    return answers ? std::optional(from_seconds(lost_s)) : std::nullopt;
  };
}

}  // namespace kaz::tools
