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
#include <iterator>

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

// Both free of links and "..".
bool is_inside(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

fs::path package_of(const fs::path& folder) {
  std::error_code ignored;
  for (fs::path at = folder; at.has_relative_path(); at = at.parent_path()) {
    if (fs::is_regular_file(at / "package.xml", ignored)) return at;
  }
  return folder;
}

bool is_in_named_folder(const fs::path& path) {
  const char* named = std::getenv("KAZ_MESH_PATH");
  std::string_view rest = named == nullptr ? "" : named;
  while (!rest.empty()) {
    const auto end = rest.find(':');
    std::error_code error;
    const fs::path folder = fs::canonical(rest.substr(0, end), error);
    if (!error && is_inside(path, folder)) return true;
    rest = end == rest.npos ? "" : rest.substr(end + 1);
  }
  return false;
}

}  // namespace

Result<std::string> mesh_path(const std::string& robot_path, const std::string& name) {
  std::error_code error;
  const fs::path folder = fs::canonical(fs::absolute(robot_path).parent_path(), error);
  const fs::path path = fs::canonical(folder / name, error);
  if (error) return (folder / name).string();
  const fs::path package = package_of(folder);
  if (is_inside(path, package) || is_in_named_folder(path)) return path.string();
  return fail(Fault::usage, "is the file " + path.string() +
                                ", which is outside of the robot's folder " + package.string() +
                                ": copy the file there, or add its folder to KAZ_MESH_PATH");
}

constexpr std::size_t kMaxMeshBytes = 256 << 20;

std::optional<std::string> mesh_error(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".obj" && ending != ".stl") return "is neither .obj nor .stl";
  const auto read = read_whole_file(path, kMaxMeshBytes);
  if (!read) return read.error().message.substr(path.size() + 2);
  const std::string& bytes = *read;
  if (ending == ".stl") return stl_error(bytes);
  if (!starts_with_word(bytes, "v ") && bytes.find("\nv ") == std::string::npos)
    return "has no vertices";
  if (bytes.find("\nf ") == std::string::npos) return "has no faces";
  return std::nullopt;
}

}  // namespace kaz::sim
