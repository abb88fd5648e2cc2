// Writes the part of an MJCF file that Kaz uses, for libmujoco.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mjcf_compile.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>

#include "sim/body/description/mesh_file.h"
#include "sim/body/description/mjcf_elements.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

constexpr const char* kMjcfMainFile = "robot.xml";

// Binary STL with the vertices of the mesh file, without its normals.
std::string binary_stl(const MeshTriangles& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.corners.size() / 3);
  std::string bytes(80, '\0');
  const auto append = [&bytes](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  append(&count, sizeof count);
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    if (i % 3 == 0) bytes.append(3 * sizeof(float), '\0');
    const Eigen::Vector3f corner = mesh.corners[i].cast<float>();
    append(corner.data(), 3 * sizeof(float));
    if (i % 3 == 2) bytes.append(2, '\0');
  }
  return bytes;
}

class Rewriter {
 public:
  Rewriter(const Mjcf& mjcf, const ReadOptions& options)
      : mjcf_(mjcf), options_(options), objections_(mjcf.source.path()) {
    const char* stated = mjcf.source.setting("compiler", "inertiafromgeom");
    geoms_give_mass_ = stated != nullptr && std::string_view(stated) == "true";
  }

  Result<CompiledMjcf> run() {
    Element* root = element(mjcf_.source.root(), "mujoco");
    document_.InsertEndChild(root);
    Element* compiler = element(mjcf_.source.root(), "compiler");
    for (const char* off : {"convexhull", "usethread", "fusestatic", "discardvisual"})
      compiler->SetAttribute(off, "false");
    compiler->SetAttribute("autolimits", "true");
    root->InsertEndChild(compiler);
    children(mjcf_.source.root(), *root);
    KAZ_TRY(add_meshes(*root));
    KAZ_TRY(objections_.result());
    return compile();
  }

 private:
  // A new element with the place of `from`.
  Element* element(const Element& from, const char* name) {
    Element* to = document_.NewElement(name);
    to->SetUserData(from.GetUserData());
    return to;
  }

  // A new element with those attributes of `from` that libmujoco needs.
  Element* copy(const Element& from, const MjcfElement& known) {
    Element* to = element(from, from.Name());
    for (const tinyxml2::XMLAttribute* a = from.FirstAttribute(); a; a = a->Next())
      if (has_word(known.compiled, a->Name())) to->SetAttribute(a->Name(), a->Value());
    return to;
  }

  void children(const Element& from, Element& to) {
    const std::string parent = from.Name();
    for (const Element* e = from.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string name = e->Name();
      const MjcfElement* known = mjcf_element(parent, name);
      if (known == nullptr || known->use != Use::used) continue;
      if ((parent == "asset" && name == "mesh") || mjcf_is_mocap(*e)) continue;
      const bool in_body = parent == "body" || parent == "worldbody";
      if (in_body && name == "geom") {
        geom(*e, to, *known);
        continue;
      }
      Element* copied = copy(*e, *known);
      to.InsertEndChild(copied);
      if (in_body && name == "body") body(*e, *copied);
      if (in_body && e->Attribute("name") != nullptr && name.ends_with("joint"))
        out_.joints.emplace(e->Attribute("name"), e);
      children(*e, *copied);
    }
  }

  void body(const Element& e, Element& copied) {
    std::string name = e.Attribute("name") == nullptr ? "" : e.Attribute("name");
    if (name.empty()) {
      name = "body_" + std::to_string(out_.bodies.size() + 1);
      copied.SetAttribute("name", name.c_str());
    }
    out_.bodies.emplace(name, &e);
  }

  void geom(const Element& e, Element& to, const MjcfElement& known) {
    const std::string number = std::to_string(out_.geoms.size());
    out_.geoms.emplace("@" + number, &e);
    Element* copied = copy(e, known);
    copied->SetAttribute("name", ("@" + number).c_str());
    to.InsertEndChild(copied);
    const char* mesh = e.Attribute("mesh");
    const bool is_primitive = mjcf_mesh_of(mjcf_.source, e) == nullptr;
    if (is_primitive && (mesh == nullptr || fits(mesh))) return;
    const Element* parent = e.Parent()->ToElement();
    const bool gives_mass = std::string_view(parent->Name()) == "body" &&
                            (geoms_give_mass_ || !parent->FirstChildElement("inertial"));
    if (gives_mass && options_.body) keep_mesh(e, to, known, mesh, "%" + number);
    for (const char* other : {"mesh", "fitscale", "density", "fromto"}) copied->DeleteAttribute(other);
    copied->SetAttribute("type", "sphere");
    copied->SetAttribute("size", "0.001");
    copied->SetAttribute("shellinertia", "false");
    copied->SetAttribute("mass", gives_mass && !options_.body ? "1" : "0");
  }

  // Lets libmujoco fit a primitive to its mesh. Returns false if the mesh is missing.
  bool fits(const char* mesh) {
    const auto found = mjcf_.meshes.find(mesh);
    if (found == mjcf_.meshes.end() || found->second.path.empty()) return false;
    needed_.insert(found->first);
    return true;
  }

  void keep_mesh(const Element& e, Element& to, const MjcfElement& known, const char* mesh,
                 const std::string& name) {
    const auto found = mjcf_.meshes.find(mesh);
    if (found == mjcf_.meshes.end()) {
      MjcfSource::object(objections_, e,
                         "<geom> refers to mesh `" + std::string(mesh) +
                             "`, which does not exist; check the spelling");
    } else if (found->second.path.empty()) {
      MjcfSource::object(objections_, e,
                         "mesh `" + std::string(mesh) +
                             "` is missing, but gives the body its mass; give the "
                             "body an <inertial>");
    } else {
      Element* copied = copy(e, known);
      copied->SetAttribute("name", name.c_str());
      to.InsertEndChild(copied);
      needed_.insert(mesh);
    }
  }

  Result<void> add_meshes(Element& root) {
    Element* asset = element(mjcf_.source.root(), "asset");
    root.InsertEndChild(asset);
    for (const std::string& name : needed_) {
      const MjcfMesh& mesh = mjcf_.meshes.at(name);
      const auto triangles = KAZ_TRY(read_mesh(mesh.path, Eigen::Vector3d::Ones()));
      const std::string file = "m" + std::to_string(files_.size()) + ".stl";
      files_[file] = binary_stl(triangles);
      Element* e = element(mjcf_.source.root(), "mesh");
      e->SetAttribute("name", name.c_str());
      e->SetAttribute("file", file.c_str());
      char scale[128];
      std::snprintf(scale, sizeof scale, "%.17g %.17g %.17g", mesh.scale.x(), mesh.scale.y(),
                    mesh.scale.z());
      e->SetAttribute("scale", scale);
      asset->InsertEndChild(e);
    }
    return {};
  }

  Result<CompiledMjcf> compile() {
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    files_[kMjcfMainFile] = printer.CStr();
    auto model = compile_mujoco(files_, kMjcfMainFile);
    if (!model) return tl::unexpected(placed(model.error()));
    out_.model = std::move(*model);
    return std::move(out_);
  }

  // libmujoco's error as a sentence with the line of the file. It ends with "line = 4, column = -1" or
  // "line 4", which is a line of the rewritten file.
  Error placed(const Error& error) {
    if (error.fault != Fault::usage) return error;
    std::string text = error.message.substr(0, error.message.find('\n'));
    for (const char* prefix : {"Error: ", "XML Error: "})
      if (text.starts_with(prefix)) text.erase(0, std::strlen(prefix));
    if (const auto name = text.find(" in object '@"); name != text.npos) text.erase(name);
    const auto at = error.message.rfind("line ");
    const auto digit = at == std::string::npos ? at : error.message.find_first_of("0123456789", at);
    const int line = digit == std::string::npos ? 0 : std::atoi(error.message.c_str() + digit);
    tinyxml2::XMLDocument again;
    again.Parse(files_[kMjcfMainFile].c_str());
    const Element* e = at_line(document_.RootElement(), again.RootElement(), line);
    const MjcfOrigin& place = MjcfSource::origin(e == nullptr ? mjcf_.source.root() : *e);
    return {Fault::usage, place.path + ":" + std::to_string(place.line) + ": " +
                              (e == nullptr ? "" : mjcf_tag(*e) + ": ") + text +
                              " (libmujoco); correct the file"};
  }

  // The element whose twin is in this line. Both have the same shape.
  static const Element* at_line(const Element* e, const Element* twin, int line) {
    for (; e && twin; e = e->NextSiblingElement(), twin = twin->NextSiblingElement()) {
      if (twin->GetLineNum() == line) return e;
      if (const Element* found = at_line(e->FirstChildElement(), twin->FirstChildElement(), line))
        return found;
    }
    return nullptr;
  }

  const Mjcf& mjcf_;
  const ReadOptions& options_;
  Objections objections_;
  bool geoms_give_mass_ = false;
  tinyxml2::XMLDocument document_;
  std::map<std::string, std::string> files_;
  std::set<std::string> needed_;  // meshes
  CompiledMjcf out_;
};

}  // namespace

Result<CompiledMjcf> compile_mjcf(const Mjcf& mjcf, const ReadOptions& options) {
  return Rewriter(mjcf, options).run();
}

}  // namespace kaz::sim
