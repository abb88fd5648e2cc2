// Color thresholds as a JSON file.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/color_file.h"

#include <cmath>
#include <iterator>

#include "shared/base/bounded_json.hpp"
#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

struct Member {
  const char* key;
  double vision::ColorRange::*value;
};
constexpr Member kMembers[] = {{"hue_min", &vision::ColorRange::hue_min},
                               {"hue_max", &vision::ColorRange::hue_max},
                               {"saturation_min", &vision::ColorRange::saturation_min},
                               {"y_min", &vision::ColorRange::y_min},
                               {"y_max", &vision::ColorRange::y_max},
                               {"i_min", &vision::ColorRange::i_min},
                               {"i_max", &vision::ColorRange::i_max},
                               {"q_min", &vision::ColorRange::q_min},
                               {"q_max", &vision::ColorRange::q_max}};

}  // namespace

nlohmann::ordered_json color_json(const vision::ColorRange& range) {
  nlohmann::ordered_json json;
  for (const Member& member : kMembers) json[member.key] = range.*member.value;
  return json;
}

bool is_usual(const vision::BallOptions& ball) {
  const vision::BallOptions usual;
  return ball.radius_m == usual.radius_m && color_json(ball.color) == color_json(usual.color);
}

Result<vision::ColorRange> read_color(const std::string& path) {
  constexpr std::size_t max_bytes = 64 << 10;
  const auto text =
      KAZ_TRY(read_whole_file(path, max_bytes, "kaz vision learn-color writes such a file"));
  return parse_color(text, path);
}

Result<vision::ColorRange> parse_color(const std::string& content, const std::string& name) {
  const auto bad = [&](const std::string& what) { return fail(Fault::usage, name + ": " + what); };
  const auto parsed = parse_bounded_json(content);
  if (!parsed) return bad(parsed.error().message);
  const nlohmann::json& json = *parsed;
  if (!json.is_object()) return bad("not a JSON object of color thresholds");
  vision::ColorRange range;
  bool any = false;
  for (const Member& member : kMembers) {
    const auto found = json.find(member.key);
    if (found == json.end()) continue;
    if (!found->is_number() || std::abs(found->get<double>()) > 1000)
      return bad(std::string(member.key) + " must be a number from -1000 to 1000");
    range.*member.value = found->get<double>();
    any = true;
  }
  if (!any)
    return bad(
        "contains no color threshold; give at least one of hue_min, hue_max, saturation_min, ...");
  const double width = range.hue_max - range.hue_min;
  if (width < 0 || width >= 3.1415)
    return bad("hue_max must be at least hue_min and less than hue_min + pi");
  if (range.saturation_min != 0 && width == 0)
    return bad("saturation_min needs hue_min and hue_max");
  return range;
}

}  // namespace kaz::tools
