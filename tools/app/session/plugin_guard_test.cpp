// The errors that exceptions become.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/plugin_guard.h"

#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tools/app/session/plugin_symbol.h"

namespace kaz::tools {
namespace {

template <class Thrown>
Error error_of(const Thrown& thrown) {
  try {
    throw thrown;
  } catch (...) {
    return thrown_error("./wave.so");
  }
}

TEST(ThrownError, NamesTypeAndText) {
  const Error logic = error_of(std::logic_error("no arm"));
  EXPECT_EQ(logic.fault, Fault::failed);
  EXPECT_EQ(logic.message, "./wave.so threw std::logic_error: no arm");
  EXPECT_EQ(error_of(7).message, "./wave.so threw int");
  EXPECT_EQ(error_of(7).fault, Fault::failed);
  EXPECT_EQ(error_of(std::bad_alloc()).fault, Fault::environment) << "the machine's";
}

TEST(ThrownError, ABehaviourOfKazNeedsNoGuard) {
  EXPECT_TRUE(guarded_behavior("stand", "test"));
  const auto none = guarded_behavior("./none.so", "test");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().fault, Fault::usage);
}

TEST(FunctionAt, OfWhatIsNoObjectIsEmpty) {
  EXPECT_EQ(function_at("/nowhere.so", 16), "");
  EXPECT_EQ(function_at("README.md", 16), "");
  EXPECT_EQ(function_at("/proc/self/exe", 0), "");
}

}  // namespace
}  // namespace kaz::tools
