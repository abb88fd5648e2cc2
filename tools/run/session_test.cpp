// Sessions: what is written of a run that is worth keeping, and of one that is not.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/session.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

TEST(Session, WritesResultsOfARunThatIsWorthKeeping) {
  for (const bool keeps : {true, false}) {
    SCOPED_TRACE(keeps);
    const std::string folder = make_temporary_folder("kaz-session-").value();
    SessionOptions options;
    options.behavior = "stand";
    options.backend.mcu = sim::McuKind::native;
    options.out = folder + "/out";
    options.quiet = options.json = true;
    bool ended = false;
    options.on_end = [&](const Result<behavior::Outcome>&, double, double) { ended = true; };
    options.worth_keeping = [&] {
      EXPECT_TRUE(ended);
      return keeps;
    };
    const auto ran = run_session(options);
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
