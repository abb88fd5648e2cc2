// XML of an MJCF robot: the file and its includes as one document.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {

// Place of an element in the files.
struct MjcfOrigin {
  std::string path;
  int line = 0;
};

class MjcfSource {
 public:
  // Replaces each <include> by the elements of its file, as MuJoCo does. The path is relative to the folder
  // of the main file. A file is included once. Included files must be in the robot's package (mesh_path()).
  // Limits: 100 files, 16 MiB, 50,000 elements, 100 levels. Returns Fault::usage with all errors.
  static Result<MjcfSource> load(const XmlFile& file);

  const std::string& path() const { return path_; }
  const tinyxml2::XMLElement& root() const { return *document_->RootElement(); }
  // The place of an element of this document.
  static const MjcfOrigin& origin(const tinyxml2::XMLElement& e) {
    return *static_cast<const MjcfOrigin*>(e.GetUserData());
  }
  // Adds an objection, or returns a note, with the place of `e`.
  static void object(Objections& to, const tinyxml2::XMLElement& e, const std::string& text) {
    to.add(origin(e).path, origin(e).line, text);
  }
  FileNote note(const tinyxml2::XMLElement& e, const std::string& what) const;

  // Returns the value of an attribute of `e`, or of its default class; null if neither states it.
  const char* value(const tinyxml2::XMLElement& e, const char* attribute) const;
  // Returns the value in the last element `section` of the root that states the attribute, or null.
  const char* setting(const char* section, const char* attribute) const;

 private:
  struct Class {
    std::string parent;
    std::vector<const tinyxml2::XMLElement*> sections;  // <default>
  };
  class Includes;
  void read_classes(const tinyxml2::XMLElement& section, const std::string& parent);

  std::string path_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
  std::shared_ptr<std::deque<MjcfOrigin>> origins_;
  std::map<std::string, Class> classes_;
};

// "<joint>"
std::string mjcf_tag(const tinyxml2::XMLElement& e);
// "joint `x`" or, without a name, "<joint>".
std::string mjcf_name(const tinyxml2::XMLElement& e);

}  // namespace kaz::sim
