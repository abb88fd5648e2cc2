// The identified servo that a fit gives, and its comparison with a shipped servo.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_identity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

using servo_model::IdentifiedServo;
using servo_model::ServoDifference;
using Json = nlohmann::ordered_json;

double mean_volts(const std::vector<hil::ServoLog>& logs) {
  double sum = 0, count = 0;
  for (const hil::ServoLog& log : logs) {
    for (const hil::ServoSample& one : log.samples) sum += one.volts;
    count += static_cast<double>(log.samples.size());
  }
  return std::round(100 * sum / count) / 100;
}

std::string with_tolerance(double value, double within) {
  char text[60];
  if (std::isnan(value)) return "-";
  if (std::isfinite(within))
    std::snprintf(text, sizeof text, "%.4g +- %.2g", value, within);
  else
    std::snprintf(text, sizeof text, "%.4g, not determined", value);
  return text;
}

std::string verdict_on(const ServoDifference& one) {
  if (std::isnan(one.shipped) || std::isnan(one.own)) return "only in one model";
  if (!std::isfinite(one.shipped_within + one.own_within)) return "unknown";
  return one.differs ? "differs" : "agrees";
}

Json value_json(double value, double within) {
  if (std::isnan(value)) return nullptr;
  Json json{{"value", value}};
  if (std::isfinite(within)) json["within"] = within;
  return json;
}

}  // namespace

IdentifiedServo identified_servo(const ServoResult& result, const std::string& servo) {
  const hil::ServoFit& best = result.best();
  IdentifiedServo made;
  made.servo = servo;
  made.volts = std::clamp(mean_volts(result.logs), 1.0, 60.0);
  made.model = best.model;
  for (const hil::FittedServoParam& one : best.fitted)
    made.identified.push_back({one.of, one.value, one.determined_within});
  made.source = "fitted by kaz bench servo";
  made.license = "not stated";
  made.date = provenance().date.substr(0, 10);
  made.logs = std::to_string(result.logs.size()) + " logs fitted, " +
              std::to_string(result.held_out.size()) + " held out";
  if (!result.held_out.empty()) made.held_out_rad = best.held_out.position_rad;
  if (!result.score.groups.empty()) made.floor_rad = result.score.groups.front().floor_rad;
  return made;
}

Result<IdentifiedServo> named_servo(const std::string& name) {
  if (std::filesystem::path(name).has_extension()) return servo_model::load_servo_file(name);
  return servo_model::shipped_servo(name);
}

std::string differences_text(const std::string& name, const std::vector<ServoDifference>& all) {
  char line[200];
  std::snprintf(line, sizeof line, "%-18s%-10s%-24s%-24s\n", "parameter", "unit",
                name.substr(0, 22).c_str(), "this servo");
  std::string text = line;
  for (const ServoDifference& one : all) {
    std::snprintf(line, sizeof line, "%-18s%-10s%-24s%-24s%s\n", one.name.c_str(), one.unit.c_str(),
                  with_tolerance(one.shipped, one.shipped_within).c_str(),
                  with_tolerance(one.own, one.own_within).c_str(), verdict_on(one).c_str());
    text += line;
  }
  return text;
}

Json differences_json(const std::string& name, const std::vector<ServoDifference>& all) {
  Json json{{"servo", name}, {"params", Json::object()}};
  for (const ServoDifference& one : all)
    json["params"][one.name] = {{"unit", one.unit},
                                {"shipped", value_json(one.shipped, one.shipped_within)},
                                {"own", value_json(one.own, one.own_within)},
                                {"verdict", verdict_on(one)}};
  return json;
}

}  // namespace kaz::tools
