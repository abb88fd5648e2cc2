// The parts of an evaluation that a merge joins, and what they lack of the whole.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/parts.h"

#include <algorithm>
#include <iterator>
#include <map>

#include <nlohmann/json.hpp>

namespace kaz::tools {
namespace {

using Numbers = std::vector<std::uint64_t>;

std::string episodes_text(const Numbers& numbers) {
  return (numbers.size() == 1 ? "episode " : "episodes ") + numbers_text(numbers);
}

// Into how many parts the whole is cut; 0 if none states it, or they differ.
std::uint64_t common_shards(const std::vector<Part>& parts) {
  std::uint64_t shards = 0;
  for (const Part& part : parts) {
    if (!part.planned) continue;
    if (shards != 0 && part.planned->shards != shards) return 0;
    shards = part.planned->shards;
  }
  return shards;
}

// Whether an episode that no part holds is one that this part has not run. One without a plan has its
// place from the episodes that it holds.
bool should_hold(const Part& part, std::uint64_t number, std::uint64_t shards) {
  if (part.planned)
    return number < part.planned->episodes &&
           number % part.planned->shards == part.planned->shard - 1;
  if (part.has_result && !part.interrupted) return false;
  return part.episodes.empty() || shards == 0 || *part.episodes.begin() % shards == number % shards;
}

std::string why_it_lacks(const Part& part) {
  if (!part.has_result)
    return "' has no result.json (its evaluation was aborted or is still running)";
  if (!part.interrupted) return "' is incomplete";
  return "' was interrupted" + (part.signal.empty() ? std::string() : " by " + part.signal);
}

// A folder that has not run all that it should have; empty where it has.
std::string folder_reason(const Part& part, const Numbers& lacks) {
  const bool unknown = part.interrupted && !part.planned;
  if (lacks.empty() && !unknown) return {};
  return "'" + part.folder + why_it_lacks(part) +
         (lacks.empty() ? " and does not state its number of episodes"
                        : " and lacks " + episodes_text(lacks)) +
         ": run the command of this folder again";
}

// Episodes of no folder at all, by the part that would have them.
std::string absent_reasons(const Numbers& numbers, std::uint64_t shards) {
  if (shards < 2) return "no folder contains " + episodes_text(numbers) + ": run these episodes";
  std::map<std::uint64_t, Numbers> by_part;
  for (const std::uint64_t number : numbers) by_part[number % shards + 1].push_back(number);
  std::string text;
  for (const auto& [part, its] : by_part) {
    const std::string name = std::to_string(part) + "/" + std::to_string(shards);
    text += (text.empty() ? "" : "; ") + std::string("no folder contains part ") + name + " (" +
            episodes_text(its) +
            "): give the folder of this part too, or run the part with --shard " + name;
  }
  return text;
}

LostEpisodes lost_of(const std::vector<Part>& parts, const std::set<std::uint64_t>& held) {
  LostEpisodes lost;
  for (const Part& part : parts)
    for (const auto& [number, why] : part.lost)
      if (!held.contains(number)) lost.emplace(number, why);
  return lost;
}

}  // namespace

std::string numbers_text(const Numbers& numbers) {
  constexpr std::size_t kMaxNamed = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(numbers.size(), kMaxNamed); ++i)
    text += (i > 0 ? ", " : "") + std::to_string(numbers[i]);
  return numbers.size() > kMaxNamed ? text + ", ..." : text;
}

Part part_of(const std::string& folder, const Episodes& episodes,
             const nlohmann::ordered_json& result) {
  Part part;
  part.folder = folder;
  for (const auto& [number, episode] : episodes) part.episodes.insert(number);
  part.has_result = !result.is_null();
  if (!part.has_result) return part;
  part.interrupted = result.value("interrupted", false);
  part.signal = result.value("signal", std::string());
  if (result.contains("planned"))
    part.planned = Planned{result["planned"]["episodes"].get<std::uint64_t>(),
                           result["planned"]["shard"].get<std::uint64_t>(),
                           result["planned"]["shards"].get<std::uint64_t>()};
  if (!result.contains("environment")) return part;
  for (const auto& one : result["environment"])
    part.lost[one["episode"].get<std::uint64_t>()] = one["sentence"].get<std::string>();
  return part;
}

Result<void> check_one_plan(const std::vector<Part>& parts) {
  const Part* few = nullptr;
  const Part* many = nullptr;
  for (const Part& part : parts) {
    if (!part.planned) continue;
    if (few == nullptr || part.planned->episodes < few->planned->episodes) few = &part;
    if (many == nullptr || part.planned->episodes > many->planned->episodes) many = &part;
  }
  if (few == nullptr || few->planned->episodes == many->planned->episodes) return {};
  const std::string episodes = "--episodes " + std::to_string(many->planned->episodes);
  return fail(Fault::usage, "'" + few->folder + "' was made with --episodes " +
                                std::to_string(few->planned->episodes) + " and '" + many->folder +
                                "' with " + episodes +
                                ": parts may only differ in --shard; run the command of '" +
                                few->folder + "' again with " + episodes +
                                "; this command runs only missing episodes");
}

Shortage find_shortage(const std::vector<Part>& parts) {
  Shortage found;
  std::uint64_t& total = found.extent.planned.episodes;
  std::set<std::uint64_t> held;
  for (const Part& part : parts) {
    held.insert(part.episodes.begin(), part.episodes.end());
    if (part.planned) total = std::max(total, part.planned->episodes);
  }
  // A number beyond what can be planned is of a damaged file, and no end of a list.
  constexpr std::uint64_t kMaxEpisodes = 1'000'000;
  if (!held.empty() && *held.rbegin() < kMaxEpisodes) total = std::max(total, *held.rbegin() + 1);
  found.lost = lost_of(parts, held);
  Numbers& missing = found.extent.missing;
  for (std::uint64_t n = 0; n < total; ++n)
    if (!held.contains(n) && !found.lost.contains(n)) missing.push_back(n);

  const std::uint64_t shards = common_shards(parts);
  Numbers absent = missing;
  std::string reasons;
  const auto add = [&reasons](const std::string& reason) {
    if (!reason.empty()) reasons += (reasons.empty() ? "" : "; ") + reason;
  };
  for (const Part& part : parts) {
    const auto lacks = [&](std::uint64_t n) { return should_hold(part, n, shards); };
    Numbers its;
    std::ranges::copy_if(missing, std::back_inserter(its), lacks);
    std::erase_if(absent, lacks);
    const std::string reason = folder_reason(part, its);
    if (!reason.empty() && found.extent.signal.empty()) found.extent.signal = part.signal;
    add(reason);
  }
  if (!absent.empty()) add(absent_reasons(absent, shards));
  found.extent.interrupted = !reasons.empty();
  if (!found.lost.empty()) {
    Numbers numbers;
    for (const auto& [number, why] : found.lost) numbers.push_back(number);
    add(episodes_text(numbers) + " lost to machine errors: run the command of the part again");
  }
  if (reasons.empty()) return found;
  const std::size_t count = missing.size() + found.lost.size();
  found.sentence = (count > 0 ? std::to_string(count) + " of " + std::to_string(total) + " " : "") +
                   "episodes are missing, and the rates exclude these episodes: " + reasons +
                   "; then merge again";
  return found;
}

}  // namespace kaz::tools
