// Validates a world file before the parser reads it, so that errors have a line number.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_check.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <vector>

#include "sim/body/description/rigid_link.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

using Element = tinyxml2::XMLElement;

// Allowed child elements. Some names occur in several places, so keys are the ends of paths.
const std::map<std::string, std::set<std::string>> kChildren{
    {"sdf", {"world"}},
    {"world", {"gravity", "model", "kaz:light", "kaz:robot"}},
    {"kaz:robot", {"kaz:push"}},
    {"model", {"static", "pose", "link", "kaz:kick"}},
    {"link", {"pose", "inertial", "visual", "collision"}},
    {"inertial", {"mass", "pose", "inertia"}},
    {"inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}},
    {"visual", {"pose", "geometry", "material", "kaz:texture"}},
    {"collision", {"pose", "geometry", "surface"}},
    {"geometry", {"box", "capsule", "cylinder", "plane", "sphere"}},
    {"box", {"size"}},
    {"capsule", {"radius", "length"}},
    {"cylinder", {"radius", "length"}},
    {"plane", {"normal", "size"}},
    {"sphere", {"radius"}},
    {"material", {"ambient", "diffuse", "specular"}},
    {"surface", {"friction", "bounce", "contact", "kaz:rolling_resistance"}},
    {"friction", {"ode"}},
    {"friction/ode", {"mu"}},
    {"bounce", {"restitution_coefficient", "threshold"}},
    {"contact", {"ode"}},
    {"contact/ode", {"soft_cfm"}},
};

// Required children, for which SDF would silently use defaults: a sphere of 1 m, a nameless part.
const std::map<std::string, std::set<std::string>> kNeeded{
    {"box", {"size"}},
    {"capsule", {"radius", "length"}},
    {"cylinder", {"radius", "length"}},
    {"plane", {"size"}},
    {"sphere", {"radius"}},
    {"inertial", {"mass", "inertia"}},
};
// All others stand once where they stand.
const std::set<std::string> kRepeated{"model",     "link",     "visual",
                                      "collision", "kaz:kick", "kaz:push"};
const std::set<std::string> kNamed{"world", "model", "link", "visual", "collision"};

// Maximum of all numbers, so that products of a few of them do not overflow.
constexpr double kLargest = 1e300;

// Bounds against wrong units, and against numbers with which a step of the dynamics makes no sense.
constexpr double kMaxPose = 100;      // m, and rad
constexpr double kMaxGravity = 50;    // m/s^2; Jupiter has 25
constexpr double kMaxKick = 100;      // m/s
constexpr double kMaxKickTime = 1e6;  // s
constexpr double kMaxPush = 5;        // N s, as by hand
constexpr double kMinMass = 1e-9;     // kg
constexpr double kMaxMoment = 1e9;    // kg m^2

// Elements whose text is numbers: how many, and their bounds.
struct Numbers {
  std::size_t count;
  double min = -kLargest;
  double max = kLargest;
  const char* unit = "";
};
const std::map<std::string, Numbers> kNumbers{
    {"gravity", {3, -kMaxGravity, kMaxGravity, " m/s2"}},
    {"pose", {6, -kMaxPose, kMaxPose, " (m, rad)"}},
    {"mass", {1, 0, 1e4}},
    {"ixx", {1, -kMaxMoment, kMaxMoment, " kg m2"}},
    {"ixy", {1, -kMaxMoment, kMaxMoment, " kg m2"}},
    {"ixz", {1, -kMaxMoment, kMaxMoment, " kg m2"}},
    {"iyy", {1, -kMaxMoment, kMaxMoment, " kg m2"}},
    {"iyz", {1, -kMaxMoment, kMaxMoment, " kg m2"}},
    {"izz", {1, -kMaxMoment, kMaxMoment, " kg m2"}},
    {"radius", {1, 1e-6, 1e3}},
    {"length", {1, 1e-6, 1e3}},
    {"box/size", {3, 1e-6, 1e3}},
    {"plane/size", {2, 1e-6, 1e3}},
    {"normal", {3}},
    {"ambient", {4, 0, 1}},
    {"diffuse", {4, 0, 1}},
    {"specular", {4, 0, 1}},
    {"mu", {1, 0}},
    {"soft_cfm", {1, 0}},
    {"restitution_coefficient", {1, 0, 1}},
    {"threshold", {1, 0}},
};

// Our own elements: numeric attributes.
struct OwnAttribute {
  const char* element;
  const char* attribute;
  Numbers numbers;
};
const OwnAttribute kOwn[] = {
    {"kaz:robot", "pose", {6, -kMaxPose, kMaxPose, " (m, rad)"}},
    {"kaz:light", "to_lamp", {3}},
    {"kaz:light", "lamp", {1, 0, 10}},
    {"kaz:light", "shade", {1, 0, 10}},
    {"kaz:kick", "time", {1, 0, kMaxKickTime, " s"}},
    {"kaz:kick", "velocity", {3, -kMaxKick, kMaxKick, " m/s"}},
    {"kaz:push", "time", {1, 0, kMaxKickTime, " s"}},
    {"kaz:push", "impulse", {3, -kMaxPush, kMaxPush, " N s"}},
    {"kaz:rolling_resistance", "metres", {1, 0}},
};

// The parser's time grows with the square of their number.
constexpr std::size_t kMaxModels = 500;

const std::set<std::string> kTextures{"checker", "wood", "carpet"};

// Name of an element in the tables: of <ode> in <contact> contact/ode.
template <class Table>
auto look_up(const Table& table, const Element& element) {
  const std::string name = element.Name();
  const auto plain = table.find(name);
  if (plain != table.end() || element.Parent()->ToElement() == nullptr) return plain;
  return table.find(element.Parent()->ToElement()->Name() + ("/" + name));
}

bool fits(const std::optional<std::vector<double>>& values, const Numbers& wanted) {
  if (!values) return false;
  for (const double value : *values) {
    if (value < wanted.min || value > wanted.max) return false;
  }
  return true;
}

std::string describe(const Numbers& wanted) {
  std::string text = std::to_string(wanted.count);
  text += wanted.count == 1 ? " number" : " numbers";
  if (wanted.max == 1) return text + " from 0 to 1";
  if (wanted.min < 0 && wanted.max < kLargest) {
    char range[80];
    std::snprintf(range, sizeof range, " from %g to %g%s", wanted.min, wanted.max, wanted.unit);
    return text + range;
  }
  char max[40] = "";
  if (wanted.max < kLargest || wanted.min >= 0)
    std::snprintf(max, sizeof max, " and at most %g", wanted.max);
  if (wanted.min == 0) return text + " not below 0" + max + wanted.unit;
  if (wanted.min > 0) return text + " above 0" + max + wanted.unit;
  return text;
}

class Check {
 public:
  explicit Check(const XmlFile& file) : file_(file) {}

  Result<void> run() {
    if (file_.root().Attribute("version") == nullptr)
      return error(file_.root(), "<sdf> lacks version=\"1.9\"");
    const std::string version = file_.root().Attribute("version");
    if (version.size() != 3 || version[0] != '1' || version[1] != '.' || version[2] < '0' ||
        version[2] > '9') {
      return error(file_.root(), "SDF version \"" + version +
                                     "\" is not supported; the newest supported version is 1.9");
    }
    if (auto ok = check(file_.root()); !ok) return ok;
    const Element* world = file_.root().FirstChildElement("world");
    if (world == nullptr) return error(file_.root(), "<sdf> must contain one <world>");
    std::size_t models = 0;
    for (auto* e = world->FirstChildElement("model"); e; e = e->NextSiblingElement("model")) {
      if (++models > kMaxModels)
        return error(*e, "<world> has more than " + std::to_string(kMaxModels) + " models");
      if (auto ok = check_model(*e); !ok) return ok;
    }
    return {};
  }

 private:
  Result<void> check(const Element& element) {
    if (auto ok = check_values(element); !ok) return ok;
    const auto allowed = look_up(kChildren, element);
    std::set<std::string> names;
    for (const Element* e = element.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string name = e->Name();
      if (allowed == kChildren.end() || !allowed->second.count(name)) {
        std::string known = "nothing";
        if (allowed != kChildren.end()) {
          known.clear();
          for (const std::string& k : allowed->second) {
            if (!known.empty()) known += ", ";
            known += k;
          }
        }
        return error(*e, "unknown element <" + name + "> in <" + element.Name() +
                             ">, which accepts " + known);
      }
      if (const Element* again = e->NextSiblingElement(e->Name());
          again != nullptr && !kRepeated.count(name)) {
        return error(*again, "<" + name + "> occurs twice in <" + element.Name() + ">; remove one");
      }
      if (const char* own_name = e->Attribute("name");
          own_name != nullptr && !names.insert(name + " " + own_name).second) {
        return error(*e, name + " `" + own_name + "` is already defined above; rename it");
      }
      if (auto ok = check(*e); !ok) return ok;
    }
    if (const auto needed = kNeeded.find(element.Name()); needed != kNeeded.end()) {
      for (const std::string& child : needed->second) {
        if (element.FirstChildElement(child.c_str()) == nullptr) {
          return error(element, std::string("<") + element.Name() + "> lacks <" + child + ">");
        }
      }
    }
    return {};
  }

  Result<void> check_values(const Element& element) {
    const std::string name = element.Name();
    if (const auto numbers = look_up(kNumbers, element); numbers != kNumbers.end()) {
      const char* text = element.GetText();
      if (!fits(parse_numbers(text ? text : "", numbers->second.count), numbers->second)) {
        return error(element, "<" + name + "> must contain " + describe(numbers->second) +
                                  ", not \"" + (text ? text : "") + "\"");
      }
    }
    KAZ_TRY(file_.check_name(element));
    if (look_up(kChildren, element) != kChildren.end()) KAZ_TRY(file_.check_no_text(element));
    if (kNamed.count(name) && element.Attribute("name") == nullptr) {
      return error(element, "<" + name + "> lacks the attribute `name`");
    }
    if (element.Attribute("relative_to") != nullptr) {
      return error(element, "`relative_to` is not supported; give the pose in the parent's frame");
    }
    for (const OwnAttribute& own : kOwn) {
      if (name != own.element) continue;
      const char* text = element.Attribute(own.attribute);
      if (!fits(parse_numbers(text ? text : "", own.numbers.count), own.numbers)) {
        return error(element, "<" + name + "> needs the attribute `" + own.attribute + "` with " +
                                  describe(own.numbers));
      }
    }
    if (name == "static") {
      bool fixed = false;
      if (element.QueryBoolText(&fixed) != tinyxml2::XML_SUCCESS) {
        return error(element, "<static> must be true or false");
      }
    }
    if (name == "visual" || name == "collision") {
      const Element* geometry = element.FirstChildElement("geometry");
      const Element* shape = geometry ? geometry->FirstChildElement() : nullptr;
      if (shape == nullptr || shape->NextSiblingElement() != nullptr ||
          geometry->NextSiblingElement("geometry") != nullptr) {
        return error(element, "<" + name + "> must contain one <geometry> with one shape");
      }
    }
    if (name ==
        "kaz:light") {  // the renderer's limit: shadows of a lower lamp are too long for its map
      const auto to = parse_numbers(element.Attribute("to_lamp"), 3).value();
      if (!(to[2] > 0.05 * std::hypot(to[0], to[1], to[2])))
        return error(element, "<kaz:light> needs a lamp 3 degrees or more above the floor");
    }
    if (name == "kaz:push" && element.Attribute("link") == nullptr)
      return error(element,
                   "<kaz:push> needs the attribute `link`: a link of the robot, such as trunk");
    if (name == "kaz:texture") {
      const char* texture = element.Attribute("name");
      if (texture == nullptr || !kTextures.count(texture)) {
        return error(element, "<kaz:texture> needs a `name` of checker, wood or carpet");
      }
    }
    return {};
  }

  Result<void> check_model(const Element& model) {
    const std::string name = model.Attribute("name");
    const Element* fixed = model.FirstChildElement("static");
    if (fixed != nullptr && fixed->BoolText(false)) {
      if (const Element* kick = model.FirstChildElement("kaz:kick")) {
        return error(*kick, "model `" + name + "` is static, so <kaz:kick> cannot move it");
      }
      return {};
    }
    for (auto* link = model.FirstChildElement("link"); link;
         link = link->NextSiblingElement("link")) {
      if (auto ok = check_inertial(*link); !ok) return ok;
      for (auto* c = link->FirstChildElement("collision"); c;
           c = c->NextSiblingElement("collision")) {
        const Element* geometry = c->FirstChildElement("geometry");
        if (geometry != nullptr && geometry->FirstChildElement("plane") != nullptr) {
          return error(*geometry, "a plane collides only as part of a static model");
        }
      }
    }
    return {};
  }

  // SDF's default for a link without <inertial> is 1 kg, which is wrong for any ball: it must be explicit.
  Result<void> check_inertial(const Element& link) {
    const Element* inertial = link.FirstChildElement("inertial");
    if (inertial == nullptr) {
      return error(link,
                   "a link that can move lacks <inertial>; add it, or make the model "
                   "<static>true</static>");
    }
    const Element* mass = inertial->FirstChildElement("mass");
    const Element* inertia = inertial->FirstChildElement("inertia");
    const auto of = [&](const char* moment, double otherwise) {
      const Element* e = inertia->FirstChildElement(moment);
      return e ? e->DoubleText() : otherwise;
    };
    const double kilograms = mass->DoubleText();
    if (kilograms > 0 && kilograms < kMinMass)
      return error(*mass, std::string("a mass of ") + mass->GetText() +
                              " kg; a movable body must have 1e-9 to 10000 kg");
    Eigen::Matrix3d tensor;                              // with the defaults of SDF
    tensor << of("ixx", 1), of("ixy", 0), of("ixz", 0),  //
        of("ixy", 0), of("iyy", 1), of("iyz", 0),        //
        of("ixz", 0), of("iyz", 0), of("izz", 1);
    if (!physical(kilograms, tensor)) {
      return error(*inertia,
                   "impossible mass or inertia: mass and principal moments must be above 0, and no "
                   "principal moment may exceed the sum of the other two");
    }
    return {};
  }

  // With the link that it is about.
  tl::unexpected<Error> error(const Element& at, const std::string& message) const {
    for (const Element* e = &at; e != nullptr;
         e = e->Parent() != nullptr ? e->Parent()->ToElement() : nullptr) {
      const char* link = std::string(e->Name()) == "link" ? e->Attribute("name") : nullptr;
      const Element* model = link && e->Parent() ? e->Parent()->ToElement() : nullptr;
      const char* of = model ? model->Attribute("name") : nullptr;
      if (link == nullptr) continue;
      return file_.error(at, message + " (link `" + link + "`" +
                                 (of ? " of model `" + std::string(of) + "`" : "") + ")");
    }
    return file_.error(at, message);
  }

  const XmlFile& file_;
};

}  // namespace

Result<void> check_sdf(const std::string& path) {
  const Result<XmlFile> file = XmlFile::load(path, "sdf");
  if (!file) return tl::unexpected(file.error());
  return Check(*file).run();
}

}  // namespace kaz::sim
