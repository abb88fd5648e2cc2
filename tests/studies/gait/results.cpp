// Outcomes of episodes in a file of JSON lines.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/gait/results.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

namespace kaz::gait {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Key& key, const std::string& motors, const Entry& entry) {
  Json line{{"task", key.task}, {"stepper", key.stepper}, {"seed", key.seed}, {"motors", motors}};
  if (!entry.error.empty()) {
    line["error"] = entry.error;
    return line;
  }
  const Outcome& out = entry.outcome;
  line["fell"] = out.fell;
  line["seconds"] = out.seconds;
  line["forward_m"] = out.forward_m;
  line["aside_m"] = out.aside_m;
  line["heading_deg"] = out.heading_deg;
  line["tilt_deg"] = out.tilt_deg;
  line["hottest_celsius"] = out.hottest_celsius;
  line["per_cycle_deg"] = out.per_cycle_deg;
  line["caught"] = out.caught;
  line["grasp_mm"] = out.grasp_mm;
  // To the tenth of a millimetre: for pictures.
  Json& path = line["path_tenth_mm"] = Json::array();
  for (const auto& [x, y] : out.path) path.push_back({std::lround(10 * x), std::lround(10 * y)});
  if (!out.figures.empty()) line["figures"] = out.figures;
  return line;
}

Entry from_json(const Json& line) {
  Entry entry;
  if (line.contains("error")) {
    entry.error = line.at("error");
    return entry;
  }
  Outcome& out = entry.outcome;
  line.at("fell").get_to(out.fell);
  line.at("seconds").get_to(out.seconds);
  line.at("forward_m").get_to(out.forward_m);
  line.at("aside_m").get_to(out.aside_m);
  line.at("heading_deg").get_to(out.heading_deg);
  line.at("tilt_deg").get_to(out.tilt_deg);
  line.at("hottest_celsius").get_to(out.hottest_celsius);
  line.at("per_cycle_deg").get_to(out.per_cycle_deg);
  line.at("caught").get_to(out.caught);
  line.at("grasp_mm").get_to(out.grasp_mm);
  for (const Json& at : line.at("path_tenth_mm"))
    out.path.push_back({at.at(0).get<double>() / 10, at.at(1).get<double>() / 10});
  if (line.contains("figures")) line.at("figures").get_to(out.figures);
  return entry;
}

}  // namespace

Result<Results> Results::open(const std::string& path, const std::string& motors) {
  Results results;
  results.path_ = path;
  results.motors_ = motors;
  std::ifstream in(path, std::ios::binary);
  if (!in) return results;
  std::string text;
  std::uintmax_t good = 0;
  for (int number = 1; std::getline(in, text); ++number) {
    if (in.eof()) {  // without its end: the program was interrupted while it wrote
      in.close();
      std::error_code wrong;
      std::filesystem::resize_file(path, good, wrong);
      if (wrong) return fail(Fault::environment, path + ": cannot be written: " + wrong.message());
      break;
    }
    good += text.size() + 1;
    const std::string where = path + ", line " + std::to_string(number);
    try {
      const Json line = Json::parse(text);
      if (line.at("motors") != motors) {
        return fail(Fault::usage, where + ": is of motors `" +
                                      line.at("motors").get<std::string>() +
                                      "`; name another file for `" + motors + "`");
      }
      results.entries_[{line.at("task"), line.at("stepper"), line.at("seed")}] = from_json(line);
    } catch (const Json::exception& problem) {
      return fail(Fault::usage, where + ": is no outcome of an episode (" + problem.what() +
                                    "); name another file");
    }
  }
  return results;
}

Result<void> Results::add(const Key& key, const Entry& entry) {
  entries_[key] = entry;
  std::ofstream out(path_, std::ios::app | std::ios::binary);
  out << to_json(key, motors_, entry).dump() << '\n';
  out.close();
  if (!out) return fail(Fault::environment, path_ + ": cannot be written; is the disk full?");
  return {};
}

std::vector<Outcome> Results::of(const std::string& task, const std::string& stepper) const {
  std::vector<Outcome> found;
  for (const auto& [key, entry] : entries_) {
    if (key.task == task && key.stepper == stepper && entry.error.empty())
      found.push_back(entry.outcome);
  }
  return found;
}

int Results::errors(const std::string& task, const std::string& stepper) const {
  int count = 0;
  for (const auto& [key, entry] : entries_)
    count += key.task == task && key.stepper == stepper && !entry.error.empty();
  return count;
}

}  // namespace kaz::gait
