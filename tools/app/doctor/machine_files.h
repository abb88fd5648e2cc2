// Files in which this machine's kernel reports its devices. Tests use a folder of their own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace kaz::tools {

struct VideoFormats {
  bool captures = false;             // false: the node of a camera is not for pictures
  std::vector<std::string> formats;  // "YUYV": names from the driver
  std::string error;                 // why the device could not be opened; empty if it could
};

struct MachineFiles {
  std::string root;  // prefix of /sys, /dev, /proc; empty: this machine
  uid_t user = 0;    // user whose permissions are checked
  std::vector<gid_t> groups;
  int cores = 1;
  std::string kernel;       // release, as from uname -r
  std::string search_path;  // folders of programs, separated by colons
  // Returns the output of `ip -json -details link show NAME`; empty if the program is missing.
  std::function<std::string(const std::string& name)> interface_details;
  std::function<VideoFormats(const std::string& path)> video_formats;

  static MachineFiles of_this_machine();

  // Returns the first line of a file; nullopt if it cannot be read.
  std::optional<std::string> line(const std::string& path) const;
  // Returns the names in a folder, sorted; none if the folder is missing.
  std::vector<std::string> names(const std::string& folder) const;
  bool exists(const std::string& path) const;
  // Resolves links in a path. Returns it without `root`; empty if the target is missing.
  std::string target(const std::string& path) const;
  bool may_use(const std::string& device) const;
  // Returns "PID (NAME)" of the processes that have the device open, as far as `user` may see their files.
  std::vector<std::string> holders(const std::string& device) const;
  bool has_program(const std::string& name) const;
};

}  // namespace kaz::tools
