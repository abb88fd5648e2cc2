// The renderer's textures as files for the page.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/textures.h"

#include <nlohmann/json.hpp>

#include "shared/picture/png.h"
#include "sim/render/model/texture.h"

namespace kaz::viewer {
namespace {

Result<ServedFile> png_of(const sim::Texture& texture) {
  Bytes rgb;
  const Bytes& rgba = texture.levels.front();
  for (std::size_t i = 0; i < rgba.size(); i += 4)
    rgb.insert(rgb.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  // Level 1: noise compresses little, and the program starts sooner.
  return ServedFile{"image/png",
                    KAZ_TRY(picture::encode_png({texture.size, texture.size, 3, 8, rgb},
                                                {.level = 1, .filters = false}))};
}

}  // namespace

Result<std::map<std::string, ServedFile>> texture_files() {
  std::map<std::string, ServedFile> files;
  nlohmann::ordered_json periods = nlohmann::ordered_json::object();
  for (const std::string name : sim::kTextureNames) {
    const sim::Texture texture = KAZ_TRY(sim::make_texture(name));
    files["/textures/" + name + ".png"] = KAZ_TRY(png_of(texture));
    periods[name] = texture.repeat_m;
  }
  const std::string text = periods.dump();
  files["/textures.json"] = {"application/json", Bytes(text.begin(), text.end())};
  return files;
}

}  // namespace kaz::viewer
