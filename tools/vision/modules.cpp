// The modules of vision by name: one table.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/modules.h"

#include <algorithm>
#include <memory>
#include <sstream>

#include "shared/base/one_line.hpp"
#include "vision/image/opencv_threads.h"

namespace kaz::tools {
namespace {

struct Kind {
  const char* name;
  std::unique_ptr<vision::Module> (*make)(const VisionOptions&);
};

// Each module comes after the modules that it needs.
constexpr Kind kKinds[] = {
    {"color", [](const VisionOptions& o) { return vision::make_color_module(o.ball); }},
    {"depth", [](const VisionOptions& o) { return vision::make_depth_module(o.depth); }},
    {"flow", [](const VisionOptions&) { return vision::make_flow_module({}); }},
    {"planes", [](const VisionOptions&) { return vision::make_planes_module({}); }},
    {"floor", [](const VisionOptions&) { return vision::make_floor_module({}); }},
    {"moving", [](const VisionOptions&) { return vision::make_independent_motion_module({}); }},
};

}  // namespace

std::string module_names() {
  std::string names;
  for (const Kind& kind : kKinds) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  return names;
}

Result<std::vector<std::string>> parse_modules(const std::string& list) {
  std::vector<std::string> wanted;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    word.erase(0, word.find_first_not_of(' '));
    word.erase(word.find_last_not_of(' ') + 1);
    if (std::ranges::find(wanted, word) != wanted.end())
      return fail(Fault::usage, "--modules " + shown_text(list) + " names '" + shown_text(word) +
                                    "' twice; name each module once");
    wanted.push_back(word);
  }
  if (wanted.empty()) wanted.emplace_back();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [&](const Kind& k) { return k.name == wanted[i]; });
    if (kind == std::end(kKinds))
      return fail(Fault::usage, "--modules '" + shown_text(wanted[i]) +
                                    "': unknown module; use one of " + module_names());
    const std::vector<std::string> needs = kind->make({})->needs();
    wanted.insert(wanted.end(), needs.begin(), needs.end());
  }
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    if (std::find(wanted.begin(), wanted.end(), kind.name) != wanted.end())
      names.emplace_back(kind.name);
  }
  return names;
}

Result<void> add_modules(const VisionOptions& options, vision::Pipeline& pipeline) {
  const auto names = KAZ_TRY(parse_modules(options.modules));
  vision::keep_opencv_on_callers_threads();
  for (const Kind& kind : kKinds) {
    if (std::find(names.begin(), names.end(), kind.name) == names.end()) continue;
    if (auto added = pipeline.add(kind.make(options)); !added) return added;
  }
  return {};
}

}  // namespace kaz::tools
