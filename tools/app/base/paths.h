// Locations of installed files: robot, worlds, page, firmware.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Returns the path of a file under share/kaz, for example "robot/kaz/kaz.urdf". The folder is $KAZ_DATA if
// set, else ../share/kaz relative to the executable. Fails (environment) if the file is missing.
Result<std::string> data_file(const std::string& name);

// Finds a world by the name of an installed one ("ball"), or by path. Fails with Fault::usage.
Result<std::string> world_file(const std::string& name);

// Returns the folder of the --view page. If it is missing, the error (environment) states the command that
// builds it.
Result<std::string> view_page();

// Returns the firmware image to emulate: `given`, or the installed one if `given` is empty. A missing
// installed image fails with Fault::environment, and the message lists the packages to install.
Result<std::string> firmware_image(const std::string& given);

// Returns recording.mcap in a folder written by `kaz run`, or `path` itself if it is no folder.
std::string recording_of(const std::string& path);

}  // namespace kaz::tools
