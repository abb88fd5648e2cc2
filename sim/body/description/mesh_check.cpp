// Checks that a mesh file named in a robot file is readable.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mesh_check.h"
#include "shared/base/files.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

namespace kaz::sim {
namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;  // bytes

bool starts_with_word(const std::string& text, const std::string& word) {
  return text.compare(0, word.size(), word) == 0;
}

std::optional<std::string> stl_error(const std::string& bytes) {
  std::uint32_t triangles = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&triangles, bytes.data() + 80, sizeof triangles);
  if (bytes.size() >= kStlHead && bytes.size() == kStlHead + kStlTriangle * triangles) {
    if (triangles > 0) return std::nullopt;
    return "has no triangles";
  }
  if (starts_with_word(bytes, "solid") && bytes.find("facet") != std::string::npos)
    return std::nullopt;
  return "is not an STL file, or is truncated";
}

namespace fs = std::filesystem;

fs::path package_of(const fs::path& folder) {
  std::error_code ignored;
  for (fs::path at = folder; at.has_relative_path(); at = at.parent_path()) {
    if (fs::is_regular_file(at / "package.xml", ignored)) return at;
  }
  return folder;
}

std::vector<fs::path> named_folders() {
  return listed_folders("KAZ_MESH_PATH");
}

// The name in a package.xml, or that of its folder.
std::string package_name(const fs::path& package) {
  constexpr std::size_t kMaxPackageBytes = 1 << 20;
  const auto text = read_whole_file((package / "package.xml").string(), kMaxPackageBytes);
  const std::string open = "<name>", close = "</name>";
  const auto begin = text ? text->find(open) : std::string::npos;
  const auto end = begin == std::string::npos ? begin : text->find(close, begin);
  if (end == std::string::npos) return package.filename().string();
  return text->substr(begin + open.size(), end - begin - open.size());
}

// The path that `name` means, before links are resolved.
Result<fs::path> meant_path(const fs::path& folder, const std::string& name) {
  const auto scheme = name.find("://");
  if (scheme == std::string::npos) return folder / name;
  const std::string kind = name.substr(0, scheme), rest = name.substr(scheme + 3);
  if (kind == "file") return fs::path(rest);
  if (kind != "package" && kind != "model")
    return fail(Fault::usage,
                "has a URI of the unsupported kind " + kind +
                    ":// ; copy the mesh beside the robot file, and give a relative path");
  const std::string package = rest.substr(0, rest.find('/'));
  const fs::path inside = rest.substr(std::min(rest.size(), package.size() + 1));
  if (package.empty() || package_name(package_of(folder)) == package)
    return (package.empty() ? folder : package_of(folder)) / inside;
  for (const fs::path& named : named_folders()) {
    if (named.filename() == package) return named / inside;
    std::error_code ignored;
    if (fs::is_directory(named / package, ignored)) return named / package / inside;
  }
  return fail(Fault::usage,
              "is in the package `" + package +
                  "`, which was not found: add the package's folder to KAZ_MESH_PATH");
}

}  // namespace

bool is_inside(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

std::vector<fs::path> listed_folders(const char* variable) {
  const char* named = std::getenv(variable);
  std::string_view rest = named == nullptr ? "" : named;
  std::vector<fs::path> folders;
  while (!rest.empty()) {
    const auto end = rest.find(':');
    std::error_code error;
    const fs::path folder = fs::canonical(rest.substr(0, end), error);
    if (!error) folders.push_back(folder);
    rest = end == rest.npos ? "" : rest.substr(end + 1);
  }
  return folders;
}

Result<std::string> mesh_path(const std::string& robot_path, const std::string& name) {
  std::error_code error;
  const fs::path folder = fs::canonical(fs::absolute(robot_path).parent_path(), error);
  const fs::path meant = KAZ_TRY(meant_path(folder, name));
  const fs::path path = fs::canonical(meant, error);
  if (error) return meant.string();
  const fs::path package = package_of(folder);
  const auto holds = [&path](const fs::path& named) { return is_inside(path, named); };
  if (is_inside(path, package) || std::ranges::any_of(named_folders(), holds)) return path.string();
  return fail(Fault::usage, "is the file " + path.string() +
                                ", which is outside of the robot's folder " + package.string() +
                                ": copy the file there, or add its folder to KAZ_MESH_PATH");
}

bool mesh_exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

constexpr std::size_t kMaxMeshBytes = 256 << 20;

std::optional<std::string> mesh_error(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".obj" && ending != ".stl" && ending != ".dae") return "is not .obj, .stl or .dae";
  const auto read = read_whole_file(
      path, kMaxMeshBytes,
      "check the path, add a folder to KAZ_MESH_PATH, or give --skip-missing-meshes");
  if (!read) return read.error().message.substr(path.size() + 2);
  const std::string& bytes = *read;
  if (ending == ".stl") return stl_error(bytes);
  if (ending == ".dae")
    return bytes.find("<COLLADA") == std::string::npos
               ? std::optional<std::string>("is not COLLADA")
               : std::nullopt;
  if (!starts_with_word(bytes, "v ") && bytes.find("\nv ") == std::string::npos)
    return "has no vertices";
  if (bytes.find("\nf ") == std::string::npos) return "has no faces";
  return std::nullopt;
}

}  // namespace kaz::sim
