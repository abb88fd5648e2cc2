// COLLADA meshes: geometries, and the nodes that place them.
// SPDX-License-Identifier: Apache-2.0
//
// COLLADA - Digital Asset Schema Release 1.4.1 (Khronos Group, 2008).
#include "sim/body/description/collada.h"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxTriangles = 10'000'000;
constexpr double kFarthest = 1e9;  // of coordinates, as in other mesh files
constexpr int kMaxDepth = 100;     // of nodes

// All numbers in a text, separated by whitespace; nothing if something else stands there.
template <class T>
std::optional<std::vector<T>> list_of(const char* text) {
  std::vector<T> list;
  if (text == nullptr) return list;
  const char *at = text, *const end = text + std::string_view(text).size();
  while (true) {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r')) ++at;
    if (at == end) return list;
    T value{};
    const auto [next, status] = std::from_chars(at, end, value);
    if (status != std::errc()) return std::nullopt;
    list.push_back(value);
    at = next;
  }
}

// One <source>: vectors of three numbers.
struct Source {
  std::vector<double> numbers;
  std::size_t stride = 3;
  std::size_t size() const { return numbers.size() / stride; }
  Eigen::Vector3d at(std::size_t i) const {
    return {numbers[i * stride], numbers[i * stride + 1], numbers[i * stride + 2]};
  }
};

class Collada {
 public:
  Collada(const XmlFile& file, const Eigen::Vector3d& scale) : file_(file), scale_(scale) {}

  Result<MeshTriangles> read() {
    index(file_.root());
    double meter = 1;
    if (const Element* asset = file_.root().FirstChildElement("asset")) {
      if (const Element* unit = asset->FirstChildElement("unit"))
        meter = number_of(*unit, "meter", 1);
    }
    if (!(meter > 0 && meter <= 1000))
      return file_.error(file_.root(), "the unit of the file is not above 0 and at most 1000 m");
    const Element* scene = file_.root().FirstChildElement("scene");
    const Element* shown = scene == nullptr ? nullptr : scene->FirstChildElement();
    const Element* root = shown == nullptr ? nullptr : target(*shown, "url");
    if (root == nullptr)
      return file_.error(file_.root(), "has no visual scene; export the mesh again");
    const Eigen::Affine3d to_meters(Eigen::Scaling((meter * scale_).eval()));
    for (const Element* node = root->FirstChildElement("node"); node;
         node = node->NextSiblingElement("node"))
      KAZ_TRY(place(*node, to_meters, 0));
    return std::move(mesh_);
  }

 private:
  void index(const Element& e) {
    if (const char* id = e.Attribute("id")) by_id_.emplace(id, &e);
    for (const Element* child = e.FirstChildElement(); child; child = child->NextSiblingElement())
      index(*child);
  }

  // The element that a reference such as url="#mesh" names; null if it is not in this file.
  const Element* target(const Element& e, const char* attribute) const {
    const char* reference = e.Attribute(attribute);
    if (reference == nullptr || *reference != '#') return nullptr;
    const auto found = by_id_.find(reference + 1);
    return found == by_id_.end() ? nullptr : found->second;
  }

  Result<void> place(const Element& node, const Eigen::Affine3d& parent, int depth) {
    if (depth > kMaxDepth) return file_.error(node, "nodes are nested too deeply");
    Eigen::Affine3d at = parent;
    for (const Element* e = node.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind == "matrix" || kind == "translate" || kind == "rotate" || kind == "scale") {
        const auto step = KAZ_TRY(transform(*e, kind));
        at = at * step;
      } else if (kind == "instance_geometry") {
        const Element* geometry = target(*e, "url");
        if (geometry == nullptr) return file_.error(*e, "<instance_geometry> refers to nothing");
        if (const Element* mesh = geometry->FirstChildElement("mesh")) KAZ_TRY(add(*mesh, at));
      } else if (kind == "instance_node") {
        if (const Element* other = target(*e, "url")) KAZ_TRY(place(*other, at, depth + 1));
      } else if (kind == "node") {
        KAZ_TRY(place(*e, at, depth + 1));
      }
    }
    return {};
  }

  Result<Eigen::Affine3d> transform(const Element& e, const std::string& kind) const {
    const auto n = list_of<double>(e.GetText());
    const std::size_t count = kind == "matrix" ? 16 : kind == "rotate" ? 4 : 3;
    if (!n || n->size() != count)
      return file_.error(e, "<" + kind + "> must contain " + std::to_string(count) + " numbers");
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    if (kind == "matrix") {
      for (std::size_t i = 0; i < 12; ++i)
        out.matrix()(static_cast<int>(i / 4), static_cast<int>(i % 4)) = (*n)[i];
    } else {
      const Eigen::Vector3d v((*n)[0], (*n)[1], (*n)[2]);
      if (kind == "translate") out.translation() = v;
      if (kind == "scale") out.linear() = v.asDiagonal();
      if (kind == "rotate" && v.norm() > 0)
        out.linear() =
            Eigen::AngleAxisd((*n)[3] * std::numbers::pi / 180, v.normalized()).toRotationMatrix();
    }
    return out;
  }

  Result<Source> source_of(const Element& input) const {
    const Element* e = target(input, "source");
    if (e != nullptr && std::string(e->Name()) == "vertices") {
      for (const Element* inner = e->FirstChildElement("input"); inner;
           inner = inner->NextSiblingElement("input")) {
        if (inner->Attribute("semantic", "POSITION")) return source_of_array(*inner);
      }
    }
    return source_of_array(input);
  }

  Result<Source> source_of_array(const Element& input) const {
    const Element* e = target(input, "source");
    const Element* array = e == nullptr ? nullptr : e->FirstChildElement("float_array");
    if (array == nullptr) return file_.error(input, "<input> has no source with a <float_array>");
    const auto numbers = list_of<double>(array->GetText());
    if (!numbers) return file_.error(*array, "<float_array> contains something else than numbers");
    Source source{*numbers};
    if (const Element* common = e->FirstChildElement("technique_common")) {
      if (const Element* accessor = common->FirstChildElement("accessor"))
        source.stride = static_cast<std::size_t>(number_of(*accessor, "stride", 3));
    }
    if (source.stride < 3 || source.stride > 100)
      return file_.error(*e, "the stride of <accessor> must be from 3 to 100");
    return source;
  }

  Result<void> add(const Element& mesh, const Eigen::Affine3d& at) {
    for (const Element* e = mesh.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind == "triangles" || kind == "polylist" || kind == "polygons")
        KAZ_TRY(add_polygons(*e, kind, at));
    }
    return {};
  }

  Result<void> add_polygons(const Element& e, const std::string& kind, const Eigen::Affine3d& at) {
    Source positions;
    std::size_t offset = 0, stride = 1;
    bool found = false;
    for (const Element* input = e.FirstChildElement("input"); input;
         input = input->NextSiblingElement("input")) {
      const auto own =
          static_cast<std::size_t>(std::clamp(number_of(*input, "offset", 0), 0.0, 99.0));
      stride = std::max(stride, own + 1);
      if (!input->Attribute("semantic", "VERTEX")) continue;
      positions = KAZ_TRY(source_of(*input));
      offset = own;
      found = true;
    }
    if (!found) return file_.error(e, "<" + kind + "> has no <input> with the semantic VERTEX");
    std::optional<std::vector<unsigned>> counts;
    if (kind == "polylist") {
      const Element* vcount = e.FirstChildElement("vcount");
      counts = list_of<unsigned>(vcount == nullptr ? nullptr : vcount->GetText());
      if (!counts) return file_.error(e, "<vcount> contains something else than numbers");
    }
    for (const Element* p = e.FirstChildElement("p"); p; p = p->NextSiblingElement("p")) {
      const auto indices = list_of<unsigned>(p->GetText());
      if (!indices) return file_.error(*p, "<p> contains something else than indices");
      const std::size_t corners = indices->size() / stride;
      std::size_t first = 0;
      for (std::size_t polygon = 0; first < corners; ++polygon) {
        const std::size_t size = kind == "triangles"        ? 3
                                 : kind == "polygons"       ? corners
                                 : polygon < counts->size() ? (*counts)[polygon]
                                                            : 0;
        if (size < 3 || size > corners - first)
          return file_.error(*p, "<p> does not have as many indices as its polygons need");
        std::vector<Eigen::Vector3d> points;
        for (std::size_t k = first; k < first + size; ++k) {
          const std::size_t index = (*indices)[k * stride + offset];
          if (index >= positions.size())
            return file_.error(*p, "<p> contains the index " + std::to_string(index) +
                                       ", but there are " + std::to_string(positions.size()) +
                                       " vertices");
          points.push_back(at * positions.at(index));
        }
        KAZ_TRY(add_fan(*p, points));
        first += size;
      }
    }
    return {};
  }

  Result<void> add_fan(const Element& e, const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& p : points) {
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest)
        return file_.error(e, "a vertex is not finite or is beyond 1e9: check the unit");
    }
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const Eigen::Vector3d cross = (points[i] - points[0]).cross(points[i + 1] - points[0]);
      if (!(cross.norm() > 0)) continue;
      mesh_.corners.insert(mesh_.corners.end(), {points[0], points[i], points[i + 1]});
      mesh_.normals.insert(mesh_.normals.end(), 3, cross.normalized());
    }
    if (mesh_.corners.size() > 3 * kMaxTriangles)
      return file_.error(e, "the file has more than " + std::to_string(kMaxTriangles) +
                                " triangles; simplify the mesh");
    return {};
  }

  const XmlFile& file_;
  Eigen::Vector3d scale_;
  std::map<std::string, const Element*> by_id_;
  MeshTriangles mesh_;
};

}  // namespace

Result<MeshTriangles> read_collada(const std::string& path, const Eigen::Vector3d& scale) {
  const auto file = XmlFile::load(path, "COLLADA", kMaxBytes);
  if (!file) return tl::unexpected(file.error());
  return Collada(*file, scale).read();
}

}  // namespace kaz::sim
