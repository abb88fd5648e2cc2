// Errors and notes about one SDF file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <tinyxml2.h>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"

namespace kaz::sim {

class SdfReport {
 public:
  // `include_line`: line of the world file that includes this file, or 0 for the world file. `notes` are the
  // notes of the world file and must exist as long as this object.
  SdfReport(std::string path, int include_line, std::vector<FileNote>& notes)
      : objections_(std::move(path)), notes_(notes), include_line_(include_line) {}

  // Adds an error. The text is completed by the link that contains the element.
  void object(const tinyxml2::XMLElement& at, const std::string& text) {
    object(at, at.GetLineNum(), text);
  }
  void object(const tinyxml2::XMLElement& at, int line, const std::string& text);
  // Adds an error about an element that later checks leave out.
  void spoil(const tinyxml2::XMLElement& at, const std::string& text);
  // Later checks leave the element out.
  void distrust(const tinyxml2::XMLElement& element) { spoiled_.insert(&element); }
  bool sound(const tinyxml2::XMLElement& element) const { return !spoiled_.contains(&element); }

  // Adds a note about an element that is not used. Only the first 10,000 are kept.
  void note(const tinyxml2::XMLElement& at, const std::string& what);
  // Adds a note about a value that the file does not state.
  void note_default(const tinyxml2::XMLElement& at, const std::string& what);
  // Makes each note an error, for ReadOptions::strict.
  void object_to_notes();

  // Returns the line of the world file that belongs to an element.
  int line_of(const tinyxml2::XMLElement& at) const {
    return include_line_ > 0 ? include_line_ : at.GetLineNum();
  }
  Result<void> result() const { return objections_.result(); }

 private:
  Objections objections_;
  std::vector<FileNote>& notes_;
  std::set<const tinyxml2::XMLElement*> spoiled_;
  int include_line_;
};

}  // namespace kaz::sim
