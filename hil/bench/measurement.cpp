// The table of measurements, limit files, and the judge.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/measurement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::hil {
namespace {

using Json = nlohmann::json;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<MeasurementInfo> read_table() {
  constexpr double kNoLimit = std::numeric_limits<double>::quiet_NaN();
  std::vector<MeasurementInfo> infos = {
#define KZ_NO_LIMIT kNoLimit
#define KZ_MEASUREMENT(group, name, unit, low, high, text) \
  {BenchGroup::group, name, unit, low, high, text},
#include "hil/bench/measurements.def"
#undef KZ_NO_LIMIT
  };
  for (MeasurementInfo& info : infos) {
    if (std::isnan(info.low)) info.low = -kInfinite;
    if (std::isnan(info.high)) info.high = kInfinite;
  }
  return infos;
}

std::string with_unit(double value, const std::string& unit) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text + (unit.empty() ? "" : " " + unit);
}

// The others are measured by the board's own clock, or are no times.
bool depends_on_lateness(const MeasurementInfo& info) {
  return info.group == BenchGroup::link || info.name == "tick.jitter" ||
         info.name == "tick.clock_error";
}

// The others are the line's own, or counts of the board that come whole or not at all.
bool depends_on_line(const Measurement& one) {
  return one.of->group == BenchGroup::motor ||
         (one.of->group == BenchGroup::tick &&
          (std::isnan(one.value) || depends_on_lateness(*one.of)));
}

// The judgement in words; empty: the value is as it should be.
std::string what_is_wrong(const Measurement& one) {
  const std::string& unit = one.of->unit;
  if (std::isnan(one.value)) return "the measurement gave no value";
  if (one.value < one.low) {
    return with_unit(one.value, unit) + " is below the limit of " + with_unit(one.low, unit);
  }
  if (one.value > one.high) {
    return with_unit(one.value, unit) + " is above the limit of " + with_unit(one.high, unit);
  }
  return {};
}

tl::unexpected<Error> wrong(const std::string& file_name, const std::string& what) {
  return fail(Fault::usage, "limit file '" + file_name + "': " + one_line(what));
}

// Of an entry of `kaz bench list --json`, besides the limits.
constexpr const char* kListKeys[] = {"name", "group", "unit", "text"};

// Error: what is wrong with this entry, for wrong(). `listed`: it is one of a list.
tl::expected<std::pair<double, double>, std::string> parse_entry(const std::string& name,
                                                                 const Json& entry, bool listed) {
  if (!find_measurement(name)) {
    return tl::unexpected("there is no measurement '" + name +
                          "'; docs/howto/bench.md lists the measurements");
  }
  if (!entry.is_object()) {
    return tl::unexpected("'" + name + R"(' must have the form {"low": number, "high": number})");
  }
  std::pair<double, double> limits(-kInfinite, kInfinite);
  for (const auto& [key, value] : entry.items()) {
    if (listed && std::ranges::find(kListKeys, key) != std::end(kListKeys)) continue;
    if (key != "low" && key != "high") {
      return tl::unexpected("'" + name + "' has an unknown key '" + key + "'; use 'low' or 'high'");
    }
    if (value.is_null()) continue;
    if (!value.is_number()) {
      return tl::unexpected("'" + key + "' of '" + name + "' must be a number or null");
    }
    (key == "low" ? limits.first : limits.second) = value.get<double>();
  }
  if (limits.first > limits.second)
    return tl::unexpected("'low' of '" + name + "' is above its 'high'");
  return limits;
}

}  // namespace

const char* text(BenchGroup group) {
  switch (group) {
    case BenchGroup::motor:
      return "motor";
    case BenchGroup::link:
      return "link";
    default:
      return "tick";
  }
}

const std::vector<MeasurementInfo>& measurement_infos() {
  static const std::vector<MeasurementInfo> infos = read_table();
  return infos;
}

const MeasurementInfo* find_measurement(const std::string& name) {
  const auto& all = measurement_infos();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const MeasurementInfo& info) { return info.name == name; });
  return found == all.end() ? nullptr : &*found;
}

Result<Limits> parse_limits(const std::string& json, const std::string& file_name) {
  const auto read = parse_bounded_json(json);
  if (!read) return wrong(file_name, read.error().message);
  const Json& all = *read;
  const bool listed = all.is_array();
  if (!all.is_object() && !listed) {
    return wrong(file_name,
                 "it must be an object with names of measurements as keys, or a list from `kaz "
                 "bench list --json`");
  }
  if (all.empty())
    return wrong(file_name,
                 "it contains no measurement; `kaz bench list --json` prints all of them");
  Limits limits;
  for (const auto& [key, entry] : all.items()) {
    std::string name = key;
    if (listed) {
      if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
        return wrong(file_name, "entry " + key + " of the list has no \"name\"");
      name = entry["name"].get<std::string>();
    }
    const auto parsed = parse_entry(name, entry, listed);
    if (!parsed) return wrong(file_name, parsed.error());
    if (!limits.emplace(name, *parsed).second)
      return wrong(file_name, "'" + name + "' occurs twice; remove one");
  }
  return limits;
}

int BenchReport::count(Verdict verdict) const {
  return static_cast<int>(
      std::count_if(measurements.begin(), measurements.end(),
                    [&](const Measurement& one) { return one.verdict == verdict; }));
}

bool BenchReport::doubts(Measurement::Doubt doubt) const {
  return std::ranges::any_of(measurements, [doubt](const Measurement& one) {
    return one.verdict == Verdict::undecided && one.doubt == doubt;
  });
}

Measurement BenchJudge::begin(const std::string& subject, const std::string& name) const {
  Measurement measurement;
  measurement.of = find_measurement(name);
  if (!measurement.of) throw std::logic_error("no measurement '" + name + "' in measurements.def");
  measurement.subject = subject;
  measurement.low = measurement.of->low;
  measurement.high = measurement.of->high;
  if (const auto other = limits_.find(name); other != limits_.end()) {
    std::tie(measurement.low, measurement.high) = other->second;
  }
  return measurement;
}

std::pair<double, double> BenchJudge::limits(const std::string& name) const {
  const Measurement measurement = begin("", name);
  return {measurement.low, measurement.high};
}

void BenchJudge::finish(Measurement measurement) {
  report_.measurements.push_back(std::move(measurement));
  if (listener_ && !in_part_) listener_(report_.measurements.back());
}

void BenchJudge::leave_undecided(std::size_t first, const std::string& why,
                                 Measurement::Doubt doubt) {
  const bool disturbed = doubt == Measurement::Doubt::line;
  for (std::size_t i = first; i < report_.measurements.size(); ++i) {
    Measurement& one = report_.measurements[i];
    if (one.verdict != Verdict::failed || (disturbed && !depends_on_line(one))) continue;
    one.verdict = Verdict::undecided;
    one.doubt = doubt;
    one.message += "; but " + why;
  }
}

void BenchJudge::doubt(std::size_t first, double factor, const std::string& why) {
  for (std::size_t i = first; i < report_.measurements.size(); ++i) {
    Measurement& one = report_.measurements[i];
    const double most = one.value * factor;
    const bool may_pass = one.value < one.low && most >= one.low;
    const bool may_fail = one.verdict == Verdict::passed && most > one.high;
    if (!may_pass && !may_fail) continue;
    one.verdict = Verdict::undecided;
    one.doubt = Measurement::Doubt::motor;
    one.message += (one.message.empty() ? "the true value may be higher: " : "; but ") + why;
  }
}

Result<void> BenchJudge::timed(const std::function<Result<void>()>& part, Time at_least,
                               const LineTrouble& line_trouble) {
  const auto first = static_cast<std::ptrdiff_t>(report_.measurements.size());
  const auto plots = static_cast<std::ptrdiff_t>(report_.plots.size());
  std::vector<Measurement>& all = report_.measurements;
  in_part_ = true;
  Result<void> ran;
  for (int run = 1;; ++run) {
    if (lateness_) lateness_->begin();
    if (line_trouble) (void)line_trouble();
    ran = part();
    if (!ran) break;
    const auto in_doubt = [at_least](const Measurement& one) {
      return one.verdict == Verdict::failed &&
             (at_least > Time::zero() || depends_on_lateness(*one.of));
    };
    const auto by_line = [](const Measurement& one) {
      return one.verdict == Verdict::failed && depends_on_line(one);
    };
    std::string excuse, trouble;
    if (lateness_ && std::any_of(all.begin() + first, all.end(), in_doubt))
      excuse = lateness_->excuse(at_least);
    // Of a late program replies are missing, too.
    if (excuse.empty() && line_trouble && std::any_of(all.begin() + first, all.end(), by_line))
      trouble = line_trouble();
    if (excuse.empty() && trouble.empty()) break;
    if (!excuse.empty() && lateness_->other_end_gone()) {
      all.erase(std::remove_if(all.begin() + first, all.end(), in_doubt), all.end());
      ran = fail(Fault::environment, excuse);
      break;
    }
    if (run <= host::LatenessMeter::kRepetitions) {
      all.erase(all.begin() + first, all.end());
      report_.plots.erase(report_.plots.begin() + plots, report_.plots.end());
      continue;
    }
    if (!trouble.empty()) {
      leave_undecided(static_cast<std::size_t>(first),
                      trouble + " (the line was disturbed in all " + std::to_string(run) + " runs)",
                      Measurement::Doubt::line);
      break;
    }
    for (auto one = all.begin() + first; one != all.end(); ++one) {
      if (!in_doubt(*one)) continue;
      one->verdict = Verdict::undecided;
      one->doubt = Measurement::Doubt::machine;
      one->message += "; but " + excuse + " (late in all " + std::to_string(run) + " runs)";
    }
    break;
  }
  in_part_ = false;
  if (listener_) std::for_each(all.begin() + first, all.end(), listener_);
  return ran;
}

void BenchJudge::enter(const std::string& subject, const std::string& name, double value,
                       double error, const std::string& note) {
  Measurement measurement = begin(subject, name);
  measurement.value = value;
  measurement.error = error;
  measurement.message = what_is_wrong(measurement);
  measurement.verdict = measurement.message.empty() ? Verdict::passed : Verdict::failed;
  if (!note.empty()) measurement.message += (measurement.message.empty() ? "" : "; ") + note;
  finish(std::move(measurement));
}

void BenchJudge::enter_finding(const std::string& subject, const std::string& name, double value,
                               const std::string& finding) {
  Measurement measurement = begin(subject, name);
  measurement.value = value;
  measurement.message = finding;
  measurement.verdict = Verdict::failed;
  finish(std::move(measurement));
}

void BenchJudge::enter_without_default_limits(const std::string& subject, const std::string& name,
                                              double value, double error, const std::string& note) {
  if (limits_.contains(name)) return enter(subject, name, value, error, note);
  Measurement measurement = begin(subject, name);
  measurement.value = value;
  measurement.error = error;
  measurement.message = note;
  finish(std::move(measurement));
}

void BenchJudge::leave_out(const std::string& subject, const std::string& name,
                           const std::string& why) {
  Measurement measurement = begin(subject, name);
  measurement.value = std::numeric_limits<double>::quiet_NaN();
  measurement.message = why;
  finish(std::move(measurement));
}

}  // namespace kaz::hil
