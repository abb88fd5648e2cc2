// Score, phases and fit of the contact study. Generated tosses show only that the bench works: they say
// nothing about the contact of a real cube.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "shared/base/files.hpp"
#include "tests/studies/contact/generated_testing.h"
#include "tests/studies/contact/report.h"

namespace kaz::contact {
namespace {

using Eigen::AngleAxisd, Eigen::Quaterniond, Eigen::Vector3d;

TEST(ContactScore, OfPosesIsDistanceAndAngleSquared) {
  const Pose origin, moved{{0, 2 * kHalf, 0}, Quaterniond::Identity()},
      turned{{0, 0, 0}, Quaterniond(AngleAxisd(0.7, Vector3d::UnitX()))};
  EXPECT_DOUBLE_EQ(pose_error(origin, origin), 0);
  EXPECT_NEAR(pose_error(origin, moved), 4, 1e-12);
  EXPECT_NEAR(pose_error(origin, turned), 0.49, 1e-12);
  // q and -q are the same orientation.
  EXPECT_NEAR(pose_error(origin, {{0, 0, 0}, Quaterniond(-turned.turn.coeffs())}), 0.49, 1e-12);
  EXPECT_NEAR(path_error({origin, origin, origin, origin}, {origin, moved, turned, origin}),
              4.49 / 4, 1e-12);
}

TEST(ContactScore, IntervalsCoverTheMeanAndPairTheTosses) {
  std::vector<double> a, b;
  for (int i = 0; i < 200; ++i) {
    b.push_back(1 + i % 7);
    a.push_back(0.5 * b.back());
  }
  const Interval interval = bootstrap_mean(b, 1);
  // The standard error of a mean over 200 values with the standard deviation 2 is 0.141.
  EXPECT_NEAR(interval.high - interval.low, 2 * 1.96 * 0.141, 0.04);
  EXPECT_LT(interval.low, mean(b));
  EXPECT_GT(interval.high, mean(b));
  const Interval ratio = bootstrap_ratio(a, b, 1);
  EXPECT_DOUBLE_EQ(ratio.low, 0.5);
  EXPECT_DOUBLE_EQ(ratio.high, 0.5);
  EXPECT_DOUBLE_EQ(median(std::vector{3.0, 1.0, 8.0, 2.0}), 2.5);
}

// Eight samples of free flight with an impact at sample 3, another one at 7, then sliding and rest.
Toss staged_toss() {
  Toss toss;
  toss.path.resize(12);
  toss.velocity.resize(12, Vector3d::Zero());
  toss.spin.resize(12, Vector3d(5, 0, 0));
  for (std::size_t i = 0; i < 12; ++i)
    toss.velocity[i] = {0.3, 0,
                        (i < 3   ? -1
                         : i < 7 ? 1
                                 : 2) -
                            kGravity / kRate * static_cast<double>(i)};
  for (std::size_t i = 9; i < 12; ++i) toss.spin[i].setZero();
  toss.velocity[11].setZero();
  return toss;
}

TEST(ContactPhases, FollowTheMeasuredVelocities) {
  const std::vector<Phase> phases = phases_of(staged_toss());
  const auto expected = {Phase::flight,       Phase::flight,       Phase::flight,
                         Phase::first_impact, Phase::first_impact, Phase::first_impact,
                         Phase::first_impact, Phase::rocking,      Phase::rocking,
                         Phase::sliding,      Phase::sliding,      Phase::rest};
  EXPECT_EQ(phases, std::vector<Phase>(expected));
}

TEST(ContactPhases, ContributionsSumUpToTheError) {
  const Toss toss = staged_toss();
  Path off = toss.path;
  for (std::size_t i = 0; i < off.size(); ++i)
    off[i].at.x() = 0.01 * static_cast<double>(i * i % 7);
  const PhaseErrors errors = phase_errors(toss, off);
  double sum = 0;
  for (const double error : errors) sum += error;
  EXPECT_NEAR(sum, path_error(toss.path, off), 1e-12);
  // A jump in one interval belongs to the phase of this interval.
  Path jump = toss.path;
  for (std::size_t i = 9; i < jump.size(); ++i) jump[i].at.x() = kHalf;
  EXPECT_NEAR(phase_errors(toss, jump)[static_cast<std::size_t>(Phase::sliding)], 3.0 / 12, 1e-12);
}

TEST(ContactPhases, FinalFaceIsTheUpperOne) {
  EXPECT_EQ(final_face({Pose{}}), 4);
  EXPECT_EQ(final_face({{{0, 0, 0}, Quaterniond(AngleAxisd(M_PI, Vector3d::UnitX()))}}), 5);
  // A quarter turn about y takes the body's -x axis to the top.
  EXPECT_EQ(final_face({{{0, 0, 0}, Quaterniond(AngleAxisd(M_PI / 2, Vector3d::UnitY()))}}), 1);
}

// In free flight, each engine follows the parabola, and the cube turns about a constant axis.
TEST(ContactEngines, FlyFromTheFirstSample) {
  Toss toss;
  toss.path.resize(10, {{0, 0, 5}, Quaterniond(AngleAxisd(1, Vector3d(1, 2, 3).normalized()))});
  toss.velocity.resize(10, {1, -2, 0.5});
  toss.spin.resize(10, {3, -4, 5});
  for (const std::string& name : engine_names()) {
    SCOPED_TRACE(name);
    const auto engine = engine_of(name, 10);
    ASSERT_TRUE(engine) << engine.error().message;
    const auto path = engine->simulate(toss, engine->start());
    ASSERT_TRUE(path) << path.error().message;
    ASSERT_EQ(path->size(), 10U);
    const double time = 9 / kRate;
    // The semi-implicit Euler method is off by g t h / 2 = 0.2 mm.
    EXPECT_LT((path->back().at - toss.path[0].at - time * Vector3d(1, -2, 0.5) +
               Vector3d(0, 0, kGravity * time * time / 2))
                  .norm(),
              2.5e-4);
    const Quaterniond turn(AngleAxisd(time * std::sqrt(50.0), Vector3d(3, -4, 5).normalized()));
    EXPECT_LT(path->back().turn.angularDistance(turn * toss.path[0].turn), 1e-4);
  }
}

TEST(ContactEngines, OfUnknownNamesAreRejected) {
  EXPECT_EQ(engine_of("bullet", 10).error().fault, Fault::usage);
  EXPECT_EQ(engine_of("quick0", 10).error().fault, Fault::usage);
}

TEST(ContactFit, RecoversTheParametersOfGeneratedTosses) {
  const auto engine = kaz_engine("reduced", 4);
  ASSERT_TRUE(engine);
  const std::vector<double> truth{0.3, 0.3, 3e-3, -0.002};
  const std::vector<Toss> tosses = test::generated_tosses(*engine, truth, 12, 45);
  const auto fit = fit_engine(*engine, tosses, {.generations = 24});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_EQ(fit->evaluations, 24 * 8 + 1);
  const auto at_start = toss_errors(*engine, tosses, engine->start(), 1);
  ASSERT_TRUE(at_start);
  EXPECT_LT(fit->score, 0.1 * mean(*at_start));
  EXPECT_NEAR(fit->values[0] / truth[0], 1, 0.05);
  EXPECT_NEAR(fit->values[1], truth[1], 0.12);
  // Impacts do not depend on the softness. It only lowers a cube at rest, by some 0.1 mm, as a lower floor
  // does, so the tosses do not determine the two apart.
  EXPECT_NEAR(fit->values[3], truth[3], 5e-4);
}

TEST(ContactStudy, JudgesEachFoldByTheOtherAndIsDeterministic) {
  const auto engine = kaz_engine("reduced", 4);
  ASSERT_TRUE(engine);
  const std::vector<double> truth{0.3, 0.3, 3e-3, -0.002};
  const std::vector<Toss> tosses = test::generated_tosses(*engine, truth, 8, 30);
  EXPECT_EQ(fold_of(tosses[2]), 0);
  EXPECT_EQ(fold_of(tosses[3]), 1);
  // The tosses of fold 1 are judged with the values of fold 0, which are exact.
  const auto judged = judge(*engine, tosses, {truth, engine->start()}, 2);
  ASSERT_TRUE(judged) << judged.error().message;
  EXPECT_DOUBLE_EQ(judged->errors[3], 0);
  EXPECT_GT(judged->errors[2], 1e-4);
  EXPECT_EQ(judged->wrong[3], 0);
  const auto fit = [&](int jobs) {
    return fit_folds(*engine, tosses, {.generations = 2, .population = 4, .jobs = jobs}, {})
        .value();
  };
  const auto one = fit(1), three = fit(3);
  for (std::size_t fold = 0; fold < 2; ++fold) EXPECT_EQ(one[fold].values, three[fold].values);
}

TEST(ContactReport, IsReadBackAndDrawn) {
  const auto engine = kaz_engine("reduced", 4);
  ASSERT_TRUE(engine);
  const std::vector<Toss> tosses = test::generated_tosses(*engine, engine->start(), 8, 30);
  Row row{*engine, {}, {}};
  row.fits = {Fit{{0.2, 0.1, 1e-3, 0}, 0.4, 9}, Fit{{0.3, 0.2, 1e-2, -1e-3}, 0.5, 9}};
  row.judged = judge(*engine, tosses, {row.fits[0].values, row.fits[1].values}, 1).value();
  const std::vector<Row> rows{row};
  const std::string text = json(rows, tosses, 1);
  const auto fits = read_fits(text, "contact.json", *engine);
  ASSERT_TRUE(fits) << fits.error().message;
  for (std::size_t fold = 0; fold < 2; ++fold)
    EXPECT_EQ((*fits)[fold].values, row.fits[fold].values);
  EXPECT_NE(markdown(rows, 1).find("| reduced | "), std::string::npos);
  EXPECT_TRUE(csv(rows, tosses).starts_with("toss,fold,reduced\n0,1,"));
  const std::string folder = make_temporary_folder("contact").value();
  EXPECT_TRUE(write_pictures(folder, rows, tosses));
  EXPECT_GT(std::filesystem::file_size(folder + "/toss-50.svg"), 2000U);
  std::filesystem::remove_all(folder);
}

TEST(ContactReport, RejectsBadFits) {
  const auto engine = kaz_engine("reduced", 4);
  ASSERT_TRUE(engine);
  const auto expect_error = [&](const std::string& text, const std::string& part) {
    const auto fits = read_fits(text, "f.json", *engine);
    ASSERT_FALSE(fits) << text;
    EXPECT_EQ(fits.error().fault, Fault::usage);
    EXPECT_NE(fits.error().message.find(part), std::string::npos) << fits.error().message;
  };
  expect_error("{", "f.json: ");
  expect_error("[]", "has no two fits of the engine reduced");
  expect_error(R"({"rows":[{"engine":"exact"}, 3]})", "has no two fits of the engine reduced");
  expect_error(R"({"rows":[{"engine":"reduced","fits":[{},{}]}]})", "has no number `score`");
  const std::string fit =
      R"({"score":1,"values":{"mu":2,"restitution":0,"softness":0.01,"floor":0}})";
  expect_error(R"({"rows":[{"engine":"reduced","fits":[)" + fit + "," + fit + "]}]}",
               "mu is 2; must be 0.02 to 1");
}

}  // namespace
}  // namespace kaz::contact
