// What this machine's kernel reports of its devices, in files; a test has a folder of its own instead.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace kaz::tools {

struct VideoFormats {
  bool captures = false;             // false: a node of a camera for something else than pictures
  std::vector<std::string> formats;  // "YUYV", as the driver names them
  std::string error;                 // why it could not be opened; empty if it could
};

struct MachineFiles {
  std::string root;  // in front of /sys, /dev, /proc; empty: the machine's
  uid_t user = 0;    // whose permissions count
  std::vector<gid_t> groups;
  int cores = 1;
  std::string kernel;       // release, as uname -r prints it
  std::string search_path;  // of programs, separated by colons
  // Output of `ip -json -details link show NAME`; empty if there is no such program.
  std::function<std::string(const std::string& name)> interface_details;
  std::function<VideoFormats(const std::string& path)> video_formats;

  static MachineFiles of_this_machine();

  // First line of a file; nothing if it cannot be read.
  std::optional<std::string> line(const std::string& path) const;
  // Names in a folder, sorted; none if there is none.
  std::vector<std::string> names(const std::string& folder) const;
  bool exists(const std::string& path) const;
  // Where a link, or a path with links in it, leads, without `root`; empty if nowhere.
  std::string target(const std::string& path) const;
  bool may_use(const std::string& device) const;
  // "PID (NAME)" of processes that have the device open, of those whose files `user` may see.
  std::vector<std::string> holders(const std::string& device) const;
  bool has_program(const std::string& name) const;
};

}  // namespace kaz::tools
