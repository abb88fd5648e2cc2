// Reads and writes a servo's log.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "hil/servo/bam_log.h"
#include "shared/base/number_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::hil {
namespace {

constexpr double kGravity = 9.80665;  // m/s2
constexpr std::size_t kMostSamples = 200'000;
constexpr double kShortest = 1, kLongest = 600, kLongestStep = 0.5;  // s

struct Setting {
  const char* name;
  double ServoLog::*at;
  double low, high;
  bool needed;
};
constexpr std::array kSettings{
    Setting{"mass_kg", &ServoLog::mass_kg, 0, 100, true},
    Setting{"length_m", &ServoLog::length_m, 0, 10, true},
    Setting{"arm_kg", &ServoLog::arm_kg, 0, 100, false},
    Setting{"gain_per_rad", &ServoLog::gain_per_rad, 1e-6, 1e4, true},
    Setting{"most_duty", &ServoLog::most_duty, 0.01, 1, false},
    Setting{"inertia_kgm2", &ServoLog::inertia_kgm2, 1e-9, 1000, false},
    Setting{"gravity_nm", &ServoLog::weight_nm, 0, 1000, false},
};

struct Column {
  const char* name;
  double ServoSample::*at;
  double most;
  bool needed;
};
constexpr std::array kColumns{
    Column{"time_s", &ServoSample::time_s, 1e9, true},
    Column{"goal_rad", &ServoSample::goal_rad, 1000, true},
    Column{"position_rad", &ServoSample::position_rad, 1000, true},
    Column{"volts", &ServoSample::volts, 100, true},
    Column{"current_a", &ServoSample::current_a, 1000, false},
};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> parts(1);
  for (const char c : line) {
    if (c == ',')
      parts.emplace_back();
    else if (c != ' ' && c != '\r' && c != '\t')
      parts.back() += c;
  }
  return parts;
}

class Reader {
 public:
  explicit Reader(std::string name) { log_.name = std::move(name); }

  // `where` is the place of the line in the file, such as "line 7".
  Result<void> take(const std::string& line, std::string where) {
    where_ = std::move(where);
    if (line.find_first_not_of(" \r\t") == std::string::npos) return {};
    if (line.starts_with('#')) return setting(line);
    if (columns_.empty()) return header(line);
    return sample(line);
  }

  Result<ServoLog> end() {
    for (std::size_t i = 0; i < kSettings.size(); ++i) {
      if (kSettings[i].needed && !set_[i])
        return fail(Fault::usage,
                    log_.name + ": the line `# " + kSettings[i].name + " VALUE` is missing");
    }
    if (log_.load_kgm2() <= 0)
      return fail(Fault::usage,
                  log_.name + ": length_m must be above 0, and mass_kg or arm_kg must be above 0");
    if (log_.samples.size() < 2 ||
        log_.samples.back().time_s - log_.samples.front().time_s < kShortest)
      return wrong("the samples must cover at least 1 s");
    return std::move(log_);
  }

 private:
  tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(Fault::usage, log_.name + ": " + where_ + ": " + what);
  }

  Result<void> setting(const std::string& line) {
    std::istringstream words(line.substr(1));
    std::string name, value;
    words >> name >> value;
    if (name == "motion") log_.motion = cut_text(one_line(value));
    for (std::size_t i = 0; i < kSettings.size(); ++i) {
      const Setting& one = kSettings[i];
      if (name != one.name) continue;
      const auto number = parse_number<double>(value);
      if (!number || !(*number >= one.low && *number <= one.high)) {
        char bounds[80];
        std::snprintf(bounds, sizeof bounds, "must be %g to %g", one.low, one.high);
        return wrong(name + " is '" + cut_text(one_line(value)) + "': " + bounds);
      }
      if (set_[i]) return wrong(name + " occurs twice; remove one");
      set_[i] = true;
      log_.*one.at = *number;
    }
    return {};  // others are comments
  }

  Result<void> header(const std::string& line) {
    columns_ = split(line);
    for (const Column& one : kColumns) {
      std::size_t times = 0;
      for (const std::string& name : columns_) times += static_cast<std::size_t>(name == one.name);
      if (times > 1)
        return wrong(std::string("the column ") + one.name + " occurs twice; remove one");
      if (one.needed && times == 0)
        return wrong(std::string("the column ") + one.name +
                     " is missing; the first line without # must name it");
      log_.has_current = log_.has_current || (times == 1 && one.at == &ServoSample::current_a);
    }
    return {};
  }

  Result<void> sample(const std::string& line) {
    const std::vector<std::string> fields = split(line);
    if (fields.size() != columns_.size())
      return wrong(std::to_string(fields.size()) + " fields: must be " +
                   std::to_string(columns_.size()) + ", one for each column");
    ServoSample now;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (columns_[i] == "torque_on") {
        if (fields[i] != "0" && fields[i] != "1") return wrong("torque_on must be 0 or 1");
        now.torque_on = fields[i] == "1";
      }
      for (const Column& one : kColumns) {
        if (columns_[i] != one.name) continue;
        const auto number = parse_number<double>(fields[i]);
        if (!number || !(std::abs(*number) <= one.most)) {
          char bounds[80];
          std::snprintf(bounds, sizeof bounds, "must be %g to %g", -one.most, one.most);
          return wrong(columns_[i] + " is '" + cut_text(one_line(fields[i])) + "': " + bounds);
        }
        now.*one.at = *number;
      }
    }
    if (!log_.samples.empty()) {
      const double step = now.time_s - log_.samples.back().time_s;
      if (!(step > 0)) return wrong("time_s must be greater than in the previous sample");
      if (step > kLongestStep)
        return wrong("time_s must be at most 0.5 s after the previous sample");
      if (now.time_s - log_.samples.front().time_s > kLongest)
        return wrong("time_s must be at most 600 s after the first sample");
    }
    if (log_.samples.size() >= kMostSamples)
      return wrong("more than 200,000 samples, the maximum; shorten the log");
    log_.samples.push_back(now);
    return {};
  }

  ServoLog log_;
  std::string where_ = "line 0";
  std::array<bool, kSettings.size()> set_{};
  std::vector<std::string> columns_;
};

Result<void> read_csv(Reader& reader, const std::string& text) {
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);)
    KAZ_TRY(reader.take(line, "line " + std::to_string(++number)));
  return {};
}

Result<void> read_bam(Reader& reader, const std::string& text, const std::string& name) {
  const auto lines = bam_lines(text);
  if (!lines) return fail(lines.error().fault, name + ": " + lines.error().message);
  for (const std::string& line : lines->head) KAZ_TRY(reader.take(line, "head"));
  for (std::size_t i = 0; i < lines->entries.size(); ++i)
    KAZ_TRY(reader.take(lines->entries[i], "entry " + std::to_string(i + 1)));
  return {};
}

// Words of the file's name without digits, such as "sin_sin" of kp04_m0.535_sin_sin_183326.csv. "fit" and
// "held" are the prefixes of kaz bench pendulum.
std::string motion_of(const std::string& name) {
  std::string file = name.substr(name.find_last_of('/') + 1), motion, word;
  file = file.substr(0, file.find_last_of('.')) + "_";
  for (const char c : file) {
    if (c != '_' && c != '-') {
      word += c;
      continue;
    }
    const bool digits = std::ranges::any_of(word, [](char d) { return d >= '0' && d <= '9'; });
    if (!word.empty() && !digits && word != "fit" && word != "held")
      motion += (motion.empty() ? "" : "_") + word;
    word.clear();
  }
  return motion.empty() ? "motion" : cut_text(one_line(motion));
}

// A loose supply wire or a damaged reply shows as 0 V or 25 V at a supply of 12 V. Load moves it by less.
void repair_volts(ServoLog& log) {
  constexpr double kFarShare = 0.25;
  std::vector<double> volts;
  for (const ServoSample& one : log.samples) volts.push_back(one.volts);
  const auto middle = volts.begin() + static_cast<std::ptrdiff_t>(volts.size() / 2);
  std::ranges::nth_element(volts, middle);
  for (ServoSample& one : log.samples) {
    if (std::abs(one.volts - *middle) <= kFarShare * std::abs(*middle)) continue;
    one.volts = *middle;
    ++log.repaired_volts;
  }
}

// One reading far from both neighbors is impossible: the arm cannot move there and back in two samples.
void repair_positions(ServoLog& log) {
  constexpr double kJump = 0.5, kSoon = 0.05;  // rad, s
  std::vector<ServoSample>& samples = log.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.size() < 3) return;
    const ServoSample& before = samples[i > 0 ? i - 1 : 1];
    const ServoSample& after = samples[i + 1 < samples.size() ? i + 1 : i - 1];
    if (std::abs(after.time_s - before.time_s) > 2 * kSoon) continue;
    const double most = kJump + 2 * std::abs(after.position_rad - before.position_rad);
    if (std::abs(samples[i].position_rad - before.position_rad) < most ||
        std::abs(samples[i].position_rad - after.position_rad) < most)
      continue;
    samples[i].position_rad = 0.5 * (before.position_rad + after.position_rad);
    ++log.repaired_positions;
  }
}

// A current that is never negative although the servo pushes against a negative error has no sign.
bool has_unsigned_current(const ServoLog& log) {
  constexpr double kError = 0.01, kShare = 0.05;  // rad
  const auto pushes_back = std::ranges::count_if(log.samples, [](const ServoSample& one) {
    return one.torque_on && one.goal_rad - one.position_rad < -kError && one.current_a > 0;
  });
  return static_cast<double>(pushes_back) > kShare * static_cast<double>(log.samples.size());
}

}  // namespace

double ServoLog::load_kgm2() const {
  return inertia_kgm2 > 0 ? inertia_kgm2 : (mass_kg + arm_kg / 3) * length_m * length_m;
}

double ServoLog::gravity_nm() const {
  return weight_nm > 0 ? weight_nm : (mass_kg + arm_kg / 2) * kGravity * length_m;
}

std::string ServoLog::rig() const {
  char text[60];
  std::snprintf(text, sizeof text, "%.4g kg, %.4g m", mass_kg, length_m);
  return text;
}

Result<ServoLog> parse_servo_log(const std::string& text, const std::string& name) {
  Reader reader(name);
  if (text.starts_with('{'))
    KAZ_TRY(read_bam(reader, text, name));
  else
    KAZ_TRY(read_csv(reader, text));
  ServoLog log = KAZ_TRY(reader.end());
  if (log.motion.empty()) log.motion = motion_of(name);
  repair_volts(log);
  repair_positions(log);
  return log;
}

void drop_unsigned_currents(std::vector<ServoLog>& logs) {
  const auto positive = [](const ServoLog& log) {
    return log.has_current && std::ranges::none_of(log.samples, [](const ServoSample& one) {
             return one.current_a < 0;
           });
  };
  if (std::ranges::none_of(
          logs, [&](const ServoLog& log) { return positive(log) && has_unsigned_current(log); }))
    return;
  for (ServoLog& log : logs) {
    log.unsigned_current = positive(log);
    log.has_current = log.has_current && !log.unsigned_current;
  }
}

std::string servo_log_text(const ServoLog& log) {
  std::string text;
  char line[200];
  for (const Setting& one : kSettings) {
    if (log.*one.at == 0 && !one.needed) continue;
    std::snprintf(line, sizeof line, "# %s %.9g\n", one.name, log.*one.at);
    text += line;
  }
  text += "# motion " + log.motion + "\n";
  text += "time_s,goal_rad,position_rad,volts,current_a,torque_on\n";
  for (const ServoSample& one : log.samples) {
    std::snprintf(line, sizeof line, "%.6f,%.7g,%.7g,%.6g,%.6g,%d\n", one.time_s, one.goal_rad,
                  one.position_rad, one.volts, one.current_a, static_cast<int>(one.torque_on));
    text += line;
  }
  return text;
}

}  // namespace kaz::hil
