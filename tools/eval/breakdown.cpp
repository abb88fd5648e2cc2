// Groups episodes, and shows the groups.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/breakdown.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"
#include "tools/base/provenance.h"
#include "tools/eval/layout.h"
#include "tools/trials/statistics.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;
using Group = std::vector<const Json*>;

std::optional<double> number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

// Of the walk between start and goal, by truth; not of those to a ball, which ends elsewhere.
std::optional<double> off_goal_m(const Json& episode) {
  const Json& scenario = episode["scenario"];
  const auto goal = scenario.find("goal_m");
  const auto forward = number_of(episode["truth"], "forward_m"),
             aside = number_of(episode["truth"], "aside_m");
  if (goal == scenario.end() || !goal->is_array() || goal->size() != 2 || !(*goal)[0].is_number() ||
      !(*goal)[1].is_number() || !forward || !aside || episode["truth"].contains("held_s"))
    return std::nullopt;
  return std::hypot(*forward - (*goal)[0].get<double>(), *aside - (*goal)[1].get<double>());
}

std::optional<double> over_least(const Json& episode) {
  const auto least = number_of(episode["scenario"], "least_s"),
             moving = number_of(episode["measurements"], "moving_s");
  if (!least || !moving || *least <= 0) return std::nullopt;
  return *moving / *least;
}

void add_spread(Json& to, const char* name, const std::vector<double>& values) {
  if (values.empty()) return;
  to[name] = {{"median", trials::quantile(values, 0.5)}, {"max", trials::quantile(values, 1)}};
}

Json group_json(const Group& group) {
  std::uint64_t successes = 0;
  Json failures = Json::object();
  std::vector<double> off, over;
  for (const Json* episode : group) {
    if (!(*episode)["success"].get<bool>()) {
      failures[(*episode)["cause"].get<std::string>()].push_back((*episode)["episode"]);
      continue;
    }
    ++successes;
    if (const auto value = off_goal_m(*episode)) off.push_back(*value);
    if (const auto value = over_least(*episode)) over.push_back(*value);
  }
  const trials::Interval interval = trials::wilson(successes, group.size());
  Json json{{"episodes", group.size()},
            {"successes", successes},
            {"success_rate", static_cast<double>(successes) / static_cast<double>(group.size())},
            {"interval", {interval.min, interval.max}},
            {"failures", failures}};
  add_spread(json, "off_goal_m", off);
  add_spread(json, "over_least", over);
  return json;
}

// By the name that `name` returns, in the order of `names`, then of appearance.
template <class Name>
Json grouped(const Group& episodes, const std::vector<std::string>& names, const Name& name) {
  std::vector<std::pair<std::string, Group>> groups;
  for (const std::string& known : names) groups.emplace_back(known, Group());
  for (const Json* episode : episodes) {
    const std::string its = name((*episode)["scenario"]);
    auto at = std::ranges::find(groups, its, [](const auto& g) { return g.first; });
    if (at == groups.end()) at = groups.insert(groups.end(), {its, Group()});
    at->second.push_back(episode);
  }
  Json json = Json::object();
  for (const auto& [its, group] : groups)
    if (!group.empty()) json[its] = group_json(group);
  return json;
}

std::string text_of(const Json& scenario, const char* key) {
  const auto found = scenario.find(key);
  return found != scenario.end() && found->is_string() ? found->get<std::string>() : "";
}

Json moving_json(const Group& episodes) {
  std::uint64_t in_the_way = 0, noticed = 0, touched = 0;
  bool any = false;
  for (const Json* episode : episodes) {
    const Json& truth = (*episode)["truth"];
    const auto moving = truth.find("moving");
    if (moving == truth.end() || !moving->is_object()) continue;
    any = true;
    const auto in = moving->find("in_the_way");
    if (in == moving->end() || !in->is_boolean() || !in->get<bool>()) continue;
    ++in_the_way;
    noticed += moving->contains("noticed_s") ? 1 : 0;
    touched += truth.contains("touched") ? 1 : 0;
  }
  if (!any) return Json();
  return {{"in_the_way", in_the_way}, {"noticed", noticed}, {"touched", touched}};
}

// Over all maps of all episodes: how many points of outlines in view they have, and how much floor they have
// as obstacles.
Json map_json(const Group& episodes) {
  const char* const names[] = {"outline_points", "outline_found",          "floor_cells",
                               "floor_wrong",    "outline_points_in_view", "outline_found_in_view"};
  std::int64_t sums[6] = {0, 0, 0, 0, 0, 0};
  for (const Json* episode : episodes) {
    const Json& truth = (*episode)["truth"];
    const auto map = truth.find("map");
    if (map == truth.end() || !map->is_object()) continue;
    for (std::size_t i = 0; i < 6; ++i)
      if (const auto value = number_of(*map, names[i]))
        sums[i] += static_cast<std::int64_t>(*value);
  }
  if (sums[0] == 0 || sums[2] == 0) return Json();
  const auto share = [](std::int64_t part, std::int64_t of) {
    return static_cast<double>(part) / static_cast<double>(of);
  };
  Json json{{"outline_found", share(sums[1], sums[0])}, {"floor_wrong", share(sums[3], sums[2])}};
  // Episodes of earlier versions have none.
  if (sums[4] > 0) json["outline_found_in_view"] = share(sums[5], sums[4]);
  return json;
}

std::string map_text(const Json& map) {
  const auto percent_of = [&](const char* name, int digits) {
    return hil::fixed(100 * map[name].get<double>(), digits) + " %";
  };
  std::string text = "within 1 m of the robot, the maps contain " + percent_of("outline_found", 1) +
                     " of the outlines seen so far";
  if (map.contains("outline_found_in_view"))
    text +=
        ", " + percent_of("outline_found_in_view", 1) + " of the outlines in view in the last 2 s";
  return text + "; " + percent_of("floor_wrong", 2) + " of the floor is marked as obstacles";
}

std::string causes(const Json& failures) {
  std::vector<std::string> parts;
  for (const auto& [cause, numbers] : failures.items())
    parts.push_back(std::to_string(numbers.size()) + " " + cause);
  return hil::joined(parts, ", ");
}

std::string reached(const Json& group) {
  return std::to_string(group["successes"].get<std::uint64_t>()) + " of " +
         std::to_string(group["episodes"].get<std::uint64_t>());
}

// "19, 48": median and largest.
std::string spread(const Json& group, const char* name, double factor, int digits) {
  const auto found = group.find(name);
  if (found == group.end()) return "";
  return hil::fixed(factor * (*found)["median"].get<double>(), digits) + ", " +
         hil::fixed(factor * (*found)["max"].get<double>(), digits);
}

constexpr const char* kGroups[] = {"world", "density", "floor"};

std::string percent(const Json& group) {
  return hil::fixed(100 * group["interval"][0].get<double>(), 0) + " to " +
         hil::fixed(100 * group["interval"][1].get<double>(), 0) + " %";
}

std::string claim_of(const Json& episode) {
  if (!episode.contains("claim")) return "";
  return episode["claim"].get<bool>() ? "success" : "failure";
}

// "claimed but not so: 2, episodes 4, 17"; empty: none.
std::string disagreements(const char* what, const Json& numbers) {
  if (numbers.empty()) return "";
  std::vector<std::string> some;
  for (std::size_t i = 0; i < std::min<std::size_t>(numbers.size(), 12); ++i)
    some.push_back(numbers[i].dump());
  return std::string("; ") + what + " " + std::to_string(numbers.size()) + ", episodes " +
         hil::joined(some, ", ") + (numbers.size() > 12 ? " ..." : "");
}

// What is kept of a failure, if anything is: recording and pictures.
std::string failure_row(const Json& episode) {
  char folder[40];
  std::snprintf(folder, sizeof folder, "failures/%06llu",
                static_cast<unsigned long long>(episode["episode"].get<std::uint64_t>()));
  const Json& scenario = episode["scenario"];
  const auto density = number_of(scenario, "density");
  return "<tr><td><a href=\"" + std::string(folder) + "\">" + episode["episode"].dump() +
         "</a></td>" +
         hil::table_cells({text_of(scenario, "world"), density ? hil::fixed(*density, 2) : "",
                           episode["cause"].get<std::string>(), claim_of(episode),
                           episode["sentence"].get<std::string>()}) +
         "</tr>\n";
}

}  // namespace

Json breakdown_json(const Episodes& episodes) {
  Group walks;
  for (const auto& [number, episode] : episodes)
    if (!text_of(episode["scenario"], "world").empty()) walks.push_back(&episode);
  if (walks.empty()) return Json::object();
  std::vector<std::string> kinds;
  for (const WorldKindInfo& info : world_kinds()) kinds.emplace_back(info.name);
  Json json;
  json["world"] = grouped(walks, kinds, [](const Json& s) { return text_of(s, "world"); });
  json["density"] = grouped(walks, {"sparse", "medium", "dense"}, [](const Json& s) {
    return std::string(density_grade(number_of(s, "density").value_or(0)));
  });
  json["floor"] = grouped(walks, {}, [](const Json& s) { return text_of(s, "floor"); });
  if (const Json moving = moving_json(walks); !moving.is_null()) json["moving"] = moving;
  if (const Json map = map_json(walks); !map.is_null()) json["map"] = map;
  return json;
}

std::string breakdown_text(const Json& breakdown) {
  if (breakdown.empty()) return {};
  std::string text;
  char line[200];
  for (const char* name : kGroups) {
    std::snprintf(line, sizeof line, "  %-16s %-10s %-12s %-14s %-12s failures\n", name, "reached",
                  "95 %", "off goal, mm", "time/least");
    text += line;
    for (const auto& [its, group] : breakdown[name].items()) {
      std::snprintf(line, sizeof line, "  %-16s %-10s %-12s %-14s %-12s %s\n", its.c_str(),
                    reached(group).c_str(), percent(group).c_str(),
                    spread(group, "off_goal_m", 1e3, 0).c_str(),
                    spread(group, "over_least", 1, 1).c_str(), causes(group["failures"]).c_str());
      text += line;
    }
  }
  text +=
      "  off goal: distance to the goal by ground truth; time/least: walking time divided by the "
      "shortest possible time;\n"
      "  both columns: median and maximum of the episodes that reached the goal\n";
  if (const auto moving = breakdown.find("moving"); moving != breakdown.end()) {
    std::snprintf(line, sizeof line,
                  "  moving box in the way: %s, noticed: %s, obstacles touched: %s\n",
                  (*moving)["in_the_way"].dump().c_str(), (*moving)["noticed"].dump().c_str(),
                  (*moving)["touched"].dump().c_str());
    text += line;
  }
  if (const auto map = breakdown.find("map"); map != breakdown.end()) {
    text += "  " + map_text(*map) + "\n";
  }
  return text;
}

std::string claims_text(const Json& claims) {
  return "the behavior reported its success or failure correctly in " + claims["agreed"].dump() +
         " of " + claims["judged"].dump() + " episodes" +
         disagreements("false claims of success:", claims["claimed_without_success"]) +
         disagreements("successes that were not claimed:", claims["success_without_claim"]);
}

std::string evaluation_page(const Json& result, const Episodes& episodes) {
  const std::string behavior = result["campaign"]["behavior"].get<std::string>();
  std::string page = hil::page_head("Kaz evaluate: " + behavior);
  page += "<h1>" + xml_text(behavior) + ": " + reached(result) +
          " episodes succeeded</h1>\n<p class=\"facts\">";
  if (result.contains("interval")) page += "95 % interval " + percent(result) + "<br>";
  if (result.contains("claims")) page += xml_text(claims_text(result["claims"])) + "<br>";
  page += "falls " + result["falls"].dump() + hil::provenance_html(provenance()) + "</p>\n";
  const Json breakdown = result.value("by", Json::object());
  for (const char* name : kGroups) {
    if (!breakdown.contains(name)) continue;
    page +=
        "<h2>By " + std::string(name) + "</h2>\n<table>" +
        hil::table_row(
            {name, "reached", "95 % interval", "distance from the goal, mm: median and maximum",
             "walking time divided by the shortest possible time: median and maximum", "failures"},
            "th");
    for (const auto& [its, group] : breakdown[name].items())
      page +=
          hil::table_row({its, reached(group), percent(group), spread(group, "off_goal_m", 1e3, 0),
                          spread(group, "over_least", 1, 1), causes(group["failures"])});
    page += "</table>\n";
  }
  if (breakdown.contains("moving")) {
    const Json& moving = breakdown["moving"];
    page += "<p>A box slid into the way in " + moving["in_the_way"].dump() +
            " episodes. The robot noticed the box in " + moving["noticed"].dump() +
            " and touched an obstacle in " + moving["touched"].dump() + ".</p>\n";
  }
  if (breakdown.contains("map")) {
    const Json& map = breakdown["map"];
    page += "<p>" + map_text(map) + ".</p>\n";
  }
  if (result["failures"].empty()) return page + hil::kPageEnd;
  page += "<h2>Failures</h2>\n<table>" +
          hil::table_row(
              {"episode", "world", "density", "cause", "claim", "message of the behavior"}, "th");
  for (const auto& [number, episode] : episodes)
    if (!episode["success"].get<bool>()) page += failure_row(episode);
  return page + "</table>\n" + hil::kPageEnd;
}

}  // namespace kaz::tools
