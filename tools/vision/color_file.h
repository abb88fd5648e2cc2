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
// Reads a color file. A missing key has its default value, and unknown keys are ignored. Fails (usage) if the
// file is not valid; the message contains the path and the key.
Result<vision::ColorRange> read_color(const std::string& path);
// Parses the content of a color file. `name`: name of the file for error messages.
Result<vision::ColorRange> parse_color(const std::string& content, const std::string& name);

}  // namespace kaz::tools
