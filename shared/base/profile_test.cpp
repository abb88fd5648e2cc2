// Time belongs to the innermost scope of its thread.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/profile.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace kaz {
namespace {

constexpr double kWork_s = 0.005;

double cpu_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void compute() {
  const double until = cpu_s(CLOCK_THREAD_CPUTIME_ID) + kWork_s;
  while (cpu_s(CLOCK_THREAD_CPUTIME_ID) < until) {
  }
}

void sleep() {
  std::this_thread::sleep_for(std::chrono::duration<double>(kWork_s));
}

Profile::Part part(const Profile& profile, const std::string& name) {
  for (const auto& one : profile.parts()) {
    if (one.name == name) return one;
  }
  ADD_FAILURE() << name;
  return {};
}

TEST(Profile, TimeBelongsToTheInnermostScope) {
  const double before_s = cpu_s(CLOCK_THREAD_CPUTIME_ID);
  const Profile profile;
  {
    const ProfileScope outer("outer");
    sleep();
    for (int i = 0; i < 3; ++i) {
      const ProfileScope inner("inner");
      compute();
    }
    compute();
  }
  const double all_s = cpu_s(CLOCK_THREAD_CPUTIME_ID) - before_s;
  const auto outer = part(profile, "outer"), inner = part(profile, "inner");
  EXPECT_GE(inner.cpu_s, 3 * kWork_s);
  EXPECT_GE(outer.cpu_s, kWork_s);
  EXPECT_LE(outer.cpu_s + inner.cpu_s, all_s) << "nothing counts twice";
  EXPECT_GE(outer.waiting_s, kWork_s) << "sleeping is waiting";
  EXPECT_EQ(outer.count, 1u);
  EXPECT_EQ(inner.count, 3u);
  EXPECT_EQ(profile.parts().front().name, "inner") << "the most expensive first";
}

TEST(Profile, ThreadsAreNamedByTheirFirstScope) {
  const Profile profile;
  const auto work = [] {
    const ProfileScope scope("drawing");
    compute();
  };
  std::thread first(work);
  first.join();
  std::thread second(work);
  second.join();
  EXPECT_GE(part(profile, "drawing").cpu_s, 2 * kWork_s);
  const auto threads = profile.threads();
  ASSERT_EQ(threads.size(), 2u);
  EXPECT_NE(threads[0].name, threads[1].name);
  for (const auto& thread : threads) {
    EXPECT_TRUE(thread.name.starts_with("drawing")) << thread.name;
    EXPECT_GE(thread.cpu_s, kWork_s);
  }
}

TEST(Profile, ScopesOutsideOfAProfileDoNotCount) {
  {
    const ProfileScope without("before");
    compute();
  }
  auto first = std::make_unique<Profile>();
  auto across = std::make_unique<ProfileScope>("across");
  first.reset();
  const Profile second;
  {
    const ProfileScope scope("second");
    compute();
    across.reset();  // of the first: ends without effect
  }
  ASSERT_EQ(second.parts().size(), 1u);
  EXPECT_EQ(second.parts()[0].name, "second");
  EXPECT_GE(second.parts()[0].cpu_s, kWork_s);
}

}  // namespace
}  // namespace kaz
