// Where the program's own files are: robot, worlds, firmware.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/paths.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

fs::path data_folder() {
  if (const char* folder = std::getenv("KAZ_DATA"); folder != nullptr && *folder != '\0')
    return folder;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share" / "kaz";
}

std::string known_worlds() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(data_folder() / "worlds", error)) {
    if (entry.path().extension() == ".sdf") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

Result<std::string> data_file(const std::string& name) {
  const fs::path path = data_folder() / name;
  std::error_code error;
  if (fs::exists(path, error)) return path.string();
  return fail(Fault::environment,
              "'" + path.string() +
                  "' is missing: the installation is incomplete; set KAZ_DATA to "
                  "the folder that contains 'robot' and 'worlds', or install again");
}

Result<std::string> world_file(const std::string& name) {
  std::error_code error;
  const bool plain_name =
      name.find('/') == std::string::npos && name.find('.') == std::string::npos;
  // Before a file of that name, which somebody may have in the folder by chance.
  if (plain_name) {
    const fs::path path = data_folder() / "worlds" / (name + ".sdf");
    if (fs::exists(path, error)) return path.string();
  }
  if (fs::is_regular_file(name, error)) return name;
  if (!plain_name)
    return fail(Fault::usage, (fs::is_directory(name, error) ? "a world is a file, not a folder: '"
                                                             : "there is no file '") +
                                  name +
                                  "': give the path of an SDF file, or one of: " + known_worlds());
  return fail(Fault::usage, "no world `" + name +
                                "`: give the path of an SDF file, or one of: " + known_worlds());
}

Result<std::string> view_page() {
  const fs::path folder = data_folder() / "view";
  std::error_code error;
  if (fs::exists(folder / "index.html", error)) return folder.string();
  // A build folder has a link into its tree.
  const fs::path worlds = fs::canonical(data_folder() / "worlds", error);
  const fs::path dev = worlds.parent_path().parent_path() / "tools/dev";
  if (!error && fs::exists(dev, error))
    return fail(Fault::environment, "the page of --view is not built; build it with: " +
                                        dev.string() + " build kaz_page");
  return fail(Fault::environment,
              "the page of --view is not in " + folder.string() +
                  ": Kaz was built without npm; build Kaz with npm, or install Kaz's packages");
}

Result<std::string> firmware_image(const std::string& given) {
  std::error_code error;
  if (!given.empty()) {
    if (fs::is_regular_file(given, error)) return given;
    return fail(Fault::usage, "no firmware image `" + given +
                                  "`: give the path of an S-record (.mot) or COFF (.coff) file");
  }
  const fs::path path = data_folder() / "firmware" / "kaz.mot";
  if (fs::exists(path, error)) return path.string();
  return fail(Fault::environment,
              "no firmware image at '" + path.string() +
                  "': install the cross compiler (apt-get install gcc-h8300-hms "
                  "binutils-h8300-hms) and build again, or use --mcu native");
}

std::string recording_of(const std::string& path) {
  std::error_code none;
  return std::filesystem::is_directory(path, none) ? path + "/recording.mcap" : path;
}

}  // namespace kaz::tools
