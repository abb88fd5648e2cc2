// XML of an MJCF robot: includes and default classes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/mjcf_source.h"

#include "sim/body/description/mesh_check.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

constexpr std::size_t kMaxMjcfFiles = 100, kMaxMjcfBytes = 16 << 20, kMaxMjcfElements = 50'000;
constexpr int kMaxMjcfLevels = 100;
constexpr const char* kMjcfMainClass = "main";

}  // namespace

std::string mjcf_tag(const Element& e) {
  return std::string("<") + e.Name() + ">";
}

std::string mjcf_name(const Element& e) {
  const char* name = e.Attribute("name");
  return name == nullptr ? mjcf_tag(e) : std::string(e.Name()) + " `" + name + "`";
}

// Copies the file and its includes into one document.
class MjcfSource::Includes {
 public:
  Includes(MjcfSource& out, const XmlFile& file) : out_(out), objections_(file.path()) {
    files_.insert(mesh_path(file.path(), file.path()).value_or(file.path()));
  }

  Result<void> read(const XmlFile& file) {
    bytes_ = file.text().size();
    if (Element* root = copy(file.root(), file.path(), 0)) {
      out_.document_->InsertEndChild(root);
      children(file.root(), *root, file.path(), 1);
    }
    return objections_.result();
  }

 private:
  Element* copy(const Element& e, const std::string& path, int level) {
    if (++elements_ > kMaxMjcfElements || level > kMaxMjcfLevels) {
      if (!full_)
        objections_.add(path, e.GetLineNum(),
                        "the file has more than 50000 elements or 100 levels; remove some");
      full_ = true;
      return nullptr;
    }
    Element* to = out_.document_->NewElement(e.Name());
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next())
      to->SetAttribute(a->Name(), a->Value());
    out_.origins_->push_back({path, e.GetLineNum()});
    to->SetUserData(&out_.origins_->back());
    return to;
  }

  void children(const Element& e, Element& to, const std::string& path, int level) {
    for (const tinyxml2::XMLNode* node = e.FirstChild(); node; node = node->NextSibling()) {
      if (node->ToText() != nullptr)
        objections_.add(
            path, node->GetLineNum(),
            "text in " + mjcf_tag(e) + ", which accepts only elements; remove the text");
      const Element* child = node->ToElement();
      if (child == nullptr || full_) continue;
      if (std::string(child->Name()) == "include") {
        include(*child, to, path, level);
      } else if (Element* copied = copy(*child, path, level)) {
        to.InsertEndChild(copied);
        children(*child, *copied, path, level + 1);
      }
    }
  }

  void include(const Element& e, Element& to, const std::string& path, int level) {
    const auto object = [&](const std::string& text) {
      objections_.add(path, e.GetLineNum(), text);
    };
    const char* name = e.Attribute("file");
    if (name == nullptr) return object("<include> lacks the attribute `file`");
    const std::string what = std::string("included file `") + name + "` ";
    const auto found = mesh_path(out_.path_, name);
    if (!found) return object(what + found.error().message);
    if (!files_.insert(*found).second)
      return object(what + "is already part of this robot; remove the <include>");
    if (files_.size() > kMaxMjcfFiles)
      return object(what + "is one too many; the maximum is 100 files");
    const auto file = XmlFile::load(*found, "", kMaxMjcfBytes);
    if (!file) return object(what + "cannot be used: " + file.error().message);
    bytes_ += file->text().size();
    if (bytes_ > kMaxMjcfBytes) return object(what + "exceeds the maximum of 16 MiB for all files");
    children(file->root(), to, *found, level);
  }

  MjcfSource& out_;
  Objections objections_;
  std::set<std::string> files_;
  std::size_t bytes_ = 0, elements_ = 0;
  bool full_ = false;
};

Result<MjcfSource> MjcfSource::load(const XmlFile& file) {
  MjcfSource source;
  source.path_ = file.path();
  source.document_ = std::make_unique<tinyxml2::XMLDocument>();
  source.origins_ = std::make_shared<std::deque<MjcfOrigin>>();
  KAZ_TRY(Includes(source, file).read(file));
  for (const Element* e = source.root().FirstChildElement("default"); e;
       e = e->NextSiblingElement("default"))
    source.read_classes(*e, "");
  return source;
}

FileNote MjcfSource::note(const Element& e, const std::string& what) const {
  const MjcfOrigin& at = origin(e);
  return {.line = at.line, .what = what, .path = at.path == path_ ? std::string() : at.path};
}

void MjcfSource::read_classes(const Element& section, const std::string& parent) {
  const char* stated = section.Attribute("class");
  const std::string name = stated == nullptr ? kMjcfMainClass : stated;
  Class& one = classes_[name];
  one.parent = parent;
  one.sections.push_back(&section);
  for (const Element* e = section.FirstChildElement("default"); e;
       e = e->NextSiblingElement("default"))
    read_classes(*e, name);
}

const char* MjcfSource::value(const Element& e, const char* attribute) const {
  if (const char* own = e.Attribute(attribute)) return own;
  const char* stated = e.Attribute("class");
  for (const tinyxml2::XMLNode* at = e.Parent(); stated == nullptr && at; at = at->Parent()) {
    if (at->ToElement() != nullptr) stated = at->ToElement()->Attribute("childclass");
  }
  std::string name = stated == nullptr ? kMjcfMainClass : stated;
  for (std::size_t steps = 0; steps <= classes_.size(); ++steps) {
    const auto found = classes_.find(name);
    if (found == classes_.end()) return nullptr;
    const char* value = nullptr;
    for (const Element* section : found->second.sections) {
      for (const Element* one = section->FirstChildElement(e.Name()); one;
           one = one->NextSiblingElement(e.Name()))
        if (const char* stated_here = one->Attribute(attribute)) value = stated_here;
    }
    if (value != nullptr) return value;
    name = found->second.parent;
  }
  return nullptr;
}

const char* MjcfSource::setting(const char* section, const char* attribute) const {
  const char* value = nullptr;
  for (const Element* e = root().FirstChildElement(section); e; e = e->NextSiblingElement(section))
    if (const char* stated = e->Attribute(attribute)) value = stated;
  return value;
}

}  // namespace kaz::sim
