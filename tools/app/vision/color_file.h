// Colour thresholds as a JSON file: what `kaz vision learn-color` writes and `kaz vision run` reads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "vision/color/ball.h"

namespace kaz::tools {

// Keys as the members of vision::ColorRange: hue_min, hue_max (rad), saturation_min, y_min and so on.
nlohmann::ordered_json color_json(const vision::ColorRange& range);
// Whether a ball's radius and colour are the default ones.
bool is_usual(const vision::BallOptions& ball);
// Keys that are missing keep their default; others may be there. Errors name file and key.
Result<vision::ColorRange> read_color(const std::string& path);
// The same of a file's content; `name`: for the errors.
Result<vision::ColorRange> parse_color(const std::string& content, const std::string& name);

}  // namespace kaz::tools
