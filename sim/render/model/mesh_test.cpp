// Meshes: closed, outward normals, right size; files; textures.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/mesh.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include <Eigen/Geometry>

#include "sim/render/model/resample.h"
#include "sim/render/model/scene_model.h"
#include "sim/render/model/texture.h"

namespace kaz::sim {
namespace {

constexpr double kPi = 3.14159265358979323846;

Eigen::Vector3d point(const Mesh& mesh, std::uint32_t i) {
  const auto& p = mesh.vertices[i].position;
  return {p[0], p[1], p[2]};
}

// Sum of the tetrahedra to the origin: the volume of a closed mesh whose triangles face outwards.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    sum += point(mesh, mesh.indices[i])
               .dot(point(mesh, mesh.indices[i + 1]).cross(point(mesh, mesh.indices[i + 2]))) /
           6;
  }
  return sum;
}

// Each edge of a closed mesh is run through once in each direction.
bool closed(const Mesh& mesh) {
  using Key = std::array<long, 3>;
  const auto key = [&](std::uint32_t i) {
    const Eigen::Vector3d p = point(mesh, i) * 1e6;
    return Key{std::lround(p.x()), std::lround(p.y()), std::lround(p.z())};
  };
  std::map<std::pair<Key, Key>, int> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Key a = key(mesh.indices[i + k]), b = key(mesh.indices[i + (k + 1) % 3]);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  for (const auto& [edge, balance] : edges) {
    if (balance != 0) return false;
  }
  return true;
}

bool normals_face_outwards(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Eigen::Vector3d a = point(mesh, mesh.indices[i]);
    const Eigen::Vector3d cross =
        (point(mesh, mesh.indices[i + 1]) - a).cross(point(mesh, mesh.indices[i + 2]) - a);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& n = mesh.vertices[mesh.indices[i + k]].normal;
      const Eigen::Vector3d normal(n[0], n[1], n[2]);
      if (std::abs(normal.norm() - 1) > 1e-5 || normal.dot(cross) < 0) return false;
    }
  }
  return true;
}

class Shapes : public testing::TestWithParam<Detail> {};

TEST_P(Shapes, AreClosedAndOfTheRightVolume) {
  const Detail detail = GetParam();
  struct Case {
    const char* name;
    Mesh mesh;
    double exact;  // volume of the ideal shape
    double min;    // share of it that bevels and facets leave
  };
  // A regular 12-gon has 12/(2 pi) sin(2 pi/12) = 0.955 of its circle, a 16-gon 0.974.
  const Case cases[] = {
      {"box", box_mesh({0.1, 0.06, 0.04}, detail), 0.1 * 0.06 * 0.04, 0.99},
      {"cylinder", cylinder_mesh(0.02, 0.05, detail), kPi * 4e-4 * 0.05, 0.95},
      {"capsule", capsule_mesh(0.02, 0.05, detail), kPi * 4e-4 * (0.05 + 4.0 / 3 * 0.02), 0.90},
      {"sphere", sphere_mesh(0.02, detail), 4.0 / 3 * kPi * 8e-6, 0.99999},
  };
  for (const Case& c : cases) {
    EXPECT_TRUE(closed(c.mesh)) << c.name;
    EXPECT_TRUE(normals_face_outwards(c.mesh)) << c.name;
    EXPECT_LE(volume(c.mesh), c.exact * 1.00001) << c.name;
    EXPECT_GE(volume(c.mesh), c.exact * c.min) << c.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, Shapes, testing::Values(Detail::fine, Detail::coarse));

TEST(Box, BevelsItsEdges) {
  // 24 vertices; faces 12, edges 24, corners 8 triangles.
  const Mesh fine = box_mesh({0.1, 0.1, 0.1});
  EXPECT_EQ(fine.vertices.size(), 24U);
  EXPECT_EQ(fine.indices.size(), 3U * 44);
  // 2 mm off at each edge: twelve prisms of 2 x 2 / 2 mm^2 over 96 mm, eight corners of 2^3 * 5/6
  // mm^3.
  const double expected = 1e6 - 12 * 0.5 * 4 * 96 - 8 * 8 * 5.0 / 6;
  EXPECT_NEAR(volume(fine) * 1e9, expected, 1);
  EXPECT_EQ(box_mesh({0.1, 0.1, 0.1}, Detail::coarse).indices.size(), 3U * 12);
}

class MeshFile : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) {
    const std::string path = (std::filesystem::temp_directory_path() /
                              ("kaz_mesh_test_" + std::to_string(getpid()) + name))
                                 .string();
    std::ofstream(path, std::ios::binary) << bytes;
    written_.push_back(path);
    return path;
  }
  void TearDown() override {
    for (const std::string& path : written_) std::filesystem::remove(path);
  }

 private:
  std::vector<std::string> written_;
};

TEST_F(MeshFile, ReadsObj) {
  const std::string path =
      write(".obj",
            "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
            "f 1 3 2\nf 1/1 2/2 4/3\nf 1//1 4//1 3//1\nf -3 -2 -1\nvn 0 0 1\n");
  // The third face names a normal that does not exist yet.
  EXPECT_FALSE(load_mesh(path, {1, 1, 1}));
  const std::string good = write("2.obj",
                                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/2 4/3\n"
                                 "f 1 4 3\nf -3 -2 -1\n");
  const Result<Mesh> mesh = load_mesh(good, {0.1, 0.1, 0.2});
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_TRUE(closed(*mesh));
  EXPECT_NEAR(volume(*mesh), 0.1 * 0.1 * 0.2 / 6, 1e-9);
}

TEST_F(MeshFile, ReadsBothKindsOfStl) {
  const std::string text =
      "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid\n";
  const Result<Mesh> from_text = load_mesh(write("t.stl", text), {1, 1, 1});
  ASSERT_TRUE(from_text) << from_text.error().message;
  std::string binary(84 + 50, '\0');
  binary[80] = 1;
  const float corner[3] = {1, 0, 0}, corner2[3] = {0, 1, 0};
  std::memcpy(&binary[84 + 24], corner, sizeof corner);
  std::memcpy(&binary[84 + 36], corner2, sizeof corner2);
  const Result<Mesh> from_binary = load_mesh(write("b.stl", binary), {1, 1, 1});
  ASSERT_TRUE(from_binary) << from_binary.error().message;
  ASSERT_EQ(from_text->vertices.size(), 3U);
  ASSERT_EQ(from_binary->vertices.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(point(*from_text, i), point(*from_binary, i));
}

TEST_F(MeshFile, RefusesDamagedFiles) {
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"empty.stl", ""},
           {"empty.obj", ""},
           {"cut.stl", "solid t\nfacet\nvertex 0 0"},
           {"word.obj", "v 0 zero 0\n"},
           {"far.obj", "v 0 0 0\nf 1 2 3\n"},
           {"flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"},
           {"scene.dae", "<COLLADA/>"}, {"kind.ply", "ply"}}) {
    const std::string path = write(name, bytes);
    const Result<Mesh> mesh = load_mesh(path, {1, 1, 1});
    ASSERT_FALSE(mesh) << name;
    EXPECT_EQ(mesh.error().message.find(path), 0U) << mesh.error().message;
  }
}

TEST(Texture, LevelsHalveDownToOneTexelOfTheMeanLight) {
  for (const char* name : kTextureNames) {
    const Result<Texture> texture = make_texture(name);
    ASSERT_TRUE(texture) << name;
    EXPECT_EQ(texture->levels.size(), 10U);  // 512 = 2^9
    EXPECT_EQ(texture->levels.back().size(), 4U);
    double light = 0;
    for (std::size_t i = 0; i < texture->levels[0].size(); i += 4) {
      light += std::pow(texture->levels[0][i], 2);
    }
    light /= static_cast<double>(texture->levels[0].size()) / 4;
    // Nine roundings of at most half a code.
    EXPECT_NEAR(texture->levels.back()[0], std::sqrt(light), 4.5) << name;
  }
  EXPECT_FALSE(make_texture("marble"));
}

TEST(PackRgb, AveragesLight) {
  // Of four samples one white: a quarter of the light, half the code.
  std::vector<std::uint8_t> rgba(2 * 2 * 4, 0), rgb;
  rgba[0] = 255;
  pack_rgb(rgba, 2, 2, 2, rgb);
  EXPECT_EQ(rgb, (std::vector<std::uint8_t>{128, 0, 0}));
  pack_rgb(rgba, 2, 2, 1, rgb);
  EXPECT_EQ(rgb.size(), 12U);
  EXPECT_EQ(rgb[0], 255);
}

TEST(SceneModel, GroupsByFrameAndTextureInSmallPieces) {
  Scene scene;
  scene.frames = {"world", "body"};
  Visual box;
  box.shape.size = {0.1, 0.1, 0.1};
  for (int i = 0; i < 20; ++i) {
    box.name = "box" + std::to_string(i);
    box.frame = 1;
    scene.visuals.push_back(box);
  }
  box.frame = 0;
  scene.visuals.push_back(box);
  const Result<SceneModel> model = build_scene_model(scene);
  ASSERT_TRUE(model);
  std::uint32_t indices = 0;
  for (const Piece& piece : model->pieces) {
    EXPECT_LE(piece.fine_count, 3U * 600);
    indices += piece.fine_count;
  }
  EXPECT_EQ(indices, 21U * 3 * 44);
  EXPECT_EQ(model->pieces[1].coarse_count + model->pieces[2].coarse_count, 20U * 3 * 12);
  EXPECT_EQ(model->pieces.size(), 3U);  // 13 boxes, 7 boxes, and the one of the world
}

}  // namespace
}  // namespace kaz::sim
