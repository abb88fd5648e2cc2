// go-forward: walks straight by odometry of the supporting feet, and by the gyro's heading if fitted.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <sstream>

#include "host/behavior/walker.h"
#include "shared/base/angle.hpp"
#include "shared/base/files.hpp"

namespace kaz::behavior {

namespace {

constexpr double kNear = 0.03;         // m, tolerance of the distance by odometry
constexpr double kMinDistance = 0.05;  // m; within the tolerance standing still would succeed

bool is_balance(std::string_view text) {
  return text == "none" || text == "learned" ||
         motion::BalancePolicy::parse(std::string(text), "balance").has_value();
}

// The weights in a file, in one line without comments.
Result<std::string> load_balance(const std::string& value) {
  constexpr std::size_t kLargest = 1 << 20;
  if (is_balance(value)) return value;
  const auto text = KAZ_TRY(
      read_whole_file(value, kLargest, "give balance=none, balance=learned, or a file of weights"));
  KAZ_TRY(motion::BalancePolicy::parse(text, value));
  std::string weights;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find("//")));
    for (std::string word; words >> word;) weights += (weights.empty() ? "" : " ") + word;
  }
  return weights;
}

constexpr Option kOptions[] = {
    {"distance", "0.5", "", -2, 5,
     "distance in m; a negative value means backward; the absolute value must be at least 0.05"},
    {"gyro", "use", "use|ignore", 0, 0, "ignore: walk as if the board had no gyro"},
    {"balance", "none", "none|learned|FILE", 0, 0,
     "learned: a small neural network adjusts the gait to withstand pushes (needs --imu)", false,
     is_balance, load_balance},
};

// `which`: none, learned, or weights.
Result<std::shared_ptr<const motion::BalancePolicy>> balance_policy(const std::string& which) {
  if (which == "none") return nullptr;
  if (which == "learned")
    return std::make_shared<const motion::BalancePolicy>(motion::BalancePolicy::learned());
  const auto policy = KAZ_TRY(motion::BalancePolicy::parse(which, "balance"));
  return std::make_shared<const motion::BalancePolicy>(policy);
}

Result<Outcome> run(Context& context) {
  if (std::abs(context.options.number("distance")) < kMinDistance - 1e-9)
    return fail(
        Fault::usage,
        "go-forward: the absolute value of the option `distance` must be at least 0.05 m; a "
        "negative distance means backward");
  motion::Settings settings;
  settings.use_gyro = context.options.choice("gyro") == "use";
  settings.balance = KAZ_TRY(balance_policy(context.options.choice("balance")));
  if (settings.balance && !(settings.use_gyro && KAZ_TRY(context.robot.sense_inertial())))
    return fail(Fault::usage,
                "go-forward: the option `balance` needs the gyro and accelerometer of the board: "
                "give gyro=use (and --imu if the robot is virtual), or give balance=none");
  auto walker = KAZ_TRY(Walker::begin(context, kGoForward.name, settings));
  const double distance = context.options.number("distance");
  const motion::Motion& motion = walker.motion();
  const double start = motion.walked(), heading = motion.heading();
  const Time began = walker.input().now;
  if (!walker.fallen()) {
    walker.phase("walk");
    walker.motion().walk(distance);
    KAZ_TRY(walker.finish());
  }
  const double walked = motion.walked() - start;
  const double turned = (motion.heading() - heading) / kDegree;
  const motion::Place place = motion.place();

  Outcome outcome;
  outcome.success = !walker.fallen() && std::abs(walked - distance) < kNear;
  char text[160];
  std::snprintf(text, sizeof text, "the robot %s %.2f m; its heading changed by %.1f degrees%s",
                walker.fallen() ? "fell after" : "walked", walked, turned,
                motion.has_gyro() ? "" : " (measured by the robot's strides, without a gyro)");
  outcome.sentence = text;
  if (!outcome.success) outcome.cause = walker.fallen() ? "fell" : "not reached";
  outcome.measurements = {{"walked_m", walked},
                          {"turned_deg", turned},
                          {"ahead_m", place.x},
                          {"aside_m", place.y},
                          {"sigma_along_m", place.sigma_along},
                          {"sigma_across_m", place.sigma_across},
                          {"sigma_heading_deg", place.sigma_heading / kDegree},
                          {"walking_s", seconds(walker.input().now - began)}};
  return outcome;
}

}  // namespace

constinit const Behavior kGoForward{.name = "go-forward",
                                    .text = "walk straight ahead for a distance",
                                    .options = kOptions,
                                    .run = run,
                                    .evaluation = {.criterion = Criterion::walked}};

}  // namespace kaz::behavior
