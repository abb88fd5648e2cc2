// Locations of installed files: robot, worlds, viewer page, firmware.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Returns the path of a file under share/kaz, for example "robot/kaz/kaz.urdf". The folder share/kaz is
// $KAZ_DATA if this variable is set, else ../share/kaz relative to the executable. Fails (environment) if the
// file is missing.
Result<std::string> data_file(const std::string& name);

// Returns the path of a world file. `name` is the name of an installed world, for example "ball", or a path.
// Fails (usage) if the file is missing.
Result<std::string> world_file(const std::string& name);

// Returns the folder of the viewer's page (option --view). If the folder is missing, the error (environment)
// states the command that builds the page.
Result<std::string> view_page();

// Returns the path of the firmware image to emulate: `given`, or the installed image if `given` is empty. A
// missing installed image fails with Fault::environment, and the message lists the packages to install.
Result<std::string> firmware_image(const std::string& given);

// Returns the path of recording.mcap in a folder that `kaz run` has written. If `path` is not a folder,
// returns `path`.
std::string recording_of(const std::string& path);

}  // namespace kaz::tools
