// Collects errors and notes about one SDF file.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_report.h"

namespace kaz::sim {
namespace {

constexpr std::size_t kMaxSdfNotes = 10000;

// The link that contains an element: " (link `a` of model `b`)".
std::string place_of(const tinyxml2::XMLElement& at) {
  for (const tinyxml2::XMLElement* e = &at; e != nullptr;
       e = e->Parent() != nullptr ? e->Parent()->ToElement() : nullptr) {
    const char* link = std::string(e->Name()) == "link" ? e->Attribute("name") : nullptr;
    if (link == nullptr) continue;
    const tinyxml2::XMLElement* model = e->Parent() ? e->Parent()->ToElement() : nullptr;
    const char* of = model ? model->Attribute("name") : nullptr;
    return std::string(" (link `") + link + "`" +
           (of ? " of model `" + std::string(of) + "`" : "") + ")";
  }
  return "";
}

}  // namespace

void SdfReport::object(const tinyxml2::XMLElement& at, int line, const std::string& text) {
  objections_.add(line, text + place_of(at));
}

void SdfReport::spoil(const tinyxml2::XMLElement& at, const std::string& text) {
  object(at, text);
  distrust(at);
}

void SdfReport::note(const tinyxml2::XMLElement& at, const std::string& what) {
  if (notes_.size() < kMaxSdfNotes) notes_.push_back({line_of(at), what});
}

void SdfReport::note_default(const tinyxml2::XMLElement& at, const std::string& what) {
  if (notes_.size() < kMaxSdfNotes) notes_.push_back({line_of(at), what, true});
}

void SdfReport::object_to_notes() {
  for (const FileNote& note : notes_)
    objections_.add(
        note.line, note.what + (note.by_default ? ", which --strict does not permit; give the value"
                                                : " is not used, which --strict does not permit; "
                                                  "remove it"));
}

}  // namespace kaz::sim
