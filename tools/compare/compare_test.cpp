// kaz compare finds what was made different, and nothing where only the noise is.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "shared/base/angle.hpp"
#include "shared/base/random.hpp"
#include "tools/compare/comparison.h"

namespace kaz::tools {
namespace {

constexpr int kNeck = 0, kKnee = 12;

// A joint that follows targets, sent every 20 ms with ramps of 20 ms, `lag_s` later and `offset_rad` off.
struct Made {
  double lag_s = 0.02, offset_rad = 0, noise_rad = 0.1 * kDegree;
  double round_trip_s = 0.007, volts = 10;
  std::uint64_t seed = 1;
  std::uint32_t mask = 1u << kNeck | 1u << kKnee;
};

double path(double t) {
  return 0.3 * std::sin(2.1 * t) + 0.1 * std::sin(9 * t);
}

RunTrace make(const Made& made) {
  RunTrace trace;
  trace.behavior = "made";
  trace.robot = "virtual";
  trace.duration_s = 10;
  std::uint64_t drawn = 0;
  const auto normal = [&] { return keyed_normal(made.seed, ++drawn, 0); };
  for (double t = 0; t < trace.duration_s; t += 0.02) {
    RunTrace::Targets targets{t, 0.02, made.mask, {}};
    // Reached at the end of the ramp.
    for (double& angle : targets.angle_rad) angle = path(t + 0.02);
    trace.targets.push_back(targets);
    RunTrace::Posture posture{t + 0.004, {}, made.volts + 0.02 * normal()};
    for (double& angle : posture.angle_rad)
      angle = path(posture.time_s - made.lag_s) + made.offset_rad + made.noise_rad * normal();
    trace.postures.push_back(posture);
    trace.exchanges.push_back({t, made.round_trip_s + 2e-4 * normal()});
    trace.pictures.push_back({t, 0.03 + 1e-3 * normal(), true});
  }
  return trace;
}

const Measure& find(const Comparison& comparison, const std::string& name) {
  for (const Measure& measure : comparison.measures)
    if (measure.name == name) return measure;
  ADD_FAILURE() << "no measure " << name;
  static const Measure none;
  return none;
}

std::string differing(const Comparison& comparison) {
  std::string names;
  for (const Measure& measure : comparison.measures)
    if (measure.differs()) names += measure.name + " ";
  return names;
}

TEST(Compare, MeasuresLagOffsetAndScatter) {
  Made b;
  b.lag_s = 0.045;
  b.offset_rad = 1 * kDegree;
  b.seed = 2;
  const Comparison comparison = compare(make({}), make(b));
  const Measure& lag = find(comparison, "l_knee.lag");
  EXPECT_NEAR(lag.a.value, 20, 1);
  EXPECT_NEAR(lag.b.value, 45, 1);
  const Measure& offset = find(comparison, "l_knee.offset");
  EXPECT_NEAR(offset.a.value, 0, 0.02);
  EXPECT_NEAR(offset.b.value, 1, 0.02);
  EXPECT_NEAR(find(comparison, "l_knee.scatter").a.value, 0.1, 0.02);
  EXPECT_EQ(differing(comparison), "neck_pan.lag neck_pan.offset l_knee.lag l_knee.offset ");
}

TEST(Compare, NoiseAloneIsNoDifference) {
  int found = 0, of = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Made a, b;
    a.seed = 2 * seed;
    b.seed = 2 * seed + 1;
    const Comparison comparison = compare(make(a), make(b));
    found += comparison.differing();
    of += static_cast<int>(comparison.measures.size());
  }
  // One in a thousand is expected of what is beyond its resolution, too.
  EXPECT_LE(found, of / 500) << of;
}

TEST(Compare, FindsSupplyLinkAndPictures) {
  Made b;
  b.seed = 2;
  b.volts = 9.9;
  b.round_trip_s = 0.009;
  RunTrace other = make(b);
  for (auto& picture : other.pictures) picture.delay_s += 0.01;
  other.unanswered = 11;
  const Comparison comparison = compare(make({}), other);
  EXPECT_EQ(differing(comparison),
            "supply.mean supply.lowest link.round_trip link.round_trip_p95 link.unanswered "
            "pictures.delay "
            "pictures.delay_p95 ");
}

// Requests without a reply come now and then where the machine is late.
TEST(Compare, AFewRareEventsMoreAreNoDifference) {
  RunTrace a = make({}), b = make({});
  a.unanswered = 3;
  b.unanswered = 7;
  b.damaged = 1;
  EXPECT_EQ(differing(compare(a, b)), "");
  b.refused = 1;
  EXPECT_EQ(differing(compare(a, b)), "link.refused ");
}

// One ramp, during which the joint is carried at the other side of its play in the other run.
RunTrace ramped(double degrees, double play_deg, std::uint64_t seed) {
  RunTrace trace;
  trace.behavior = "made";
  trace.robot = "virtual";
  trace.duration_s = 10;
  const auto at = [degrees](double t) { return degrees * kDegree * std::clamp(t - 4, 0.0, 1.0); };
  RunTrace::Targets targets{0, 0.02, 1u << kKnee, {}};
  trace.targets.push_back(targets);
  targets.time_s = 4;
  targets.ramp_s = 1;
  targets.angle_rad[kKnee] = degrees * kDegree;
  trace.targets.push_back(targets);
  std::uint64_t drawn = 0;
  for (double t = 0; t < trace.duration_s; t += 0.01) {
    RunTrace::Posture posture{t, {}, 10};
    const bool moves = t > 4 && t < 5.1;
    posture.angle_rad[kKnee] = at(t - 0.02) + (moves ? play_deg * kDegree : 0) +
                               0.1 * kDegree * keyed_normal(seed, ++drawn, 0);
    trace.postures.push_back(posture);
  }
  return trace;
}

TEST(Compare, ALagThatTheMotionDoesNotDetermineIsLeftOut) {
  const Comparison slow = compare(ramped(5, 0.1, 1), ramped(5, -0.1, 2));
  const Measure& lag = find(slow, "l_knee.lag");
  EXPECT_FALSE(lag.comparable());
  EXPECT_NE(lag.left_out.find("half of the gear's backlash can shift the lag by "),
            std::string::npos)
      << lag.left_out;
  EXPECT_TRUE(find(slow, "l_knee.offset").comparable());
  EXPECT_EQ(differing(slow), "");
  // Faster: it is known, as far as the play lets it be.
  const Comparison fast = compare(ramped(40, 0.05, 1), ramped(40, -0.05, 2));
  EXPECT_TRUE(find(fast, "l_knee.lag").comparable());
  EXPECT_EQ(differing(fast), "");
}

TEST(Compare, WhatOneRunHasNotIsNotCompared) {
  RunTrace blind = make({});
  blind.pictures.clear();
  const Comparison comparison = compare(make({}), blind);
  EXPECT_TRUE(find(comparison, "pictures.delay").a.known);
  EXPECT_FALSE(find(comparison, "pictures.delay").comparable());
  EXPECT_FALSE(find(comparison, "pictures.delay").differs());
}

TEST(Compare, SaysWhenTheHostSentOtherTargets) {
  RunTrace b = make({});
  for (auto& targets : b.targets)
    if (targets.time_s >= 4) targets.angle_rad[kKnee] += 0.1;
  const Comparison comparison = compare(make({}), b);
  // A host that is up to 0.1 s late is not another one.
  EXPECT_GE(comparison.same_targets_s, 4);
  EXPECT_LE(comparison.same_targets_s, 4.15);
  ASSERT_EQ(comparison.notes.size(), 1u);
  EXPECT_NE(comparison.notes[0].find("until 4.1 s"), std::string::npos) << comparison.notes[0];
  EXPECT_TRUE(compare(make({}), make({})).notes.empty());
}

TEST(Compare, SaysThatOtherMotionsAreNotComparable) {
  RunTrace b = make({});
  b.behavior = "other";
  const Comparison comparison = compare(make({}), b);
  ASSERT_FALSE(comparison.notes.empty());
  EXPECT_EQ(comparison.notes[0],
            "different behaviors: A ran made, B ran other; measures of different motions are not "
            "comparable");
}

TEST(Compare, SaysThatRunsBeganInOtherPostures) {
  RunTrace b = make({});
  for (auto& posture : b.postures)
    if (posture.time_s < 0.5) posture.angle_rad[kKnee] += 20 * kDegree;
  const Comparison comparison = compare(make({}), b);
  ASSERT_FALSE(comparison.notes.empty());
  EXPECT_NE(comparison.notes[0].find("the runs began in different postures (l_knee at "),
            std::string::npos)
      << comparison.notes[0];
  for (const std::string& note : comparison.notes)
    EXPECT_EQ(note.find("until 0.0 s"), std::string::npos) << note;
}

TEST(Compare, ARecordingThatEndsEarlyIsNamed) {
  RunTrace cut = make({});
  cut.early_end = "the recording was cut off before its run ended";
  const Comparison comparison = compare(make({}), cut);
  ASSERT_EQ(comparison.notes.size(), 1u);
  EXPECT_EQ(comparison.notes[0], "B: the recording was cut off before its run ended");
}

TEST(Compare, CommandsAreRampsFromWhereTheJointStood) {
  RunTrace trace;
  trace.duration_s = 3;
  trace.postures.push_back({0.9, {}, 10});
  trace.postures[0].angle_rad[kKnee] = 0.5;
  RunTrace::Targets targets{1, 1, 1u << kKnee, {}};
  targets.angle_rad[kKnee] = 1.5;
  trace.targets.push_back(targets);
  const CommandCurve curve = command_curve(trace, kKnee);
  EXPECT_FALSE(curve.covers(0.99));
  EXPECT_NEAR(curve.at(1), 0.5, 1e-9);
  EXPECT_NEAR(curve.at(1.25), 0.75, 2e-3);
  EXPECT_NEAR(curve.at(2.5), 1.5, 1e-9);
  EXPECT_TRUE(command_curve(trace, kNeck).angle_rad.empty());
}

}  // namespace
}  // namespace kaz::tools
