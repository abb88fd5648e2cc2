// Files in which this machine's kernel reports its devices. Tests replace these files by files in a folder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace kaz::tools {

struct VideoFormats {
  // False: the device belongs to a camera but delivers no pictures.
  bool captures = false;
  std::vector<std::string> formats;  // names of pixel formats from the driver, for example "YUYV"
  // Reason why the device could not be opened; empty if it was opened.
  std::string error;
};

struct MachineFiles {
  // Folder that replaces / in paths of /sys, /dev and /proc; empty: this machine's files.
  std::string root;
  uid_t user = 0;  // user whose permissions are checked
  std::vector<gid_t> groups;
  int cores = 1;
  std::string kernel;       // release of the kernel, as printed by `uname -r`
  std::string search_path;  // folders that contain programs, separated by colons
  // Returns the output of `ip -json -details link show NAME`; empty if the program is missing.
  std::function<std::string(const std::string& name)> interface_details;
  std::function<VideoFormats(const std::string& path)> video_formats;

  static MachineFiles of_this_machine();

  // Returns the first line of a file; nullopt if the file cannot be read.
  std::optional<std::string> line(const std::string& path) const;
  // Returns the names in a folder, sorted; an empty list if the folder is missing.
  std::vector<std::string> names(const std::string& folder) const;
  bool exists(const std::string& path) const;
  // Resolves symbolic links in a path. Returns the resolved path without `root`; empty if the target is
  // missing.
  std::string target(const std::string& path) const;
  bool may_use(const std::string& device) const;
  // Returns "PID (NAME)" of the processes that have the device open. Excludes processes whose open files
  // `user` may not see.
  std::vector<std::string> holders(const std::string& device) const;
  bool has_program(const std::string& name) const;
};

}  // namespace kaz::tools
