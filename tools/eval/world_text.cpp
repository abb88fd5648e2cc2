// The world of a scenario as SDF: what the simulator loads, and what replays.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tools/eval/scenario.h"

namespace kaz::tools {
namespace {

using Eigen::Vector2d;
using trials::digits;

constexpr double kTable_m = 0.5;  // of a table's top above the floor below
constexpr double kTableThick_m = 0.04;
constexpr double kSliderDensity = 300;                // kg/m3, cardboard with something in it
constexpr double kBallMass = 0.015, kBallOf = 0.020;  // kg, at this radius, m: hard rubber

using Rgb = std::array<double, 3>;

std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + digits(value);
  return text;
}
std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}
std::string named(const std::string& what, const std::string& name, const std::string& content) {
  return "<" + what + " name=\"" + name + "\">" + content + "</" + what + ">";
}

std::string material(const Rgb& rgb) {
  return element("material", element("diffuse", numbers({rgb[0], rgb[1], rgb[2], 1})));
}
std::string texture(const std::string& name) {
  return name == "plain" ? "" : "<kaz:texture name=\"" + name + "\"/>";
}
// `more`: of the surface.
std::string surface(double friction, const std::string& more = {}) {
  return element("surface",
                 element("friction", element("ode", element("mu", digits(friction)))) + more);
}
std::string inertial(double mass, double ixx, double iyy, double izz) {
  return element("inertial",
                 element("mass", digits(mass)) +
                     element("inertia", element("ixx", digits(ixx)) + element("iyy", digits(iyy)) +
                                            element("izz", digits(izz)) +
                                            "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz>"));
}
std::string sphere(double radius) {
  return element("geometry", element("sphere", element("radius", digits(radius))));
}
std::string box(double length, double width, double height) {
  return element("geometry", element("box", element("size", numbers({length, width, height}))));
}

class WorldText {
 public:
  WorldText(const Scenario& scenario, const BallColor& color) : s_(scenario), color_(color) {}

  std::string text() const {
    const double aside = std::cos(s_.lamp_height_rad);
    std::string text =
        R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="episode">
<kaz:robot pose=")" +
        start() + first_step() + "\">" + pushes() + "</kaz:robot><kaz:light to_lamp=\"" +
        numbers({aside * std::cos(s_.lamp_azimuth_rad), aside * std::sin(s_.lamp_azimuth_rad),
                 std::sin(s_.lamp_height_rad)}) +
        "\" lamp=\"" + digits(s_.lamp) + "\" shade=\"" + digits(s_.shade) + "\"/>\n";
    text += floor();
    for (std::size_t i = 0; i < s_.layout.table.size(); ++i)
      text += slab("table" + std::to_string(i), s_.layout.table[i]);
    for (const Obstacle& o : s_.layout.obstacles) text += obstacle(s_.name_of(o), o);
    if (s_.has_ball) text += ball("ball", {s_.ball_x_m, s_.ball_y_m}, s_.ball_radius_m, color_.rgb);
    return text + "</world></sdf>\n";
  }

 private:
  std::string first_step() const {
    if (s_.pushes.empty() || !s_.pushes_from_first_step) return {};
    return "\" first_step=\"l_ankle_pitch r_ankle_pitch";
  }
  std::string pushes() const {
    std::string text;
    for (const Scenario::Push& push : s_.pushes)
      text += "<kaz:push time=\"" + digits(push.at_s) + "\" link=\"trunk\" impulse=\"" +
              numbers({push.impulse.x(), push.impulse.y(), 0}) + "\"/>";
    return text;
  }
  // Of the point between the soles. Lying, the robot falls by some centimetres.
  std::string start() const {
    constexpr double kQuarter = std::numbers::pi / 2, kAbove_m = 0.08, kAside_m = 0.12;
    double height = 0, roll = 0, pitch = 0;
    if (s_.lies == Lies::on_face || s_.lies == Lies::on_back) {
      height = kAbove_m;
      pitch = s_.lies == Lies::on_face ? kQuarter : -kQuarter;
    } else if (s_.lies) {
      height = kAside_m;
      roll = s_.lies == Lies::on_right ? kQuarter : -kQuarter;
    }
    return numbers({s_.start_x_m, s_.start_y_m, height, roll, pitch, s_.start_yaw_rad});
  }
  // In the axes of the world.
  Vector2d turned(const Vector2d& v) const { return s_.world_from_start().linear() * v; }
  std::string pose(const Vector2d& at, double z, double yaw) const {
    const Vector2d there = s_.world_from_start() * at;
    return element("pose", numbers({there.x(), there.y(), z, 0, 0, yaw + s_.start_yaw_rad}));
  }

  // Without an end; the floor below a table is carpet.
  std::string floor() const {
    const bool below = !s_.layout.table.empty();
    const std::string plane =
        element("geometry", element("plane", "<normal>0 0 1</normal><size>8 8</size>"));
    return named(
               "model", "floor",
               "<static>true</static>" +
                   (below ? element("pose", numbers({0, 0, -kTable_m, 0, 0, 0})) : "") +
                   named("link", "slab",
                         named("collision", "hull", plane + surface(s_.friction)) +
                             named("visual", "top",
                                   plane + material(below ? Rgb{0.45, 0.47, 0.50} : s_.floor_rgb) +
                                       texture(below ? "carpet" : s_.floor)))) +
           "\n";
  }

  std::string slab(const std::string& name, const Slab& slab) const {
    const std::string shape = box(slab.length_m, slab.width_m, kTableThick_m);
    return named("model", name,
                 "<static>true</static>" +
                     pose({slab.x_m, slab.y_m}, -kTableThick_m / 2, slab.yaw_rad) +
                     named("link", "top",
                           named("collision", "hull", shape + surface(s_.friction)) +
                               named("visual", "top",
                                     shape + material(s_.floor_rgb) + texture(s_.floor)))) +
           "\n";
  }

  std::string obstacle(const std::string& name, const Obstacle& o) const {
    if (o.shape == Shape::ball) return ball(name, o.place(), o.length_m / 2, o.rgb);
    const std::string shape =
        o.shape == Shape::box
            ? box(o.length_m, o.width_m, o.height_m)
            : element("geometry", element("cylinder", element("radius", digits(o.length_m / 2)) +
                                                          element("length", digits(o.height_m))));
    const std::string skin =
        named("visual", "paint", shape + material(o.rgb)) +
        named("collision", "hull", shape + (o.slide ? surface(kSlideFriction) : std::string()));
    const std::string at = pose(o.place(), o.height_m / 2, o.yaw_rad);
    if (!o.slide)
      return named("model", name, "<static>true</static>" + at + named("link", "body", skin)) +
             "\n";
    const double mass = kSliderDensity * o.length_m * o.width_m * o.height_m;
    const auto moment = [&](double a, double b) { return mass * (a * a + b * b) / 12; };
    const Vector2d push = turned(o.slide->by_m.normalized() * push_speed(o.slide->by_m.norm()));
    return named("model", name,
                 at +
                     named("link", "body",
                           inertial(mass, moment(o.width_m, o.height_m),
                                    moment(o.length_m, o.height_m), moment(o.length_m, o.width_m)) +
                               skin) +
                     "<kaz:kick time=\"" + digits(o.slide->at_s) + "\" velocity=\"" +
                     numbers({push.x(), push.y(), 0}) + "\"/>") +
           "\n";
  }

  std::string ball(const std::string& name, const Vector2d& at, double r, const Rgb& rgb) const {
    const double mass = kBallMass * std::pow(r / kBallOf, 3), moment = 0.4 * mass * r * r;
    return named(
               "model", name,
               pose(at, r, 0) +
                   named("link", name,
                         inertial(mass, moment, moment, moment) +
                             named("collision", "skin",
                                   sphere(r) +
                                       surface(1, "<kaz:rolling_resistance metres=\"0.0005\"/>")) +
                             named("visual", "paint", sphere(r) + material(rgb)))) +
           "\n";
  }

  const Scenario& s_;
  const BallColor& color_;
};

}  // namespace

Result<std::string> world_text(const Scenario& scenario) {
  const auto color = KAZ_TRY(ball_color(scenario.ball_color));
  return WorldText(scenario, color).text();
}

}  // namespace kaz::tools
