// Checks numbers of SDF elements before the parser reads them, so that errors have a line number.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <vector>

#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

using SdfXml = tinyxml2::XMLElement;

// Maximum of all numbers, so that products of a few of them do not overflow.
constexpr double kLargestNumber = 1e300;

// Bounds against wrong units, and against numbers with which a step of the dynamics makes no sense.
constexpr double kMaxPose = 1000;     // m, and rad
constexpr double kMaxStart = 100;     // m, and rad
constexpr double kMaxGravity = 50;    // m/s^2; Jupiter has 25
constexpr double kMaxKick = 100;      // m/s
constexpr double kMaxKickTime = 1e6;  // s
constexpr double kMaxPush = 5;        // N s, as by hand
constexpr double kMaxMoment = 1e9;    // kg m^2
constexpr double kNoLimit = 1e16;     // SDF's default of limits

struct Range {
  std::size_t count;
  double min = -kLargestNumber;
  double max = kLargestNumber;
  const char* unit = "";
};

// Elements whose text is numbers. Without a parent: in each parent.
struct RangeOf {
  const char* parent;
  const char* element;
  Range range;
};
constexpr Range kMoment{1, -kMaxMoment, kMaxMoment, " kg m2"};
constexpr RangeOf kRanges[] = {
    {"", "gravity", {3, -kMaxGravity, kMaxGravity, " m/s2"}},
    {"", "mass", {1, 0, 1e4}},
    {"", "ixx", kMoment},
    {"", "ixy", kMoment},
    {"", "ixz", kMoment},
    {"", "iyy", kMoment},
    {"", "iyz", kMoment},
    {"", "izz", kMoment},
    {"", "radius", {1, 1e-6, 1e3}},
    {"", "length", {1, 1e-6, 1e3}},
    {"box", "size", {3, 1e-6, 1e3}},
    {"plane", "size", {2, 1e-6, 1e6}},
    {"", "normal", {3}},
    {"", "scale", {3, -1e6, 1e6}},
    {"", "diffuse", {4, 0, 1}},
    {"", "mu", {1, 0}},
    {"", "mu2", {1, 0}},
    {"", "soft_cfm", {1, 0}},
    {"", "restitution_coefficient", {1, 0, 1}},
    {"", "threshold", {1, 0}},
    {"", "direction", {3}},
    {"", "xyz", {3, -1e6, 1e6}},
    {"", "damping", {1, 0, 1e6}},
    {"dynamics", "friction", {1, 0, 1e6}},
};

// Attributes of Kaz's own elements.
struct OwnAttribute {
  const char* element;
  const char* attribute;
  Range range;
};
constexpr OwnAttribute kOwn[] = {
    {"kaz:robot", "pose", {6, -kMaxStart, kMaxStart, " (m, rad)"}},
    {"kaz:light", "to_lamp", {3}},
    {"kaz:light", "lamp", {1, 0, 10}},
    {"kaz:light", "shade", {1, 0, 10}},
    {"kaz:kick", "time", {1, 0, kMaxKickTime, " s"}},
    {"kaz:kick", "velocity", {3, -kMaxKick, kMaxKick, " m/s"}},
    {"kaz:push", "time", {1, 0, kMaxKickTime, " s"}},
    {"kaz:push", "impulse", {3, -kMaxPush, kMaxPush, " N s"}},
    {"kaz:rolling_resistance", "metres", {1, 0}},
};

constexpr const char* kTruths[] = {"static", "use_parent_model_frame"};
constexpr const char* kTexts[] = {"parent", "child", "uri", "name", "placement_frame"};
constexpr const char* kTextures[] = {"checker", "wood", "carpet"};

template <class List>
bool is_one_of(const List& list, const std::string& name) {
  return std::ranges::find(list, name) != std::end(list);
}

bool fits(const std::optional<std::vector<double>>& values, const Range& wanted) {
  const auto is_in = [&](double value) { return value >= wanted.min && value <= wanted.max; };
  return values && std::ranges::all_of(*values, is_in);
}

std::string describe(const Range& wanted) {
  std::string text = std::to_string(wanted.count);
  text += wanted.count == 1 ? " number" : " numbers";
  if (wanted.max == 1) return text + " from 0 to 1";
  if (wanted.min < 0 && wanted.max < kLargestNumber) {
    char range[80];
    std::snprintf(range, sizeof range, " from %g to %g%s", wanted.min, wanted.max, wanted.unit);
    return text + range;
  }
  char max[40] = "";
  if (wanted.max < kLargestNumber || wanted.min >= 0)
    std::snprintf(max, sizeof max, " and at most %g", wanted.max);
  if (wanted.min == 0) return text + " not below 0" + max + wanted.unit;
  if (wanted.min > 0) return text + " above 0" + max + wanted.unit;
  return text;
}

std::string quoted(const std::string& text) {
  return ", not \"" + text + "\"";
}

std::optional<std::string> pose_error(const SdfXml& e) {
  const std::string text = trimmed_text(e);
  const char* format = e.Attribute("rotation_format");
  const bool quaternion = format != nullptr && std::string(format) == "quat_xyzw";
  if (format != nullptr && !quaternion && std::string(format) != "euler_rpy")
    return "attribute `rotation_format` of <pose> must be euler_rpy or quat_xyzw" + quoted(format);
  const char* degrees = e.Attribute("degrees");
  bool in_degrees = false;
  if (degrees != nullptr && e.QueryBoolAttribute("degrees", &in_degrees) != tinyxml2::XML_SUCCESS)
    return "attribute `degrees` of <pose> must be true or false" + quoted(degrees);
  if (in_degrees && quaternion)
    return "<pose> has degrees and a quaternion; remove the attribute `degrees`";
  if (text.empty()) return std::nullopt;
  const Range place{quaternion ? 7u : 6u, -kMaxPose, kMaxPose, " (m, rad)"};
  auto values = parse_numbers(text, place.count);
  if (values && in_degrees) {
    for (std::size_t i = 3; i < 6; ++i) (*values)[i] *= std::acos(-1.0) / 180;
  }
  if (!fits(values, place)) return "<pose> must contain " + describe(place) + quoted(text);
  if (!quaternion) return std::nullopt;
  const auto& q = *values;
  if (std::abs(std::hypot(std::hypot(q[3], q[4]), std::hypot(q[5], q[6])) - 1) > 0.01)
    return "the quaternion in <pose> does not have the length 1; divide it by its length";
  return std::nullopt;
}

std::optional<std::string> own_error(const SdfXml& e) {
  const std::string name = e.Name();
  for (const OwnAttribute& own : kOwn) {
    if (name != own.element) continue;
    const char* text = e.Attribute(own.attribute);
    if (!fits(parse_numbers(text ? text : "", own.range.count), own.range))
      return "<" + name + "> needs the attribute `" + own.attribute + "` with " +
             describe(own.range);
  }
  if (name == "kaz:light") {  // the renderer's limit: shadows of a lower lamp are too long
    const auto to = parse_numbers(e.Attribute("to_lamp"), 3).value();
    if (!(to[2] > 0.05 * std::hypot(to[0], to[1], to[2])))
      return "<kaz:light> needs a lamp 3 degrees or more above the floor";
  }
  if (name == "kaz:push" && e.Attribute("link") == nullptr)
    return "<kaz:push> needs the attribute `link`: a link of the robot, such as trunk";
  const char* texture = e.Attribute("name");
  if (name == "kaz:texture" && (texture == nullptr || !is_one_of(kTextures, texture)))
    return "<kaz:texture> needs a `name` of checker, wood or carpet";
  return std::nullopt;
}

std::optional<std::string> numbers_error(const SdfXml& e, const std::string& parent) {
  const std::string name = e.Name(), text = trimmed_text(e);
  for (const RangeOf& one : kRanges) {
    if (name != one.element || (*one.parent != '\0' && parent != one.parent)) continue;
    auto values = parse_numbers(text, one.range.count);
    if (!values && name == "diffuse") values = parse_numbers(text, 3);  // without alpha
    if (!fits(values, one.range))
      return "<" + name + "> must contain " + describe(one.range) + quoted(text);
    const auto is_zero = [](double value) { return value == 0; };
    if (is_one_of(std::vector{"normal", "xyz", "direction"}, name) &&
        std::ranges::all_of(*values, is_zero))
      return "<" + name + "> is zero; give a direction";
    if (name == "scale" && std::ranges::any_of(*values, is_zero))
      return "<scale> of a mesh must not contain 0" + quoted(text);
  }
  return std::nullopt;
}

}  // namespace

std::string trimmed_text(const SdfXml& element) {
  const std::string text = element.GetText() == nullptr ? "" : element.GetText();
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::optional<std::string> sdf_value_error(const SdfXml& e, const std::string& parent) {
  const std::string name = e.Name(), text = trimmed_text(e);
  if (name == "pose") return pose_error(e);
  if (name.starts_with("kaz:")) return own_error(e);
  bool truth = false;
  if (is_one_of(kTruths, name) && e.QueryBoolText(&truth) != tinyxml2::XML_SUCCESS)
    return "<" + name + "> must be true or false";
  if (is_one_of(kTexts, name) && text.empty()) return "<" + name + "> is empty; give a name";
  if ((name == "lower" || name == "upper") && !joint_limit(text))
    return "<" + name + "> must contain 1 number (rad or m), or inf" + quoted(text);
  if (name == "collide_bitmask" && !bitmask(text))
    return "<collide_bitmask> must be a number from 0 to 65535, such as 0x0f" + quoted(text);
  return numbers_error(e, parent);
}

bool same_value(const std::string& text, std::string_view value) {
  bool truth = false;
  const std::string wanted(value);
  if (wanted == "true" || wanted == "false")
    return tinyxml2::XMLUtil::ToBool(text.c_str(), &truth) && truth == (wanted == "true");
  for (const std::size_t count : {1u, 3u}) {
    const auto numbers = parse_numbers(wanted, count);
    if (numbers) return parse_numbers(text, count) == numbers;
  }
  return text == wanted;
}

std::optional<bool> truth_of(const SdfXml& parent, const char* name) {
  const SdfXml* child = parent.FirstChildElement(name);
  if (child == nullptr) return std::nullopt;
  return child->BoolText(false);
}

std::optional<double> joint_limit(const std::string& text) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (text == "inf" || text == "+inf") return kInfinite;
  if (text == "-inf") return -kInfinite;
  const auto number = parse_numbers(text, 1);
  if (!number) return std::nullopt;
  const double value = number->front();
  return std::abs(value) < kNoLimit ? value : std::copysign(kInfinite, value);
}

std::optional<unsigned> bitmask(const std::string& text) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const char* const end = text.data() + text.size();
  unsigned value = 0;
  const auto [next, status] =
      std::from_chars(text.data() + (hexadecimal ? 2 : 0), end, value, hexadecimal ? 16 : 10);
  if (status != std::errc() || next != end || value > 0xffff) return std::nullopt;
  return value;
}

}  // namespace kaz::sim
