// pose: holds the joints where somebody wants them, and plays what somebody has made of such poses.
// SPDX-License-Identifier: Apache-2.0
//
// The page of --view asks for it, by Context::requests (pose_request.h).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>

#include "host/behavior/pose_player.h"
#include "host/behavior/pose_request.h"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {
    {"seconds", "3600", "", 0.1, 86400, "time after which the behavior ends, s"},
};

constexpr double kSpeed = 1.5;  // rad/s

class Session {
 public:
  explicit Session(Context& context)
      : context_(context), names_(joint_names(context)), player_(context) {}

  Result<Outcome> run() {
    const Time end = context_.clock.now() + from_seconds(context_.options.number("seconds"));
    phase("hold");
    std::vector<host::JointTarget> targets;
    host::Posture last = KAZ_TRY(context_.robot.state());
    while (!ended_ && context_.clock.now() < end) {
      targets.clear();
      hear();
      while (!lines_.empty() && !ended_) {
        const auto request = parse_pose_request(lines_.front());
        lines_.pop_front();
        if (!request) {
          refuse(request.error());
        } else if (request->kind == PoseRequest::Kind::play) {
          KAZ_TRY(play(request->text));
          last = KAZ_TRY(context_.robot.state());
        } else if (request->kind == PoseRequest::Kind::target) {
          KAZ_TRY(add_target(*request, targets));
        } else {
          ended_ = request->kind == PoseRequest::Kind::end;
        }
      }
      double longest = 0;
      for (const auto& [joint, angle] : targets)
        longest = std::max(longest, std::abs(angle - last.angle[static_cast<std::size_t>(joint)]));
      const auto input = KAZ_TRY(
          player_.cycle(targets, std::max(ControlCycle::kRamp, from_seconds(longest / kSpeed))));
      last = input.posture;
    }
    Outcome outcome{true, "", {{"targets", double(set_)}, {"played", double(played_)}}};
    outcome.sentence =
        std::to_string(set_) + " targets were set, " + std::to_string(played_) + " motions played";
    return outcome;
  }

 private:
  void phase(std::string_view text) { context_.sink.phase(context_.clock.now(), kPose.name, text); }
  void refuse(const Error& error) { phase("refused: " + error.message); }

  void hear() {
    for (std::string& line : context_.requests->take(context_.clock.now()))
      lines_.push_back(std::move(line));
  }

  Result<void> add_target(const PoseRequest& request, std::vector<host::JointTarget>& targets) {
    const auto found = std::ranges::find(names_, request.text);
    if (found == names_.end()) {
      refuse({Fault::usage, "this robot has no joint `" + request.text + "`"});
      return {};
    }
    const int joint = static_cast<int>(found - names_.begin());
    const auto limits = KAZ_TRY(context_.robot.settings(joint)).limits;
    if (!(request.angle_rad >= limits.lower_rad && request.angle_rad <= limits.upper_rad)) {
      char text[120];
      std::snprintf(text, sizeof text, "%s: %.4g rad must be %.4g to %.4g rad", found->c_str(),
                    request.angle_rad, limits.lower_rad, limits.upper_rad);
      refuse({Fault::usage, text});
      return {};
    }
    std::erase_if(targets, [joint](const host::JointTarget& t) { return t.joint == joint; });
    targets.push_back({joint, request.angle_rad});
    ++set_;
    return {};
  }

  // Until its end, or any other request than `play`.
  Result<void> play(const std::string& text) {
    const auto sequence = motion::parse_poses(text, "poses");
    if (!sequence) return refuse(sequence.error()), Result<void>();
    const auto motion = motion::PoseMotion::create(*sequence, names_);
    if (!motion) return refuse(motion.error()), Result<void>();
    const auto possible = player_.check(*motion);
    if (!possible && possible.error().fault == Fault::usage)
      return refuse(possible.error()), Result<void>();
    KAZ_TRY(possible);
    phase("play");
    const auto followed = KAZ_TRY(player_.play(*motion, [this] {
      hear();
      return !lines_.empty();
    }));
    if (followed.stopped) {
      const auto now = KAZ_TRY(context_.robot.state());
      std::vector<host::JointTarget> here;
      for (const auto& [joint, angle] : motion->at(0))
        here.push_back({joint, now.angle[static_cast<std::size_t>(joint)]});
      KAZ_TRY(player_.cycle(here, ControlCycle::kRamp));
    } else {
      ++played_;
    }
    phase("hold");
    return {};
  }

  Context& context_;
  std::vector<std::string> names_;
  PosePlayer player_;
  std::deque<std::string> lines_;
  bool ended_ = false;
  int set_ = 0, played_ = 0;
};

Result<Outcome> run(Context& context) {
  if (context.requests == nullptr) return fail(Fault::usage, kNoRequests);
  KAZ_TRY(hold_still(context.robot));
  return Session(context).run();
}

}  // namespace

constinit const Behavior kPose{
    "pose", "hold the joints at the angles set on the --view page", false, kOptions, run, false,
    true};

}  // namespace kaz::behavior
