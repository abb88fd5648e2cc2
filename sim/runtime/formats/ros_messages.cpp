// Writes messages as ROS 1 has them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/ros_messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace kaz::sim::ros {

namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;
constexpr double kMetresPerNewton = 0.01, kLongest_m = 0.3, kLeast_N = 0.05;

void real32(LittleEndian& to, double value) {
  to.number(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

void put(LittleEndian& to, std::uint64_t time_ns, const Marker& marker) {
  header(to, time_ns, marker.frame).text(marker.space);
  to.number(marker.id).number(static_cast<std::uint32_t>(marker.type));
  to.number(static_cast<std::uint32_t>(marker.removes_all ? 3 : 0));
  pose(to, marker.at);
  to.reals({marker.scale.data(), 3});
  for (const float part : {marker.color.r, marker.color.g, marker.color.b, 1.0f})
    real32(to, static_cast<double>(part));
  to.number(std::uint32_t{0}).number(std::uint32_t{0});  // lifetime: for ever
  to.number(std::uint8_t{1});                            // frame_locked
  to.number(std::uint32_t{0}).number(std::uint32_t{0});  // points, colors
  to.text(marker.texture).text("").number(std::uint8_t{0});
}

// Marker of a shape; nothing for meshes, which only the robot has.
std::optional<Marker> marker_of(const Visual& visual) {
  Marker marker;
  marker.at = visual.in_frame;
  marker.color = visual.color;
  marker.texture = visual.texture;
  const Eigen::Vector3d& size = visual.shape.size;
  switch (visual.shape.kind) {
    case Shape::Kind::box:
      marker.scale = size;
      return marker;
    case Shape::Kind::sphere:
      marker.type = Marker::sphere;
      marker.scale = Eigen::Vector3d::Constant(2 * size.x());
      return marker;
    case Shape::Kind::cylinder:
    case Shape::Kind::capsule:
      marker.type = Marker::cylinder;
      marker.scale = {2 * size.x(), 2 * size.x(), size.y()};
      return marker;
    case Shape::Kind::plane:  // thin, and no wider than a viewer has use for
      marker.scale = {std::clamp(size.x(), 0.1, 10.0), std::clamp(size.y(), 0.1, 10.0), 1e-4};
      marker.at.translation() -= marker.at.linear() * Eigen::Vector3d(0, 0, 1e-3);
      return marker;
    case Shape::Kind::hull:
    case Shape::Kind::mesh:
      break;
  }
  return std::nullopt;
}

}  // namespace

LittleEndian& header(LittleEndian& to, std::uint64_t time_ns, std::string_view frame,
                     std::uint32_t sequence) {
  return to.number(sequence)
      .number(static_cast<std::uint32_t>(time_ns / kSecond))
      .number(static_cast<std::uint32_t>(time_ns % kSecond))
      .text(frame);
}

void pose(LittleEndian& to, const Eigen::Isometry3d& at) {
  const Eigen::Vector3d place = at.translation();
  const Eigen::Quaterniond turn(at.rotation());
  to.reals({place.data(), 3});
  to.real(turn.x()).real(turn.y()).real(turn.z()).real(turn.w());
}

void transforms(std::vector<std::uint8_t>& data, std::uint64_t time_ns,
                std::span<const NamedPose> poses) {
  LittleEndian to(data);
  to.number(static_cast<std::uint32_t>(poses.size()));
  for (const auto& [name, at] : poses) {
    header(to, time_ns, "world").text(name);
    pose(to, at);
  }
}

void markers(std::vector<std::uint8_t>& data, std::uint64_t time_ns,
             std::span<const Marker> markers) {
  LittleEndian to(data);
  to.number(static_cast<std::uint32_t>(markers.size()));
  for (const Marker& marker : markers) put(to, time_ns, marker);
}

std::vector<Marker> markers_of(const Scene& scene, std::span<const std::string> without) {
  std::vector<Marker> markers;
  for (const Visual& visual : scene.visuals) {
    const auto frame = static_cast<std::size_t>(visual.frame);
    const std::string& name = scene.frames[frame];
    if (frame != 0 && std::ranges::find(without, name) != without.end()) continue;
    auto marker = marker_of(visual);
    if (!marker) continue;
    marker->frame = frame == 0 ? "world" : name;
    marker->space = visual.name;
    marker->id = static_cast<std::uint32_t>(markers.size());
    markers.push_back(std::move(*marker));
  }
  return markers;
}

std::vector<Marker> markers_of(std::span<const ContactPoint> contacts) {
  std::vector<Marker> markers(1);
  markers.front().space = "contacts";
  markers.front().removes_all = true;
  for (const ContactPoint& contact : contacts) {
    const double newtons = contact.force.norm();
    if (!std::isfinite(newtons) || newtons < kLeast_N) continue;
    Marker& marker = markers.emplace_back();
    marker.space = "contacts";
    marker.id = static_cast<std::uint32_t>(markers.size() - 1);
    marker.type = Marker::arrow;
    marker.at.translation() = contact.at;
    marker.at.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), contact.force)
                             .toRotationMatrix();
    marker.scale = {std::min(kLongest_m, kMetresPerNewton * newtons), 0.003, 0.006};
    marker.color = {0.90f, 0.62f, 0.0f};
  }
  return markers;
}

void camera_info(std::vector<std::uint8_t>& data, std::uint64_t time_ns,
                 const vision::CameraModel& model, bool right) {
  LittleEndian to(data);
  header(to, time_ns, right ? "right_eye" : "left_eye");
  to.number(static_cast<std::uint32_t>(model.height))
      .number(static_cast<std::uint32_t>(model.width));
  to.text("plumb_bob").number(std::uint32_t{5}).reals(std::array<double, 5>{});
  to.reals(std::array{model.fx, 0.0, model.cx, 0.0, model.fy, model.cy, 0.0, 0.0, 1.0});
  to.reals(std::array{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  to.reals(std::array{model.fx, 0.0, model.cx, right ? -model.fx * model.baseline_m : 0.0, 0.0,
                      model.fy, model.cy, 0.0, 0.0, 0.0, 1.0, 0.0});
  for (int i = 0; i < 6; ++i) to.number(std::uint32_t{0});  // binning, region of interest
  to.number(std::uint8_t{0});
}

}  // namespace kaz::sim::ros
