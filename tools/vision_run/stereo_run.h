// Steps that all runs of `kaz vision run` on stereo pairs share. Internal to this folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "shared/base/result.hpp"
#include "tools/base/output_file.h"
#include "tools/vision/modules.h"
#include "tools/vision/report.h"
#include "tools/vision_run/recorded_pictures.h"
#include "vision/image/frame.h"

namespace kaz::tools {

// Functions that return a Result fail with Fault::usage if options contradict each other.

Result<VisionOptions> vision_options(const RecordedOptions& options);
// Checks --nearest against the eyes: the range of disparities must have 16 px or more, and be smaller than
// the picture's width.
Result<void> check_nearest(const RecordedOptions& options, const vision::CameraModel& camera);
// Fails if --modules contains one of `modules`. `why`: the rest of the sentence.
Result<void> refuse(const VisionOptions& vision, std::initializer_list<std::string_view> modules,
                    const std::string& why);
// Writes the files and prints the summary. `lost`: reason why the camera or the robot stopped; empty: neither
// did.
Result<bool> finish(VisionReport& report, const nlohmann::ordered_json& statistics,
                    const std::string& text, const RecordedOptions& options,
                    const VisionOptions& vision, const OutputFolder& folder, bool interrupted,
                    const std::string& lost = "");

}  // namespace kaz::tools
