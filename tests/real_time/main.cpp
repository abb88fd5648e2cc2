// main() of tests in real time: a failure beside other programs proves nothing.
// SPDX-License-Identifier: Apache-2.0
//
// While the tests run, it measures how long programs of this machine wait for a processor. If a test fails
// and they waited too long, it is tried again; after kAttempts it counts as skipped, with the number. With
// KAZ_TEST_ALONE=1, and outside of CTest, each failure counts.
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kAttempts = 3;
constexpr int kSkipped =
    75;  // SKIP_RETURN_CODE in kaz_test(); ./tools/dev test tries these again, alone
// Above one of these the machine is too slow.
constexpr double kWaitingShare = 0.25;
constexpr std::chrono::milliseconds kLate{20};

// Time in which at least one program waited for a processor, since the start, s; none: this kernel does not
// say (https://docs.kernel.org/accounting/psi.html).
std::optional<double> waiting_s() {
  std::ifstream pressure("/proc/pressure/cpu");
  std::string line;
  std::getline(pressure, line);  // "some avg10=0.00 avg60=0.00 avg300=0.00 total=MICROSECONDS"
  const std::size_t at = line.find("total=");
  if (at == std::string::npos) return std::nullopt;
  return 1e-6 * std::atof(line.c_str() + at + 6);
}

class Machine {
 public:
  ~Machine() {
    ended_ = true;
    thread_.join();
  }
  // Empty: it was fast enough.
  std::string too_slow() const {
    const double took_s = std::chrono::duration<double>(Clock::now() - began_).count();
    const auto waited = waiting_s();
    const double share = waited && waited_before_ ? (*waited - *waited_before_) / took_s : 0;
    const Clock::duration late = latest_;
    if (share < kWaitingShare && late < kLate) return "";
    char text[160];
    std::snprintf(text, sizeof text,
                  "programs waited for a processor %.0f %% of the time (limit %.0f), and this one "
                  "up to %.0f ms (limit %.0f)",
                  100 * share, 100 * kWaitingShare,
                  std::chrono::duration<double, std::milli>(late).count(),
                  std::chrono::duration<double, std::milli>(kLate).count());
    return text;
  }

 private:
  void watch() {
    while (!ended_) {
      const auto due = Clock::now() + std::chrono::milliseconds(2);
      std::this_thread::sleep_until(due);
      latest_ = std::max(latest_.load(), Clock::now() - due);
    }
  }

  const Clock::time_point began_ = Clock::now();
  const std::optional<double> waited_before_ = waiting_s();
  std::atomic<Clock::duration> latest_{Clock::duration::zero()};
  std::atomic<bool> ended_ = false;
  std::thread thread_{[this] { watch(); }};
};

bool is_set(const char* name) {
  return std::getenv(name) != nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<char*> arguments(argv, argv + argc + 1);  // InitGoogleTest() removes its own
  testing::InitGoogleTest(&argc, argv);
  const Machine machine;
  const int result = RUN_ALL_TESTS();
  if (result == 0 || is_set("KAZ_TEST_ALONE") || !is_set("KAZ_TEST_MAY_SKIP")) return result;
  const std::string slow = machine.too_slow();
  if (slow.empty()) return result;
  const char* const before = std::getenv("KAZ_TEST_ATTEMPT");
  const int attempt = before == nullptr ? 1 : std::atoi(before);
  std::printf("machine too slow: %s; failed %d of %d times\n", slow.c_str(), attempt, kAttempts);
  std::fflush(stdout);
  if (attempt >= kAttempts) return kSkipped;
  setenv("KAZ_TEST_ATTEMPT", std::to_string(attempt + 1).c_str(), 1);
  execv("/proc/self/exe", arguments.data());
  return result;
}
