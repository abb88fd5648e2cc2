// Reads and writes tosses.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/toss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "shared/base/files.hpp"
#include "shared/base/number_text.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::contact {
namespace {

constexpr std::size_t kColumns = 13, kFewestSamples = 10, kMostSamples = 10'000;
constexpr std::size_t kFewestFiles = 8, kMostFiles = 10'000;
constexpr std::size_t kMostBytes = 4u << 20;
// Largest magnitudes: position (half edges), quaternion, velocity (half edges/s), angular velocity (rad/s).
constexpr std::array<double, kColumns> kLargest{1e3, 1e3, 1e3, 1.01, 1.01, 1.01, 1.01,
                                                1e4, 1e4, 1e4, 500,  500,  500};
constexpr double kUnitTolerance = 1e-3;

// A line's numbers.
using TossRow = std::array<double, kColumns>;

Result<TossRow> parse_row(std::string_view line, const std::string& where) {
  TossRow row{};
  const auto columns = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
  if (columns != kColumns)
    return fail(Fault::usage, where + ": has " + std::to_string(columns) +
                                  " columns; must have 13: position, quaternion, velocity, "
                                  "angular velocity");
  for (std::size_t i = 0; i < kColumns; ++i) {
    const std::size_t end = std::min(line.find(','), line.size());
    const auto number = parse_number<double>(line.substr(0, end));
    if (!number || std::abs(*number) > kLargest[i]) {
      char bound[64];
      std::snprintf(bound, sizeof bound, "must be a number from %g to %g", -kLargest[i],
                    kLargest[i]);
      return fail(Fault::usage, where + ": column " + std::to_string(i + 1) + " is '" +
                                    cut_text(one_line(std::string(line.substr(0, end)))) +
                                    "': " + bound);
    }
    row[i] = *number;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return row;
}

Result<void> add_sample(const TossRow& row, const std::string& where, Toss& toss) {
  const Eigen::Quaterniond turn(row[3], row[4], row[5], row[6]);
  if (!(std::abs(turn.norm() - 1) <= kUnitTolerance))
    return fail(Fault::usage, where + ": the quaternion in columns 4 to 7 has the length " +
                                  std::to_string(turn.norm()) + "; must be 1 within 0.001");
  const Pose pose{kHalf * Eigen::Vector3d(row[0], row[1], row[2]), turn.normalized()};
  toss.path.push_back(pose);
  toss.velocity.push_back(kHalf * Eigen::Vector3d(row[7], row[8], row[9]));
  toss.spin.push_back(pose.turn * Eigen::Vector3d(row[10], row[11], row[12]));
  return {};
}

}  // namespace

Result<Toss> read_toss(const std::string& path) {
  Toss toss;
  const auto number = parse_number<int>(std::filesystem::path(path).stem().string());
  if (!number || *number < 0)
    return fail(Fault::usage, path + ": the name of a toss must be NUMBER.csv; rename the file");
  toss.number = *number;
  const std::string bytes = KAZ_TRY(read_whole_file(path, kMostBytes));
  std::string_view rest = bytes;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::string where = path + ":" + std::to_string(line);
    if (line > kMostSamples)
      return fail(Fault::usage, where + ": a toss has at most 10,000 samples; shorten the file");
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view text = rest.substr(0, end);
    if (text.ends_with('\r')) text.remove_suffix(1);
    const TossRow row = KAZ_TRY(parse_row(text, where));
    KAZ_TRY(add_sample(row, where, toss));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (toss.path.size() < kFewestSamples)
    return fail(Fault::usage, path + ": has " + std::to_string(toss.path.size()) +
                                  " samples; a toss needs at least 10");
  return toss;
}

Result<std::vector<Toss>> read_tosses(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().extension() == ".csv") names.push_back(at->path().string());
    if (names.size() > kMostFiles) break;
  }
  if (error)
    return fail(Fault::usage,
                folder + ": cannot be read (" + error.message() + "); give a folder of tosses");
  if (names.size() < kFewestFiles || names.size() > kMostFiles)
    return fail(Fault::usage, folder + ": has " + std::to_string(names.size()) +
                                  " files NUMBER.csv; must have 8 to 10,000");
  std::vector<Toss> tosses;
  for (const std::string& name : names) tosses.push_back(KAZ_TRY(read_toss(name)));
  std::ranges::sort(tosses, {}, &Toss::number);
  const auto twice = std::ranges::adjacent_find(tosses, {}, &Toss::number);
  if (twice != tosses.end())
    return fail(Fault::usage, folder + ": the toss " + std::to_string(twice->number) +
                                  " occurs twice; remove one file");
  return tosses;
}

Result<void> write_toss(const std::string& folder, const Toss& toss) {
  std::string text;
  for (std::size_t i = 0; i < toss.path.size(); ++i) {
    const Pose& pose = toss.path[i];
    const Eigen::Vector3d at = pose.at / kHalf, v = toss.velocity[i] / kHalf,
                          w = pose.turn.conjugate() * toss.spin[i];
    char line[400];
    std::snprintf(line, sizeof line,
                  "%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", at.x(),
                  at.y(), at.z(), pose.turn.w(), pose.turn.x(), pose.turn.y(), pose.turn.z(), v.x(),
                  v.y(), v.z(), w.x(), w.y(), w.z());
    text += line;
  }
  return write_whole_file(folder + "/" + std::to_string(toss.number) + ".csv", text);
}

void correct_velocities(std::vector<Toss>& tosses) {
  for (Toss& toss : tosses)
    for (Eigen::Vector3d& velocity : toss.velocity) velocity.z() -= kGravity / kRate / 2;
}

}  // namespace kaz::contact
