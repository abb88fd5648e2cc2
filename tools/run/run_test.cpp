// The results of a run are written only if the observer keeps them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

class Keeper final : public RunObserver {
 public:
  explicit Keeper(bool keeps) : keeps_(keeps) {}
  void ended(const Result<behavior::Outcome>&, double, double) override { ended_ = true; }
  bool is_worth_keeping() override {
    EXPECT_TRUE(ended_);
    return keeps_;
  }

 private:
  bool keeps_, ended_ = false;
};

TEST(Run, WritesResultsOfARunThatIsWorthKeeping) {
  for (const bool keeps : {true, false}) {
    SCOPED_TRACE(keeps);
    const std::string folder = make_temporary_folder("kaz-session-").value();
    RunOptions options;
    options.behavior = "stand";
    options.backend.mcu = sim::McuKind::native;
    options.out = folder + "/out";
    options.quiet = options.json = true;
    Keeper keeper(keeps);
    const auto ran = run(options, keeper);
    ASSERT_TRUE(ran) << ran.error().message;
    EXPECT_TRUE(*ran);
    EXPECT_EQ(fs::exists(folder + "/out/result.json"), keeps);
    EXPECT_EQ(fs::exists(folder + "/out/recording.mcap"), keeps);
    EXPECT_FALSE(fs::exists(folder + "/out/recording.mcap.part"));
    fs::remove_all(folder);
  }
}

}  // namespace
}  // namespace kaz::tools
