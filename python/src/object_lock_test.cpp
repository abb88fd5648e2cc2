// Threads on one object: refused while another's call runs, ended by a stop.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/object_lock.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "host/link/wall_clock.h"

namespace kaz::python {
namespace {

using namespace std::chrono_literals;
using Call = ObjectLock::Call;
using State = Call::State;

State begun_elsewhere(ObjectLock& lock) {
  State state{};
  std::jthread([&] { state = Call(lock).state(); }).join();
  return state;
}

TEST(ObjectLock, RefusesTheCallOfASecondThreadUntilTheFirstHasReturned) {
  ObjectLock lock("this Thing");
  {
    Call call(lock);
    EXPECT_EQ(call.state(), State::begun);
    EXPECT_EQ(begun_elsewhere(lock), State::in_use) << "between two pieces, too";
    ASSERT_TRUE(call.enter());
    EXPECT_EQ(begun_elsewhere(lock), State::in_use);
    call.leave();
    EXPECT_EQ(Call(lock).state(), State::begun) << "of the same thread: a signal handler's";
    EXPECT_EQ(begun_elsewhere(lock), State::in_use) << "the outer call still runs";
  }
  EXPECT_EQ(begun_elsewhere(lock), State::begun);
}

TEST(ObjectLock, AStopEndsAWaitingCallAndTheObjectIsUsableAfterwards) {
  ObjectLock lock("this Thing");
  host::WallClock clock(&lock.interrupt());
  std::atomic<bool> waits{false};
  Result<void> slept;
  bool entered_again = true;
  std::jthread caller([&] {
    Call call(lock);
    ASSERT_TRUE(call.enter());
    waits = true;
    slept = clock.sleep_until(clock.now() + 1h);
    call.leave();
    entered_again = call.enter();
  });
  while (!waits) std::this_thread::yield();
  {
    const ObjectLock::Stop stop(lock);
    EXPECT_EQ(begun_elsewhere(lock), State::stopping);
    EXPECT_TRUE(clock.sleep_until(clock.now() + 1ms)) << "a stop waits for its reply";
  }
  caller.join();
  ASSERT_FALSE(slept);
  EXPECT_EQ(slept.error().fault, Fault::interrupted);
  EXPECT_FALSE(entered_again) << "a call that was stopped must not go on";
  Call next(lock);
  ASSERT_TRUE(next.enter());
  EXPECT_TRUE(clock.sleep_until(clock.now() + 1ms));
  next.leave();
}

TEST(ObjectLock, AStopBetweenTwoPiecesEndsTheCall) {
  ObjectLock lock("this Thing");
  Call call(lock);
  ASSERT_TRUE(call.enter());
  call.leave();
  { const ObjectLock::Stop stop(lock); }
  EXPECT_EQ(begun_elsewhere(lock), State::begun) << "after stop() has returned others may call";
  EXPECT_FALSE(call.enter());
}

// For the thread sanitizer: `value` has no lock of its own.
TEST(ObjectLock, KeepsThreadsApart) {
  ObjectLock lock("this Thing");
  host::WallClock clock(&lock.interrupt());
  long value = 0;
  std::atomic<long> added{0};
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 3; ++i) {
      threads.emplace_back([&] {
        for (int k = 0; k < 300; ++k) {
          Call call(lock);
          for (int piece = 0; piece < 2 && call.enter(); ++piece) {
            ++value, ++added;
            (void)clock.sleep_until(clock.now() + 20us);
            call.leave();
          }
        }
      });
    }
    for (int i = 0; i < 2; ++i) {
      threads.emplace_back([&] {
        for (int k = 0; k < 100; ++k) {
          const ObjectLock::Stop stop(lock);
          ++value, ++added;
          EXPECT_TRUE(clock.sleep_until(clock.now() + 20us)) << "one stop ends another";
        }
      });
    }
  }
  EXPECT_EQ(value, added);
  EXPECT_GE(value, 200);
  EXPECT_FALSE(lock.interrupt().requested());
}

}  // namespace
}  // namespace kaz::python
