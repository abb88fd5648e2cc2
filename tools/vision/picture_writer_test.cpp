// Pictures are written beside the work, all of them unless an interrupt comes.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision/picture_writer.h"

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include <gtest/gtest.h>

namespace kaz::tools {
namespace {

TEST(PictureWriter, WritesAllAndKeepsTheFirstError) {
  PictureWriter writer([] { return false; });
  std::atomic<int> written{0};
  for (int i = 0; i < 5; ++i)
    writer.add([&written, i]() -> Result<void> {
      ++written;
      if (i >= 3) return fail(Fault::environment, "number " + std::to_string(i));
      return {};
    });
  const auto ended = writer.finish();
  EXPECT_EQ(written, 5);
  EXPECT_EQ(writer.dropped(), 0u);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().message, "number 3");
}

// An interrupt comes while the caller waits for a place behind a picture that takes long: the caller goes on
// at once, and of all that waited nothing is written.
TEST(PictureWriter, DropsWhatWaitsAtAnInterrupt) {
  constexpr std::size_t kWaiting = PictureWriter::kMostWaiting;
  std::atomic<bool> interrupted{false};
  std::promise<void> slow_one_ends;
  PictureWriter writer([&] { return interrupted.load(); });
  std::atomic<int> written{0};
  writer.add([&, ends = slow_one_ends.get_future().share()]() -> Result<void> {
    ends.wait();
    ++written;
    return {};
  });
  for (std::size_t i = 0; i < kWaiting; ++i)
    writer.add([&]() -> Result<void> {
      ++written;
      return {};
    });
  // Ends the slow one when the rest is dropped, or at last, so that a failure does not hang.
  const std::jthread helper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    interrupted = true;
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (writer.dropped() < kWaiting + 1 && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    slow_one_ends.set_value();
  });
  writer.add([&]() -> Result<void> {
    ++written;
    return {};
  });
  EXPECT_EQ(writer.dropped(), 1u) << "the last one did not wait for a place";
  EXPECT_TRUE(writer.finish());
  EXPECT_EQ(writer.dropped(), kWaiting + 1);
  EXPECT_EQ(written, 1) << "the one under way";
}

}  // namespace
}  // namespace kaz::tools
