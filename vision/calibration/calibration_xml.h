// Converts a calibration file from cv::FileStorage's XML to its YAML. Internal to vision/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "shared/base/result.hpp"

namespace kaz::vision {

// Returns whether the first character, except blanks, is "<".
bool looks_like_xml(std::string_view content);

// Returns keys and numbers as text for scan_calibration() (calibration_text.h). Fails (usage) with the line
// if the content is not well-formed XML, or if its root element is not opencv_storage. `name`: name of the
// file.
Result<std::string> calibration_xml_as_yaml(const std::string& content, const std::string& name);

}  // namespace kaz::vision
