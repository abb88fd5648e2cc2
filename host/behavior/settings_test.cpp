// Weights of a file take the place of its name.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <string>

#include "host/behavior/plugin.h"
#include "host/motion/balance.h"

namespace kaz::behavior {
namespace {

using Settings = std::map<std::string, std::string>;

TEST(Settings, BecomesTheWeightsOfTheFile) {
  const std::string path = testing::TempDir() + "weights.inc";
  std::ofstream file(path);
  file << "// trained\n";
  for (int i = 0; i < motion::BalancePolicy::kWeights; ++i) file << 0.5 * i << ",\n";
  file.close();
  Settings settings{{"balance", path}, {"distance", "1"}};
  const auto loaded = load_settings("go-forward", settings);
  ASSERT_TRUE(loaded) << loaded.error().message;
  std::remove(path.c_str());
  EXPECT_EQ(settings["balance"].find_first_of("/\n"), std::string::npos) << settings["balance"];
  EXPECT_TRUE(motion::BalancePolicy::parse(settings["balance"], "setting"));
  EXPECT_EQ(settings["distance"], "1");
  // Once more, as another program has it from this one's arguments: the file is gone.
  const Settings before = settings;
  ASSERT_TRUE(load_settings("go-forward", settings));
  EXPECT_EQ(settings, before);
}

TEST(Settings, LeavesWordsAndOtherBehaviorsAlone) {
  for (const std::string word : {"none", "learned"}) {
    Settings settings{{"balance", word}};
    ASSERT_TRUE(load_settings("go-forward", settings));
    EXPECT_EQ(settings["balance"], word);
  }
  Settings settings{{"balance", "/nowhere"}};
  EXPECT_TRUE(load_settings("./own.so", settings));
  EXPECT_EQ(settings["balance"], "/nowhere");
}

TEST(Settings, NamesAFileThatIsNotThere) {
  Settings settings{{"balance", "/nowhere"}};
  const auto loaded = load_settings("go-forward", settings);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("/nowhere: cannot be read"), std::string::npos);
  EXPECT_NE(loaded.error().message.find("give balance=none"), std::string::npos);
}

}  // namespace
}  // namespace kaz::behavior
