// Meshes from OBJ and STL files.
// SPDX-License-Identifier: Apache-2.0
//
// STL: https://www.fabbers.com/tech/STL_Format; a binary file has 80 bytes of header, a count, and
// 50 bytes for each triangle, and is recognized by a size that matches its count. OBJ: v, vn and f lines;
// others are ignored.
#include "sim/body/description/mesh_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string_view>

#include <Eigen/Geometry>

#include "shared/base/files.hpp"
#include "sim/body/description/collada.h"

namespace kaz::sim {

static_assert(std::endian::native == std::endian::little,
              "binary STL is read without byte swapping");

namespace {

using Points = std::array<Eigen::Vector3d, 3>;

Eigen::Vector3d scaled_normal(const Eigen::Vector3d& normal, const Eigen::Vector3d& scale) {
  return normal.cwiseQuotient(scale).normalized();
}

// Maximum of coordinates, in the model's unit: far above any model's, and its square is a finite float.
constexpr double kFarthest = 1e9;

// Neither NaN nor beyond kFarthest.
bool usable(const Eigen::Vector3d& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kFarthest;
}

tl::unexpected<Error> far_vertex(const std::string& path) {
  return fail(
      Fault::usage,
      path + ": a vertex is not finite or is beyond 1e9: check the unit and export the mesh again");
}

// Degenerate triangles have no normal and are skipped.
void add_flat(MeshTriangles& mesh, const Points& p) {
  const Eigen::Vector3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
  if (!(cross.norm() > 0)) return;
  mesh.corners.insert(mesh.corners.end(), p.begin(), p.end());
  mesh.normals.insert(mesh.normals.end(), 3, cross.normalized());
}

Result<MeshTriangles> binary_stl(std::string_view bytes, const std::string& path,
                                 const Eigen::Vector3d& scale) {
  MeshTriangles mesh;
  for (std::size_t at = 84; at + 50 <= bytes.size(); at += 50) {
    float numbers[12];
    std::memcpy(numbers, bytes.data() + at, sizeof numbers);
    Points p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = Eigen::Vector3d(numbers[3 + 3 * i], numbers[4 + 3 * i], numbers[5 + 3 * i])
                 .cwiseProduct(scale);
      if (!usable(p[i])) return far_vertex(path);
    }
    add_flat(mesh, p);
  }
  return mesh;
}

Result<MeshTriangles> text_stl(const std::string& text, const std::string& path,
                               const Eigen::Vector3d& scale) {
  MeshTriangles mesh;
  std::istringstream in(text);
  std::string word;
  Points p;
  std::size_t corner = 0;
  while (in >> word) {
    if (word != "vertex") continue;
    Eigen::Vector3d v;
    if (!(in >> v.x() >> v.y() >> v.z())) {
      return fail(Fault::usage,
                  path + ": a vertex line needs three numbers: export the mesh again");
    }
    p[corner] = v.cwiseProduct(scale);
    if (!usable(p[corner++])) return far_vertex(path);
    if (corner == 3) {
      add_flat(mesh, p);
      corner = 0;
    }
  }
  return mesh;
}

struct ObjCorner {
  std::size_t position;
  std::size_t normal;  // npos: none
};
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// "7", "7/1", "7//3", "7/1/3"; negative numbers count from the end.
bool parse_corner(const std::string& word, std::size_t positions, std::size_t normals,
                  ObjCorner& corner) {
  const auto index = [](const std::string& text, std::size_t count, std::size_t& result) {
    const long n = std::strtol(text.c_str(), nullptr, 10);
    const long i = n > 0 ? n - 1 : static_cast<long>(count) + n;
    if (n == 0 || i < 0 || static_cast<std::size_t>(i) >= count) return false;
    result = static_cast<std::size_t>(i);
    return true;
  };
  const std::size_t first = word.find('/');
  corner.normal = kNone;
  if (!index(word.substr(0, first), positions, corner.position)) return false;
  const std::size_t second = first == std::string::npos ? first : word.find('/', first + 1);
  return second == std::string::npos || index(word.substr(second + 1), normals, corner.normal);
}

Result<MeshTriangles> obj(const std::string& text, const std::string& path,
                          const Eigen::Vector3d& scale) {
  MeshTriangles mesh;
  std::vector<Eigen::Vector3d> positions, normals;
  std::istringstream in(text);
  std::string line, word;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "v" || word == "vn") {
      Eigen::Vector3d v;
      if (!(words >> v.x() >> v.y() >> v.z())) {
        return fail(Fault::usage, path + ":" + std::to_string(number) + ": `" + word +
                                      "` needs three numbers: export the mesh again");
      }
      if (!usable(v) || (word == "v" && !usable(v.cwiseProduct(scale)))) return far_vertex(path);
      if (word == "v") positions.push_back(v.cwiseProduct(scale));
      if (word == "vn") normals.push_back(scaled_normal(v, scale));
    } else if (word == "f") {
      std::vector<ObjCorner> corners;
      while (words >> word) {
        ObjCorner corner{};
        if (!parse_corner(word, positions.size(), normals.size(), corner)) {
          return fail(
              Fault::usage,
              path + ":" + std::to_string(number) + ": face corner `" + word +
                  "` refers to a vertex that is not defined above it: export the mesh again");
        }
        corners.push_back(corner);
      }
      for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const std::array<ObjCorner, 3> c{corners[0], corners[i], corners[i + 1]};
        const Points p{positions[c[0].position], positions[c[1].position],
                       positions[c[2].position]};
        if (c[0].normal == kNone || c[1].normal == kNone || c[2].normal == kNone) {
          add_flat(mesh, p);
          continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          mesh.corners.push_back(p[k]);
          mesh.normals.push_back(normals[c[k].normal]);
        }
      }
    }
  }
  return mesh;
}

// A mirrored triangle is clockwise: two corners change places.
void turn_inside_out(MeshTriangles& mesh) {
  for (std::size_t i = 0; i + 2 < mesh.corners.size(); i += 3) {
    std::swap(mesh.corners[i + 1], mesh.corners[i + 2]);
    std::swap(mesh.normals[i + 1], mesh.normals[i + 2]);
  }
  // Normals that were computed from mirrored corners point inward; those of files were mirrored.
  for (std::size_t i = 0; i + 2 < mesh.corners.size(); i += 3) {
    const Eigen::Vector3d cross =
        (mesh.corners[i + 1] - mesh.corners[i]).cross(mesh.corners[i + 2] - mesh.corners[i]);
    for (std::size_t k = i; k < i + 3; ++k) {
      if (mesh.normals[k].dot(cross) < 0) mesh.normals[k] = -mesh.normals[k];
    }
  }
}

}  // namespace

Result<MeshTriangles> read_mesh(const std::string& path, const Eigen::Vector3d& scale) {
  if (!(scale.cwiseAbs().minCoeff() > 0))
    return fail(Fault::usage, path + ": the mesh's scale must not be zero on any axis");
  constexpr std::size_t max_bytes = 256 << 20;
  const std::string bytes =
      KAZ_TRY(read_whole_file(path, max_bytes, "give a mesh: .obj, .stl or .dae"));
  std::string extension = path.substr(std::min(path.size(), path.rfind('.')));
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, sizeof count);
  const bool binary = bytes.size() >= 84 && bytes.size() == 84 + std::size_t{50} * count;
  Result<MeshTriangles> mesh;
  if (extension == ".obj")
    mesh = obj(bytes, path, scale);
  else if (extension == ".stl")
    mesh = binary ? binary_stl(bytes, path, scale) : text_stl(bytes, path, scale);
  else if (extension == ".dae")
    mesh = read_collada(path, scale);
  else
    return fail(Fault::usage,
                path + ": only .obj, .stl and .dae meshes are supported: convert this one");
  if (!mesh) return mesh;
  if (mesh->corners.empty())
    return fail(Fault::usage, path + ": the mesh has no triangles: export it again");
  if (scale.prod() < 0) turn_inside_out(*mesh);
  return mesh;
}

}  // namespace kaz::sim
