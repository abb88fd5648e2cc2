// The ball over time: rolling, thrown, hidden, jumping, late.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "shared/base/random.hpp"
#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using Taken = BallTrack::Taken;

// An eye 0.3 m above the floor that looks ahead and down, 320 px wide.
const Eigen::Isometry3d kEye = [] {
  Eigen::Isometry3d eye = Eigen::Isometry3d::Identity();
  eye.translation() = Vector3d(0, 0, 0.3);
  const double c = std::cos(0.5), s = std::sin(0.5);
  eye.linear().col(0) = Vector3d(0, -1, 0);
  eye.linear().col(1) = Vector3d(-s, 0, -c);
  eye.linear().col(2) = Vector3d(c, 0, -s);
  return eye;
}();

Time frame(int i) {
  return from_seconds(i / 30.0);
}

// As the eye would see it: a centre wrong by 0.3 px, a radius by 0.2 px.
BallObservation see(const Vector3d& ball, int i, std::uint64_t seed = 1) {
  const auto noise = [&](std::uint64_t channel) {
    return keyed_normal(seed, static_cast<std::uint64_t>(i), channel);
  };
  BallObservation seen;
  seen.info = test_info(test_camera());
  seen.info.exposure = frame(i);
  const double f = seen.info.camera.fx;
  const Vector3d p = kEye.inverse() * ball;
  seen.direction =
      Vector3d(p.x() / p.z() + 0.3 * noise(1) / f, p.y() / p.z() + 0.3 * noise(2) / f, 1)
          .normalized();
  seen.distance_m = f * 0.02 / (f * 0.02 / p.norm() + 0.2 * noise(3));
  seen.found = true;
  return seen;
}

BallTrackOptions on_floor() {
  BallTrackOptions options;
  options.floor_m = 0;
  options.acceleration_psd = 0.05;
  return options;
}

Vector3d rolling(double t) {
  return {0.6 - 0.05 * t * t, -0.25 + 0.4 * t, 0.02};
}

// Thrown up from 0.3 m, bounces with 0.6 of its speed.
Vector3d thrown(double t) {
  double z = 0.3 - 0.02, up = 1.0;
  while (true) {
    const double lands = (up + std::sqrt(up * up + 2 * 9.81 * z)) / 9.81;
    if (t <= lands || lands < 0.01) break;
    up = 0.6 * (9.81 * lands - up);
    z = 0;
    const double past = t - lands;
    t = past;
  }
  return {0, 0, std::max(0.0, z + up * t - 9.81 / 2 * t * t) + 0.02};
}
Vector3d thrown_ahead(double t) {
  return thrown(t) + Vector3d(0.7, -0.2 + 0.3 * t, 0);
}

// Errors of the prediction `ahead`, at all frames from `first` on; sorted.
std::vector<double> errors(BallTrack& track, const std::function<Vector3d(double)>& path,
                           int frames, int first, Time ahead, std::uint64_t seed = 1) {
  std::vector<double> all;
  for (int i = 0; i < frames; ++i) {
    track.observe(see(path(i / 30.0), i, seed), kEye);
    if (i >= first)
      all.push_back((track.at(frame(i) + ahead).position - path(seconds(frame(i) + ahead))).norm());
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(BallTrack, ErrorsOfAnObservationAreThoseOfItsPixels) {
  BallTrackOptions o;
  const Vector3d p(0, 0, 0.5);
  const Eigen::Matrix3d c = ball_covariance(p, 200, Eigen::Matrix3d::Identity(), o);
  EXPECT_NEAR(std::sqrt(c(0, 0)), 0.5 * std::hypot(0.3 / 200, 0.003), 1e-9);
  EXPECT_NEAR(std::sqrt(c(2, 2)), 0.25 * 0.2 / (200 * 0.02), 1e-9);
  // The same by numbers: of the distance from a radius that is 0.2 px too large.
  EXPECT_NEAR(std::sqrt(c(2, 2)), 0.5 - 200 * 0.02 / (200 * 0.02 / 0.5 + 0.2), 0.0005);
  const double far = std::sqrt(ball_covariance(2 * p, 200, Eigen::Matrix3d::Identity(), o)(2, 2));
  EXPECT_NEAR(far, 4 * std::sqrt(c(2, 2)), 1e-9);
}

TEST(BallTrack, ARollingBallIsPredicted) {
  BallTrack track(on_floor());
  const auto e = errors(track, rolling, 45, 10, 150ms);
  // One observation is wrong by 17 mm along the ray; the floor and later observations remove most of that.
  EXPECT_LT(e[e.size() / 2], 0.02);
  EXPECT_LT(e.back(), 0.05);
  EXPECT_FALSE(track.in_flight(frame(44)));
  EXPECT_NEAR(track.at(frame(44)).velocity.y(), 0.4, 0.08);
}

TEST(BallTrack, ItsCovarianceIsHonest) {
  // Mean of e' P^-1 e over 40 seeds: 3 for a filter that knows its errors. 240 numbers: 3 +- 0.3.
  double sum = 0;
  int n = 0;
  BallTrackOptions options;
  options.posture_error_rad = 1e-6;  // see() has none
  options.acceleration_psd = 1e-4;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    BallTrack track(options);
    for (int i = 0; i < 30; ++i) {
      const Vector3d ball(0.5, -0.1 + 0.2 * i / 30.0, 0.02);
      track.observe(see(ball, i, seed), kEye);
      if (i % 5 || i == 0) continue;
      const BallState s = track.at(frame(i));
      const Vector3d off = s.position - ball;
      sum += off.dot(s.position_covariance().inverse() * off);
      ++n;
    }
  }
  EXPECT_GT(sum / n, 2.0);
  EXPECT_LT(sum / n, 4.5);  // the radius' error makes that of the distance lopsided
}

TEST(BallTrack, AThrownBallFallsAndBounces) {
  BallTrack with(on_floor());
  const auto e = errors(with, thrown_ahead, 36, 8, 150ms);
  BallTrackOptions without = on_floor();
  without.floor_m.reset();
  BallTrack straight(without);
  const auto worse = errors(straight, thrown_ahead, 36, 8, 150ms);
  EXPECT_LT(e[e.size() / 2], 0.04);
  EXPECT_LT(2 * e[e.size() / 2], worse[worse.size() / 2]);
  BallTrack flying(on_floor());
  errors(flying, thrown_ahead, 6, 6, 0ms);
  EXPECT_TRUE(flying.in_flight(frame(5)));
  EXPECT_NEAR(flying.at(frame(5) + 2s).position.z(), 0.02, 0.01) << "comes to rest on the floor";
}

TEST(BallTrack, AnOutlierIsNotFollowed) {
  BallTrack track(on_floor());
  errors(track, rolling, 20, 20, 0ms);
  const Vector3d before = track.at(frame(20)).position;
  EXPECT_EQ(track.observe(see({0.9, 0.3, 0.02}, 20), kEye), Taken::outlier);
  EXPECT_EQ(track.at(frame(20)).position, before);
  EXPECT_EQ(track.observe(see(rolling(21 / 30.0), 21), kEye), Taken::used);
}

TEST(BallTrack, TwoOutliersThatAgreeAreTheBall) {
  BallTrack track(on_floor());
  errors(track, rolling, 20, 20, 0ms);
  EXPECT_EQ(track.observe(see({0.9, 0.30, 0.02}, 20), kEye), Taken::outlier);
  EXPECT_EQ(track.observe(see({0.9, 0.31, 0.02}, 21), kEye), Taken::restarted);
  EXPECT_NEAR(track.at(frame(21)).position.y(), 0.31, 0.02);
}

TEST(BallTrack, AfterASecondItBeginsAnew) {
  BallTrack track(on_floor());
  errors(track, rolling, 10, 10, 0ms);
  EXPECT_TRUE(track.seen(frame(9) + 500ms));
  EXPECT_FALSE(track.seen(frame(9) + 501ms));
  EXPECT_TRUE(track.known());
  const double sharp = track.at(frame(9)).covariance.trace();
  EXPECT_GT(track.at(frame(39)).covariance.trace(), sharp);
  EXPECT_EQ(track.observe(see({0.4, 0, 0.02}, 39), kEye), Taken::started);
  EXPECT_NEAR(track.at(frame(39)).position.x(), 0.4, 0.03);
  EXPECT_EQ(track.at(frame(39)).velocity.norm(), 0);
}

TEST(BallTrack, TheOrderOfArrivalDoesNotMatter) {
  BallTrack in_order(on_floor()), late(on_floor());
  for (int i = 0; i < 20; ++i) in_order.observe(see(thrown_ahead(i / 30.0), i), kEye);
  late.observe(see(thrown_ahead(0), 0), kEye);
  for (int i = 1; i < 20; i += 3) {
    for (const int k : {i + 1, i + 2, i}) {
      if (k >= 20) continue;
      const auto taken = late.observe(see(thrown_ahead(k / 30.0), k), kEye);
      EXPECT_TRUE(taken == Taken::used || taken == Taken::late) << k;
    }
  }
  const BallState a = in_order.at(frame(25)), b = late.at(frame(25));
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(late.observe(see(thrown_ahead(0), 3), kEye), Taken::refused) << "has that one";
}

TEST(BallTrack, AClockSetBackIsAGap) {
  BallTrack track(on_floor());
  for (int i = 100; i < 120; ++i) track.observe(see(rolling(0), i), kEye);
  EXPECT_EQ(track.observe(see(rolling(0), 2), kEye), Taken::new_clock);
  EXPECT_EQ(track.gaps(), 1);
  EXPECT_EQ(track.latest(), frame(2));
  EXPECT_EQ(track.observe(see(rolling(0), 3), kEye), Taken::used);
}

TEST(BallTrack, NonsenseIsRefused) {
  BallTrack track;
  BallObservation none = see({0.5, 0, 0.02}, 1);
  none.found = false;
  EXPECT_EQ(track.observe(none, kEye), Taken::refused);
  none.found = true;
  none.distance_m = NAN;
  EXPECT_EQ(track.observe(none, kEye), Taken::refused);
  EXPECT_EQ(track.observe(0ms, {0, 0, 0}, Eigen::Matrix3d::Zero()), Taken::refused);
  EXPECT_FALSE(track.known());
}

TEST(BallTrack, ABallAtRestIsNotChased) {
  double aimed = 0, straight = 0;
  BallTrack track;
  for (int i = 0; i < 200; ++i) {
    const Vector3d ball(0.5, 0, 0.02);
    track.observe(see(ball, i), kEye);
    if (i < 20) continue;
    aimed += (track.aim(frame(i) + 100ms) - track.at(frame(i)).position).norm();
    straight += (track.at(frame(i) + 100ms).position - track.at(frame(i)).position).norm();
  }
  EXPECT_LT(aimed, 0.85 * straight);  // m is 3 on average for noise in three directions
}

}  // namespace
}  // namespace kaz::vision
