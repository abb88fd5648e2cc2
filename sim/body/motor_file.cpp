// The motor file: figures of the gear motor that drives each joint.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/motor_file.h"

#include <array>

#include "sim/body/xml_file.h"

namespace kaz::sim {
namespace {

struct Figure {
  const char* element;
  double MotorFigures::*member;
  double least;
  bool least_allowed;
};

constexpr std::array<Figure, 6> kFigures{{
    {"stall_slope", &MotorFigures::stall_slope_nm_per_v, 0, false},
    {"friction", &MotorFigures::friction_nm, 0, true},
    {"back_emf", &MotorFigures::back_emf_nms_per_rad, 0, false},
    {"stiction_ratio", &MotorFigures::stiction_ratio, 1, true},
    {"rotor_inertia", &MotorFigures::rotor_inertia_kgm2, 0, false},
    {"max_supply", &MotorFigures::max_supply_v, 0, false},
}};

Result<MotorFigures> read_motor(const XmlFile& file, const tinyxml2::XMLElement& motor) {
  MotorFigures figures;
  std::array<bool, kFigures.size()> seen{};
  for (auto* child = motor.FirstChildElement(); child; child = child->NextSiblingElement()) {
    std::size_t which = 0;
    while (which < kFigures.size() && std::string(child->Name()) != kFigures[which].element)
      ++which;
    if (which == kFigures.size()) {
      return file.error(*child, std::string("unknown element <") + child->Name() +
                                    "> in <motor>; see docs/robot.md for those it takes");
    }
    const Result<double> value = file.number(*child, "value");
    if (!value) return tl::unexpected(value.error());
    const Figure& figure = kFigures[which];
    if (*value < figure.least || (*value == figure.least && !figure.least_allowed)) {
      return file.error(*child, std::string("<") + figure.element + "> must be " +
                                    (figure.least_allowed ? "at least " : "more than ") +
                                    std::to_string(static_cast<int>(figure.least)));
    }
    figures.*figure.member = *value;
    seen[which] = true;
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i])
      return file.error(motor, std::string("<motor> lacks <") + kFigures[i].element + ">");
  }
  return figures;
}

}  // namespace

Result<MotorFigures> load_motor_file(const std::string& path, const std::string& name) {
  const Result<XmlFile> file = XmlFile::load(path, "motors");
  if (!file) return tl::unexpected(file.error());
  std::string wanted = name;
  if (wanted.empty()) {
    const Result<std::string> standard = file->attribute(file->root(), "default");
    if (!standard) return tl::unexpected(standard.error());
    wanted = *standard;
  }
  std::string known;
  for (auto* motor = file->root().FirstChildElement(); motor; motor = motor->NextSiblingElement()) {
    if (std::string(motor->Name()) != "motor") {
      return file->error(*motor,
                         std::string("unknown element <") + motor->Name() + ">, expected <motor>");
    }
    const Result<std::string> its_name = file->attribute(*motor, "name");
    if (!its_name) return tl::unexpected(its_name.error());
    Result<MotorFigures> figures = read_motor(*file, *motor);
    if (!figures) return figures;
    figures->name = *its_name;
    if (*its_name == wanted) return figures;
    if (!known.empty()) known += ", ";
    known += *its_name;
  }
  return file->error(file->root(), "has no motor `" + wanted + "`; it has: " + known);
}

}  // namespace kaz::sim
