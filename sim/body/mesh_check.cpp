// Whether a mesh that a robot file names can be read at all.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/mesh_check.h"
#include "shared/base/files.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>

namespace kaz::sim {
namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;  // bytes

bool starts_with_word(const std::string& text, const std::string& word) {
  return text.compare(0, word.size(), word) == 0;
}

std::optional<std::string> stl_trouble(const std::string& bytes) {
  std::uint32_t triangles = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&triangles, bytes.data() + 80, sizeof triangles);
  if (bytes.size() >= kStlHead && bytes.size() == kStlHead + kStlTriangle * triangles) {
    if (triangles > 0) return std::nullopt;
    return "has no triangles";
  }
  if (starts_with_word(bytes, "solid") && bytes.find("facet") != std::string::npos)
    return std::nullopt;
  return "is no STL file, or is cut off";
}

}  // namespace

constexpr std::size_t kMaxMeshBytes = 256 << 20;

std::optional<std::string> mesh_trouble(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".obj" && ending != ".stl") return "is neither .obj nor .stl";
  const auto read = read_whole_file(path, kMaxMeshBytes);
  if (!read) return read.error().message.substr(path.size() + 2);
  const std::string& bytes = *read;
  if (ending == ".stl") return stl_trouble(bytes);
  if (!starts_with_word(bytes, "v ") && bytes.find("\nv ") == std::string::npos)
    return "has no vertices";
  if (bytes.find("\nf ") == std::string::npos) return "has no faces";
  return std::nullopt;
}

}  // namespace kaz::sim
