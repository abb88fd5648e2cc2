// Wrong values in the headers of generated logs.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/input_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "hil/servo/fit_sums.h"
#include "hil/servo/truth_log_testing.h"

namespace kaz::hil {
namespace {

using truth::Motion;

// Three weights, three gains and two motions of a servo that is richer than the models.
const std::vector<ServoLog>& right_logs() {
  static const std::vector<ServoLog> logs = [] {
    std::vector<ServoLog> all;
    const truth::Planted planted{0.02, 5, 0.005, 0.05, 0, false};
    for (const double mass : {1.0, 0.75, 0.5}) {
      for (const double gain : {1.0, 0.5, 0.25}) {
        for (const Motion motion : {Motion::two_sines, Motion::sine_of_square}) {
          all.push_back(log_of(truth::swing(3, motion, mass, gain, 4, planted)));
          all.back().name = "log " + std::to_string(all.size());
          all.back().motion = motion == Motion::two_sines ? "sines" : "chirp";
        }
      }
    }
    return all;
  }();
  return logs;
}

std::vector<WrongInput> found(const std::function<void(std::size_t, ServoLog&)>& spoil) {
  std::vector<ServoLog> logs = right_logs();
  for (std::size_t i = 0; i < logs.size(); ++i) spoil(i, logs[i]);
  ServoFitOptions options;
  options.models = {3};
  const auto fits = fit_servo(logs, {}, options);
  if (!fits) {
    ADD_FAILURE() << fits.error().message;
    return {};
  }
  return wrong_inputs(fits->back(), logs, options);
}

// Expects that exactly the spoiled value is reported, with the factor that repairs it.
void expect_one(const std::vector<WrongInput>& wrong, const std::string& quantity, double factor,
                const std::string& logs) {
  std::string all;
  for (const WrongInput& one : wrong) all += sentence_of(one) + "\n";
  ASSERT_EQ(wrong.size(), 1u) << quantity << " " << factor << "\n" << all;
  EXPECT_EQ(wrong[0].quantity, quantity) << all;
  EXPECT_NEAR(wrong[0].factor, factor, 0.1 * factor) << all;
  EXPECT_NE(wrong[0].logs.find(logs), std::string::npos) << all;
}

TEST(InputChecks, FindNothingInRightLogs) {
  const auto wrong = found([](std::size_t, ServoLog&) {});
  EXPECT_TRUE(wrong.empty()) << sentence_of(wrong[0]);
}

TEST(InputChecks, FindTheWrongGainOfAGroup) {
  const double middle = right_logs()[2].gain_per_rad;
  for (const double factor : {0.7, 1.3}) {
    const auto wrong = found([&](std::size_t, ServoLog& log) {
      if (log.gain_per_rad == middle) log.gain_per_rad *= factor;
    });
    expect_one(wrong, "gain", 1 / factor, "gain");
  }
}

TEST(InputChecks, FindTheWrongMassOrLengthOfARig) {
  const double middle = right_logs()[6].mass_kg;
  for (double ServoLog::*value : {&ServoLog::mass_kg, &ServoLog::length_m}) {
    for (const double factor : {0.7, 1.3}) {
      const auto wrong = found([&](std::size_t, ServoLog& log) {
        if (log.mass_kg == middle) log.*value *= factor;
      });
      const auto weight =
          std::ranges::find(wrong, std::string("weight (mass or length)"), &WrongInput::quantity);
      ASSERT_NE(weight, wrong.end()) << factor;
      EXPECT_NEAR(weight->factor, 1 / factor, 0.15 / factor);
      for (const WrongInput& one : wrong) EXPECT_EQ(one.logs, weight->logs) << sentence_of(one);
    }
  }
}

TEST(InputChecks, FindTheWrongGainOrTimeOfOneLog) {
  for (const double factor : {0.7, 1.3}) {
    for (const auto& [quantity, name] :
         {std::pair{Stated::gain, "gain"}, {Stated::time, "time stamps"}}) {
      const auto wrong = found([&, q = quantity](std::size_t i, ServoLog& log) {
        if (i == 3) scale_stated(log, q, factor);
      });
      expect_one(wrong, name, 1 / factor, "log 4");
    }
  }
}

TEST(InputChecks, NameBothOfTwoGroups) {
  const WrongInput one{"logs with gain 2", "gain", 1.3, 0.01, "gain 4"};
  EXPECT_EQ(sentence_of(one),
            "logs with gain 2: the gain fits 1.30 times the stated value relative to gain 4; check "
            "both");
}

}  // namespace
}  // namespace kaz::hil
