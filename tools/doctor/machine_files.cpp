// Reads sysfs, procfs and devices.
// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/machine_files.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

std::string details_of(const std::string& name) {
  // Names of interfaces may hold any byte but slash and white space; the shell gets harmless ones only.
  const auto harmless = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  if (name.empty() || !std::ranges::all_of(name, harmless)) return "";
  const std::string command =
      "PATH=$PATH:/usr/sbin:/sbin ip -json -details link show " + name + " 2>/dev/null";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  char part[4096];
  while (pipe != nullptr && text.size() < 65536) {
    const std::size_t got = fread(part, 1, sizeof part, pipe.get());
    if (got == 0) break;
    text.append(part, got);
  }
  return text;
}

VideoFormats formats_of(const std::string& path) {
  VideoFormats found;
  const int fd = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    found.error = std::strerror(errno);
    return found;
  }
  v4l2_capability capability{};
  if (ioctl(fd, VIDIOC_QUERYCAP, &capability) == 0) {
    const auto can = capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps
                                                                    : capability.capabilities;
    found.captures = (can & V4L2_CAP_VIDEO_CAPTURE) != 0;
  }
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; found.captures && format.index < 64 && ioctl(fd, VIDIOC_ENUM_FMT, &format) == 0;
       ++format.index) {
    std::string code;
    for (int i = 0; i < 4; ++i) code += static_cast<char>(format.pixelformat >> (8 * i) & 0x7F);
    found.formats.push_back(code.substr(0, code.find_last_not_of(' ') + 1));
  }
  close(fd);
  return found;
}

}  // namespace

MachineFiles MachineFiles::of_this_machine() {
  MachineFiles files;
  files.user = geteuid();
  files.groups.resize(static_cast<std::size_t>(std::max(getgroups(0, nullptr), 0)));
  if (!files.groups.empty()) getgroups(static_cast<int>(files.groups.size()), files.groups.data());
  files.groups.push_back(getegid());
  files.cores = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  utsname names{};
  if (uname(&names) == 0) files.kernel = names.release;
  if (const char* path = std::getenv("PATH")) files.search_path = path;
  files.interface_details = details_of;
  files.video_formats = formats_of;
  return files;
}

std::optional<std::string> MachineFiles::line(const std::string& path) const {
  std::ifstream file(root + path);
  std::string text;
  if (!std::getline(file, text)) return std::nullopt;
  return text;
}

std::vector<std::string> MachineFiles::names(const std::string& folder) const {
  std::vector<std::string> names;
  std::error_code none;
  for (fs::directory_iterator
           at(root + folder, fs::directory_options::skip_permission_denied, none),
       end;
       !none && at != end; at.increment(none))
    names.push_back(at->path().filename());
  std::ranges::sort(names);
  return names;
}

bool MachineFiles::exists(const std::string& path) const {
  std::error_code none;
  return fs::exists(root + path, none);
}

std::string MachineFiles::target(const std::string& path) const {
  std::error_code error;
  const std::string to = fs::canonical(root + path, error);
  if (error) return "";
  const std::string top = root.empty() ? "" : fs::canonical(root, error).string();
  return to.starts_with(top) ? to.substr(top.size()) : to;
}

// Not access(): it knows only the process' own rights.
bool MachineFiles::may_use(const std::string& device) const {
  struct stat status {};
  if (stat((root + device).c_str(), &status) != 0) return false;
  if (user == 0) return true;
  const auto both = [&](mode_t read, mode_t write) {
    return (status.st_mode & read) != 0 && (status.st_mode & write) != 0;
  };
  if (status.st_uid == user) return both(S_IRUSR, S_IWUSR);
  if (std::ranges::find(groups, status.st_gid) != groups.end()) return both(S_IRGRP, S_IWGRP);
  return both(S_IROTH, S_IWOTH);
}

std::vector<std::string> MachineFiles::holders(const std::string& device) const {
  std::vector<std::string> holders;
  const std::string self = std::to_string(getpid());
  for (const std::string& process : names("/proc")) {
    if (!std::isdigit(static_cast<unsigned char>(process.front())) || process == self) continue;
    const std::string folder = "/proc/" + process;
    for (const std::string& descriptor : names(folder + "/fd")) {
      std::error_code error;
      const std::string to = fs::read_symlink(root + folder + "/fd/" + descriptor, error);
      if (error || to != device) continue;
      holders.push_back(process + " (" + line(folder + "/comm").value_or("?") + ")");
      break;
    }
  }
  return holders;
}

bool MachineFiles::has_program(const std::string& name) const {
  std::size_t at = 0;
  while (at <= search_path.size()) {
    const std::size_t colon = std::min(search_path.find(':', at), search_path.size());
    const std::string folder = search_path.substr(at, colon - at);
    if (!folder.empty() && exists(folder + "/" + name)) return true;
    at = colon + 1;
  }
  return false;
}

}  // namespace kaz::tools
