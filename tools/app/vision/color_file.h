// Color thresholds as a JSON file, written by `kaz vision learn-color` and read by `kaz vision run`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "vision/color/ball.h"

namespace kaz::tools {

// The keys are the members of vision::ColorRange: hue_min, hue_max (rad), saturation_min, y_min and others.
nlohmann::ordered_json color_json(const vision::ColorRange& range);
// Returns whether a ball has the default radius and color.
bool is_usual(const vision::BallOptions& ball);
// Missing keys keep their default, unknown keys are ignored. Fails (usage) with the file and key in the
// message.
Result<vision::ColorRange> read_color(const std::string& path);
// Parses the content of such a file. `name`: for errors.
Result<vision::ColorRange> parse_color(const std::string& content, const std::string& name);

}  // namespace kaz::tools
