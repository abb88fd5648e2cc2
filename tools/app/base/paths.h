// Where the program's own files are: robot, worlds, firmware.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::tools {

// Path of a file under share/kaz, e.g. "robot/kaz/kaz.urdf". The folder is $KAZ_DATA if that is
// set, else
// ../share/kaz seen from the program. Fails where the file is not there.
Result<std::string> data_file(const std::string& name);

// A world by path, or by the name of one that comes with Kaz ("ball").
Result<std::string> world_file(const std::string& name);

// The folder of the page of --view. Where there is none the error says what builds it.
Result<std::string> view_page();

// The firmware image to emulate: `given` if not empty, else the one built with the program. Where
// there is none the error says what to install.
Result<std::string> firmware_image(const std::string& given);

// recording.mcap of a folder that `kaz run` has written; else the path itself.
std::string recording_of(const std::string& path);

}  // namespace kaz::tools
