// Search path of models and meshes of a world.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_include.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "sim/body/description/mesh_check.h"
#include "sim/body/description/sdf_check.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

namespace sdf_fs = std::filesystem;

constexpr const char* kModelVariables[] = {"GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH"};

tl::unexpected<Error> not_found() {
  return fail(Fault::usage,
              "was not found: add the folder that contains it to GZ_SIM_RESOURCE_PATH");
}

}  // namespace

ModelPath::ModelPath(const std::string& world_path) {
  const auto add = [this](const sdf_fs::path& folder) {
    std::error_code error;
    const sdf_fs::path path = sdf_fs::canonical(folder, error);
    if (!error) folders_.push_back(path);
  };
  const sdf_fs::path own = sdf_fs::absolute(world_path).parent_path();
  add(own);
  add(own / "models");
  for (const char* variable : kModelVariables) {
    for (const sdf_fs::path& folder : listed_folders(variable)) folders_.push_back(folder);
  }
}

Result<std::string> ModelPath::permitted(const sdf_fs::path& path) const {
  std::error_code error;
  const sdf_fs::path real = sdf_fs::canonical(path, error);
  if (error) return not_found();
  const auto holds = [&real](const sdf_fs::path& folder) { return is_inside(real, folder); };
  if (std::ranges::any_of(folders_, holds)) return real.string();
  return fail(Fault::usage, "is " + real.string() +
                                ", which is outside of the world's folder: copy it there, or add "
                                "its folder to GZ_SIM_RESOURCE_PATH");
}

Result<std::string> ModelPath::find(const std::string& file, const std::string& uri) const {
  const auto scheme = uri.find("://");
  const std::string kind = scheme == uri.npos ? "" : uri.substr(0, scheme);
  const std::string rest = scheme == uri.npos ? uri : uri.substr(scheme + 3);
  if (kind == "http" || kind == "https" || kind == "fuel")
    return fail(Fault::usage,
                "is on a server, which Kaz does not contact: download the model, and add the "
                "folder that contains it to GZ_SIM_RESOURCE_PATH");
  if (!kind.empty() && kind != "model" && kind != "file")
    return fail(Fault::usage, "has a URI of the unsupported kind " + kind +
                                  "://; use model://NAME or a relative path");
  if (rest.empty()) return fail(Fault::usage, "is empty; give model://NAME or a relative path");
  const sdf_fs::path relative = rest;
  std::error_code ignored;
  if (kind != "model") {
    const sdf_fs::path beside = sdf_fs::absolute(file).parent_path() / relative;
    if (sdf_fs::exists(beside, ignored)) return permitted(beside);
  }
  if (relative.is_absolute()) return not_found();
  for (const sdf_fs::path& folder : folders_) {
    if (sdf_fs::exists(folder / relative, ignored)) return permitted(folder / relative);
  }
  return not_found();
}

Result<std::string> ModelPath::model_file(const std::string& path) const {
  std::error_code ignored;
  if (!sdf_fs::is_directory(path, ignored)) return path;
  const auto config = XmlFile::load(sdf_fs::path(path) / "model.config", "model");
  if (!config)
    return fail(Fault::usage, "is a folder without a valid model.config (" +
                                  config.error().message + "); give the path of an SDF file");
  int newest = -1;
  std::string name;
  for (const auto* e = config->root().FirstChildElement("sdf"); e != nullptr;
       e = e->NextSiblingElement("sdf")) {
    const char* version = e->Attribute("version");
    const int minor = sdf_minor_version(version == nullptr ? "1.0" : version).value_or(-1);
    if (minor <= newest || e->GetText() == nullptr) continue;
    newest = minor;
    name = e->GetText();
  }
  if (name.empty())
    return fail(Fault::usage, "has a model.config without an <sdf> of a supported version");
  return permitted(sdf_fs::path(path) / name);
}

}  // namespace kaz::sim
