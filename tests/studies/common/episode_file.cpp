// Reads and appends episodes, one JSON object a line.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/common/episode_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

namespace kaz::studies {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const EpisodeKey& key, const std::string& motors, const Episode& episode) {
  Json line{{"row", key.row}, {"variant", key.variant}, {"seed", key.seed}, {"motors", motors}};
  if (!episode.error.empty()) {
    line["error"] = episode.error;
    return line;
  }
  const Outcome& out = episode.outcome;
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
  // Rounded to 0.1 mm, which is enough for plots.
  Json& path = line["path_tenth_mm"] = Json::array();
  for (const auto& [x, y] : out.path) path.push_back({std::lround(10 * x), std::lround(10 * y)});
  if (!out.reported.empty()) line["reported"] = out.reported;
  return line;
}

Episode from_json(const Json& line) {
  Episode episode;
  if (line.contains("error")) {
    episode.error = line.at("error");
    return episode;
  }
  Outcome& out = episode.outcome;
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
  if (line.contains("reported")) line.at("reported").get_to(out.reported);
  return episode;
}

}  // namespace

Result<EpisodeFile> EpisodeFile::open(const std::string& path, const std::string& motors) {
  EpisodeFile file;
  file.path_ = path;
  file.motors_ = motors;
  std::ifstream in(path, std::ios::binary);
  if (!in) return file;
  std::string text;
  std::uintmax_t good = 0;
  for (int number = 1; std::getline(in, text); ++number) {
    if (in.eof()) {  // no newline: the program was interrupted while writing
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
        return fail(Fault::usage, where + ": was run with motors `" +
                                      line.at("motors").get<std::string>() +
                                      "`; name another file for `" + motors + "`");
      }
      file.episodes_[{line.at("row"), line.at("variant"), line.at("seed")}] = from_json(line);
    } catch (const Json::exception& problem) {
      return fail(Fault::usage,
                  where + ": is not an episode (" + problem.what() + "); name another file");
    }
  }
  return file;
}

Result<void> EpisodeFile::add(const EpisodeKey& key, const Episode& episode) {
  episodes_[key] = episode;
  std::ofstream out(path_, std::ios::app | std::ios::binary);
  out << to_json(key, motors_, episode).dump() << '\n';
  out.close();
  if (!out) return fail(Fault::environment, path_ + ": cannot be written; is the disk full?");
  return {};
}

std::vector<Outcome> EpisodeFile::outcomes(const std::string& row,
                                           const std::string& variant) const {
  std::vector<Outcome> found;
  for (const auto& [key, episode] : episodes_) {
    if (key.row == row && key.variant == variant && episode.error.empty())
      found.push_back(episode.outcome);
  }
  return found;
}

int EpisodeFile::errors(const std::string& row, const std::string& variant) const {
  int count = 0;
  for (const auto& [key, episode] : episodes_)
    count += key.row == row && key.variant == variant && !episode.error.empty();
  return count;
}

std::size_t EpisodeFile::seeds() const {
  std::set<std::uint64_t> seeds;
  for (const auto& [key, episode] : episodes_) seeds.insert(key.seed);
  return seeds.size();
}

}  // namespace kaz::studies
