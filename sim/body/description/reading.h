// Options for reading a robot or world file, and the result of comparing the file with what Kaz supports.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::sim {

// Treatment of an element or an attribute of a file.
enum class Use {
  used,
  // Not used. The physics of the robot does not depend on it.
  noted,
  // Not supported, although the physics depends on it: an error.
  refused,
};

// Returns whether `words`, separated by spaces, contain `word`.
constexpr bool has_word(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    const auto end = words.find(' ');
    if (words.substr(0, end) == word) return true;
    words = end == words.npos ? std::string_view() : words.substr(end + 1);
  }
  return false;
}

// Element or attribute that is not used, or a default of the file format that is used.
struct FileNote {
  int line = 0;
  std::string what;  // "<transmission>", "attribute `acceleration` of <limit>"
  bool by_default = false;
  std::string path = {};  // file that contains it, if it is an included file
};

// Collision shape that replaces a mesh. Each of them encloses all vertices of the mesh.
enum class MeshCollision { hull, box, capsule };
inline constexpr std::array kMeshCollisions{MeshCollision::hull, MeshCollision::box,
                                            MeshCollision::capsule};

constexpr const char* to_string(MeshCollision shape) {
  return shape == MeshCollision::hull ? "hull" : shape == MeshCollision::box ? "box" : "capsule";
}

struct ReadOptions {
  // False: only joints and names are read and checked. Links then have no mass and no shapes.
  bool body = true;
  // True: a note is an error, too.
  bool strict = false;
  // True: a mesh that does not exist is a note, and its link has neither the visual nor the collision shape.
  bool skip_missing_meshes = false;
  MeshCollision mesh_collision = MeshCollision::hull;
};

// All errors of one file.
class Objections {
 public:
  explicit Objections(std::string path) : path_(std::move(path)) {}
  // `text` may quote the file: control characters are replaced by spaces. Only the first 1,000 are kept.
  void add(int line, const std::string& text) { add({}, line, text); }
  // For a line of an included file. An empty `path` means the file itself.
  void add(const std::string& path, int line, const std::string& text);
  bool empty() const { return found_.empty(); }
  // Returns an error if there are objections: the first in order of files and lines is the message, the
  // others are its details. Details end after 50.
  Result<void> result() const;

 private:
  struct Objection {
    std::string path;  // empty: the file itself
    int line = 0;
    std::string text;
  };
  std::string path_;
  std::vector<Objection> found_;
};

// Summary of the notes in one line, such as "<transmission> (23), <gazebo> (7)"; empty without notes.
std::string summary(const std::vector<FileNote>& notes);

}  // namespace kaz::sim
