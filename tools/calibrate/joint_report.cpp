// Report of `kaz calibrate joints`.
// SPDX-License-Identifier: Apache-2.0
#include "tools/calibrate/joint_report.h"

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

using calibration::JointEstimate;
using calibration::Stop;
using Json = nlohmann::ordered_json;

// Above it the equations of the floor contradict those of the stops: a sole is not flat, or has slipped.
constexpr double kMaxResidual = 7;
constexpr double kMaxGaugeResidual = 4;   // of one reading
constexpr std::uint32_t kLegs = 0x3fc00;  // joints 10 to 17

const char* name_of(int joint) {
  return host::joint_table()[static_cast<std::size_t>(joint)].name;
}

std::string format(const char* pattern, double a) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, a);
  return text;
}

bool included(const JointReport& report, int joint) {
  return (report.joints >> joint & 1) != 0;
}

const calibration::StopReading* stop_of(const JointReport& report, int joint, Stop stop) {
  for (const auto& reading : report.stop_readings)
    if (reading.joint == joint && reading.stop == stop) return &reading;
  return nullptr;
}

bool contradicts(const JointReport& report, int joint) {
  return report.floor && report.solution && report.solution->worst_residual > kMaxResidual &&
         (kLegs >> joint & 1) != 0;
}

// Change of the angle between the limits, as a share of it.
double gain_change(const JointReport& report, int joint) {
  const auto& line = report.solution->joints[static_cast<std::size_t>(joint)].line;
  return line.scale_rad / calibration::nominal_calibration(joint).scale_rad - 1;
}

std::string stops_text(const JointReport& report, int joint) {
  std::string text;
  for (const Stop stop : {Stop::lower, Stop::upper}) {
    const auto* reading = stop_of(report, joint, stop);
    char one[16] = "      - ";
    if (reading != nullptr)
      std::snprintf(one, sizeof one, "%7.1f%s", reading->code, reading->fault.empty() ? " " : "!");
    text += one;
  }
  return text;
}

}  // namespace

std::string fault_of(const JointReport& report, int joint) {
  if (!included(report, joint)) return "";
  for (const Stop stop : {Stop::lower, Stop::upper}) {
    if (!report.stops) break;
    const std::string which = stop == Stop::lower ? "lower stop: " : "upper stop: ";
    const auto* reading = stop_of(report, joint, stop);
    if (reading == nullptr) return which + "no reading";
    if (!reading->fault.empty()) return which + reading->fault;
  }
  if (!report.solution) return "no result was computed";
  for (const GaugeReading& gauge : report.gauge_readings) {
    if (gauge.joint != joint) continue;
    const double away = report.solution->angle(joint, gauge.code) - gauge.angle_rad;
    if (std::abs(away) > kMaxGaugeResidual * report.gauge_error_rad)
      return "gauge and potentiometer differ by " + format("%.1f", std::abs(away) / kDegree) +
             " deg at the gauge angle " + format("%.1f", gauge.angle_rad / kDegree) +
             " deg: check the reading and its sign";
  }
  if (contradicts(report, joint))
    return "floor readings contradict each other" +
           std::string(report.stops ? " or the stops" : "") + " (" +
           format("%.1f", report.solution->worst_residual) +
           " standard deviations): both soles must be flat on a level floor and must not slip";
  const double expected =
      2 * report.solution->joints[static_cast<std::size_t>(joint)].expected_error_rad;
  const double good = report.gauge ? kGoodByGauge : kGoodError;
  if (expected > good)
    return "expected error " + format("%.2f", expected / kDegree) + " deg: must be at most " +
           format("%.1f", good / kDegree) + " deg" +
           (report.gauge ? "; measure at more angles, or use a better gauge (--gauge-error)" : "");
  return "";
}

std::vector<int> faulty(const JointReport& report) {
  std::vector<int> joints;
  for (int j = 0; j < KZ_JOINTS; ++j)
    if (!fault_of(report, j).empty()) joints.push_back(j);
  return joints;
}

std::string joint_table_text(const JointReport& report) {
  std::string text =
      "joint          stops, codes    shift, deg  gain, %  expected error (95 %), deg: rms, "
      "worst\n";
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (!included(report, j)) continue;
    const std::string fault = fault_of(report, j);
    char line[200];
    if (!fault.empty() || !report.solution) {
      std::snprintf(line, sizeof line, "%-13s %s  ", name_of(j), stops_text(report, j).c_str());
      text += line + fault + "\n";
      continue;
    }
    const JointEstimate& e = report.solution->joints[static_cast<std::size_t>(j)];
    std::snprintf(line, sizeof line, "%-13s %s %+9.2f  %+7.2f  %8.2f %8.2f\n", name_of(j),
                  stops_text(report, j).c_str(), e.shift_rad / kDegree,
                  100 * gain_change(report, j), 2 * e.expected_error_rad / kDegree,
                  2 * e.worst_error_rad / kDegree);
    text += line;
  }
  return text;
}

Json joint_report_json(const JointReport& report) {
  Json joints = Json::array();
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (!included(report, j)) continue;
    const auto i = static_cast<std::size_t>(j);
    Json one{
        {"joint", name_of(j)},
        {"before",
         {{"centre_rad", report.before[i].centre_rad}, {"scale_rad", report.before[i].scale_rad}}}};
    for (const Stop stop : {Stop::lower, Stop::upper}) {
      const auto* reading = stop_of(report, j, stop);
      if (reading == nullptr) continue;
      Json read{{"code", reading->code}, {"spread_codes", reading->spread}};
      if (!reading->fault.empty()) read["fault"] = reading->fault;
      one[stop == Stop::lower ? "lower_stop" : "upper_stop"] = read;
    }
    const std::string fault = fault_of(report, j);
    if (!fault.empty()) one["fault"] = fault;
    if (report.solution) {
      const JointEstimate& e = report.solution->joints[i];
      one["centre_rad"] = e.line.centre_rad;
      one["scale_rad"] = e.line.scale_rad;
      one["moves_deg"] = e.shift_rad / kDegree;
      one["gain_percent"] = 100 * gain_change(report, j);
      one["error_95_deg"] = 2 * e.expected_error_rad / kDegree;
      one["worst_error_deg"] = 2 * e.worst_error_rad / kDegree;
      one["good"] = fault.empty();
    }
    joints.push_back(one);
  }
  Json result{{"port", report.port},   {"board", report.board}, {"seconds", report.seconds},
              {"stops", report.stops}, {"floor", report.floor}, {"gauge", report.gauge},
              {"joints", joints}};
  Json postures = Json::array();
  for (const auto& reading : report.floor_readings) {
    Json one{{"codes", reading.codes}, {"time_s", reading.time_s}};
    if (reading.has_force) {
      one["forward_m_per_s2"] = reading.forward_m_per_s2;
      one["left_m_per_s2"] = reading.left_m_per_s2;
    }
    postures.push_back(one);
  }
  if (report.floor) result["postures"] = postures;
  Json gauges = Json::array();
  for (const auto& reading : report.gauge_readings)
    gauges.push_back({{"joint", name_of(reading.joint)},
                      {"code", reading.code},
                      {"angle_deg", reading.angle_rad / kDegree}});
  if (report.gauge) result["gauge_readings"] = gauges;
  if (report.solution) result["worst_residual"] = report.solution->worst_residual;
  result["stored"] = report.stored.has_value();
  if (report.stored) {
    result["sequence"] = report.stored->sequence;
    result["erases"] = {report.stored->erases_a, report.stored->erases_b};
  }
  if (!report.error) {
    result["outcome"] = faulty(report).empty() ? "done" : "failed";
  } else {
    const Fault fault = report.error->fault;
    result["outcome"] = !report.signal.empty()        ? "interrupted"
                        : fault == Fault::environment ? "environment"
                                                      : "failed";
    result["error"] = report.error->message;
  }
  if (!report.signal.empty()) {
    result["interrupted"] = true;
    result["signal"] = report.signal;
  }
  result["provenance"] = provenance_json();
  return result;
}

std::string joint_report_svg(const JointReport& report) {
  constexpr double kLeft = 130, kPerDegree = 420, kRow = 22, kTop = 46, kWidth = 720;
  const double height = kTop + kRow * KZ_JOINTS + 14;
  char line[400];
  std::snprintf(line, sizeof line,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
                "font-family=\"sans-serif\" font-size=\"12\">\n"
                "<title>Kaz calibrate joints</title>\n<rect width=\"100%%\" height=\"100%%\" "
                "fill=\"white\"/>\n",
                kWidth, height);
  std::string svg = line;
  for (int tenth = 0; tenth <= 10; tenth += 1) {
    const double x = kLeft + kPerDegree * tenth / 10;
    std::snprintf(line, sizeof line,
                  "<line x1=\"%.1f\" y1=\"%.0f\" x2=\"%.1f\" y2=\"%.0f\" stroke=\"%s\"/>\n", x,
                  kTop - 6, x, height - 10, tenth == 5 ? "#b03030" : "#dddddd");
    svg += line;
    if (tenth % 5 != 0) continue;
    std::snprintf(line, sizeof line,
                  "<text x=\"%.1f\" y=\"%.0f\" text-anchor=\"middle\">%.1f&#176;</text>\n", x,
                  kTop - 10, tenth / 10.0);
    svg += line;
  }
  svg +=
      "<text x=\"12\" y=\"18\">Expected error of each joint: 95th percentile over its angles "
      "(dark) and worst angle (light)</text>\n";
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const double y = kTop + kRow * j;
    std::snprintf(line, sizeof line, "<text x=\"12\" y=\"%.0f\">%s</text>\n", y + 14, name_of(j));
    svg += line;
    if (!included(report, j) || !fault_of(report, j).empty()) {
      std::snprintf(line, sizeof line, "<text x=\"%.0f\" y=\"%.0f\" fill=\"#888888\">%s</text>\n",
                    kLeft + 6, y + 14, included(report, j) ? "no result" : "not calibrated");
      svg += line;
      continue;
    }
    const JointEstimate& e = report.solution->joints[static_cast<std::size_t>(j)];
    const double worst = std::min(1.0, 2 * e.worst_error_rad / kDegree);
    const double usual = std::min(1.0, 2 * e.expected_error_rad / kDegree);
    std::snprintf(line, sizeof line,
                  "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.1f\" height=\"12\" fill=\"#a9c4de\"/>\n"
                  "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.1f\" height=\"12\" fill=\"#33638f\"/>\n"
                  "<text x=\"%.0f\" y=\"%.0f\" fill=\"#444444\">shift %+.2f&#176;</text>\n",
                  kLeft, y + 4, kPerDegree * worst, kLeft, y + 4, kPerDegree * usual,
                  kLeft + kPerDegree + 40, y + 14, e.shift_rad / kDegree);
    svg += line;
  }
  return svg + "</svg>\n";
}

}  // namespace kaz::tools
