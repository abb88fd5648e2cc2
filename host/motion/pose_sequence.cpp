// Reads poses, and moves through them.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/pose_sequence.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::motion {

namespace {

using Json = nlohmann::ordered_json;

constexpr char kFormat[] = "kaz-poses-1";

tl::unexpected<Error> wrong(const std::string& name, const std::string& what) {
  return fail(Fault::usage, name + ": " + one_line(what) + "; see docs/howto/watch.md");
}

std::string which(std::size_t pose) {
  return "pose " + std::to_string(pose + 1);
}

Result<Pose> parse_pose(const Json& json, std::size_t index, const std::string& name) {
  if (!json.is_object()) return wrong(name, which(index) + " is not an object");
  for (const auto& [key, value] : json.items()) {
    if (key != "time_s" && key != "angles_rad")
      return wrong(name, which(index) + " has the unknown key \"" + cut_text(key) + "\"");
  }
  Pose pose;
  const auto time = json.find("time_s");
  if (time == json.end() || !time->is_number())
    return wrong(name, which(index) + " has no number \"time_s\"");
  pose.time_s = time->get<double>();
  if (!(pose.time_s >= 0 && pose.time_s <= kMaxPosesTime_s))
    return wrong(name, which(index) + ": \"time_s\" must be 0 to " + Json(kMaxPosesTime_s).dump());
  const auto angles = json.find("angles_rad");
  if (angles == json.end() || !angles->is_object())
    return wrong(name, which(index) + " has no object \"angles_rad\"");
  for (const auto& [joint, angle] : angles->items()) {
    if (!angle.is_number())
      return wrong(name,
                   which(index) + ": the angle of \"" + cut_text(joint) + "\" is not a number");
    const double rad = angle.get<double>();
    if (!(std::abs(rad) <= std::numbers::pi))
      return wrong(name, which(index) + ": the angle of \"" + cut_text(joint) + "\" is " +
                             json_sample(angle) + ": must be -pi to pi rad");
    pose.angles_rad.emplace_back(joint, rad);
  }
  return pose;
}

struct Value {
  double angle_rad, speed;
};

// Cubic Hermite polynomial between two knots.
template <class Knot>
Value between(const Knot& a, const Knot& b, double time_s) {
  const double h = b.time_s - a.time_s, u = (time_s - a.time_s) / h;
  const double d = b.angle_rad - a.angle_rad;
  const double c2 = 3 * d - h * (2 * a.slope + b.slope), c3 = h * (a.slope + b.slope) - 2 * d;
  return {a.angle_rad + u * (h * a.slope + u * (c2 + u * c3)),
          (h * a.slope + u * (2 * c2 + u * 3 * c3)) / h};
}

}  // namespace

Result<PoseSequence> parse_poses(std::string_view text, const std::string& name) {
  if (text.size() > kMaxPosesBytes) return wrong(name, "it is larger than 1 MiB");
  const auto parsed = parse_bounded_json<Json>(text);
  if (!parsed) return wrong(name, parsed.error().message);
  const Json& json = *parsed;
  if (!json.is_object()) return wrong(name, "it is not a JSON object");
  for (const auto& [key, value] : json.items()) {
    if (key != "format" && key != "poses")
      return wrong(name, "unknown key \"" + cut_text(key) + "\"");
  }
  if (json.value("format", Json()) != kFormat)
    return wrong(name, std::string("\"format\" must be \"") + kFormat + "\"");
  const auto poses = json.find("poses");
  if (poses == json.end() || !poses->is_array() || poses->empty() || poses->size() > kMaxPoses)
    return wrong(name, "\"poses\" must be a list of 1 to " + std::to_string(kMaxPoses) + " poses");
  PoseSequence sequence;
  for (const Json& one : *poses) {
    const std::size_t index = sequence.poses.size();
    Pose pose = KAZ_TRY(parse_pose(one, index, name));
    if (index > 0 && !(pose.time_s > sequence.poses.back().time_s))
      return wrong(name, which(index) + " is not later than the pose before it");
    sequence.poses.push_back(std::move(pose));
  }
  if (std::ranges::all_of(sequence.poses, [](const Pose& pose) { return pose.angles_rad.empty(); }))
    return wrong(name, "no pose names a joint");
  return sequence;
}

std::string text_of(const PoseSequence& sequence) {
  Json poses = Json::array();
  for (const Pose& pose : sequence.poses) {
    Json angles = Json::object();
    for (const auto& [joint, angle] : pose.angles_rad) angles[joint] = angle;
    poses.push_back({{"time_s", pose.time_s}, {"angles_rad", std::move(angles)}});
  }
  return Json{{"format", kFormat}, {"poses", std::move(poses)}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

// Weighted harmonic mean of the neighbouring chords where both rise or both fall, else 0; 0 at the ends.
void PoseMotion::set_slopes(std::vector<Knot>& knots) {
  for (std::size_t k = 1; k + 1 < knots.size(); ++k) {
    const double h0 = knots[k].time_s - knots[k - 1].time_s;
    const double h1 = knots[k + 1].time_s - knots[k].time_s;
    const double d0 = (knots[k].angle_rad - knots[k - 1].angle_rad) / h0;
    const double d1 = (knots[k + 1].angle_rad - knots[k].angle_rad) / h1;
    if (!(d0 * d1 > 0)) continue;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    knots[k].slope = (w0 + w1) / (w0 / d0 + w1 / d1);
  }
}

Result<PoseMotion> PoseMotion::create(const PoseSequence& sequence,
                                      std::span<const std::string> joints) {
  PoseMotion motion;
  for (const Pose& pose : sequence.poses) {
    motion.end_s_ = pose.time_s;
    for (const auto& [name, angle] : pose.angles_rad) {
      const auto found = std::ranges::find(joints, name);
      if (found == joints.end()) {
        std::string names;
        for (const std::string& joint : joints) names += (names.empty() ? "" : ", ") + joint;
        return fail(Fault::usage, "the poses name the joint \"" + one_line(name) +
                                      "\", which this robot does not have; it has " + names);
      }
      const int joint = static_cast<int>(found - joints.begin());
      auto track = std::ranges::find(motion.tracks_, joint, &Track::joint);
      if (track == motion.tracks_.end())
        track = motion.tracks_.insert(motion.tracks_.end(), Track{joint, {}});
      track->knots.push_back({pose.time_s, angle, 0});
    }
  }
  for (Track& track : motion.tracks_) set_slopes(track.knots);
  std::ranges::sort(motion.tracks_, {}, &Track::joint);
  return motion;
}

std::vector<host::JointTarget> PoseMotion::at(double time_s) const {
  std::vector<host::JointTarget> targets;
  targets.reserve(tracks_.size());
  for (const Track& track : tracks_) {
    const auto next = std::ranges::upper_bound(track.knots, time_s, {}, &Knot::time_s);
    double angle = 0;
    if (next == track.knots.begin())
      angle = track.knots.front().angle_rad;
    else if (next == track.knots.end())
      angle = track.knots.back().angle_rad;
    else
      angle = between(*(next - 1), *next, time_s).angle_rad;
    targets.push_back({track.joint, angle});
  }
  return targets;
}

std::vector<PoseMotion::Extent> PoseMotion::extents() const {
  std::vector<Extent> extents;
  for (const Track& track : tracks_) {
    const auto [low, high] = std::ranges::minmax_element(track.knots, {}, &Knot::angle_rad);
    Extent extent{track.joint, low->angle_rad, high->angle_rad, 0, 0};
    const auto look = [&](const Knot& a, const Knot& b, double time_s) {
      const double speed = std::abs(between(a, b, time_s).speed);
      if (speed <= extent.fastest_rad_per_s) return;
      extent.fastest_rad_per_s = speed;
      extent.fastest_at_s = time_s;
    };
    for (std::size_t k = 0; k + 1 < track.knots.size(); ++k) {
      const Knot &a = track.knots[k], &b = track.knots[k + 1];
      // The speed is a quadratic: fastest at an end or at its vertex.
      const double h = b.time_s - a.time_s, d = b.angle_rad - a.angle_rad;
      const double c2 = 3 * d - h * (2 * a.slope + b.slope), c3 = h * (a.slope + b.slope) - 2 * d;
      look(a, b, a.time_s);
      look(a, b, b.time_s);
      if (c3 == 0) continue;
      const double vertex = -c2 / (3 * c3);
      if (vertex > 0 && vertex < 1) look(a, b, a.time_s + vertex * h);
    }
    extents.push_back(extent);
  }
  return extents;
}

}  // namespace kaz::motion
