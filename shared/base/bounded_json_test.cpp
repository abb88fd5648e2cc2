// JSON texts that nest too deeply, hide that behind comments, or say something twice.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/bounded_json.hpp"

#include <gtest/gtest.h>

namespace kaz {
namespace {

std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

std::string refusal(std::string_view text, JsonComments comments = JsonComments::refused) {
  const auto parsed = parse_bounded_json(text, comments);
  return parsed ? "" : parsed.error().message;
}

TEST(BoundedJson, ReadsValuesUpToItsDepth) {
  EXPECT_EQ(parse_bounded_json(R"({"a": [1, "]]]", null]})").value().dump(),
            R"({"a":[1,"]]]",null]})");
  EXPECT_EQ(parse_bounded_json<nlohmann::ordered_json>(R"({"b":1,"a":2})").value().dump(),
            R"({"b":1,"a":2})");
  EXPECT_EQ(refusal(nested(kJsonDepthMax)), "");
  EXPECT_EQ(refusal(nested(kJsonDepthMax + 1)), "it nests deeper than 64 levels");
  EXPECT_EQ(refusal(std::string(1'000'000, '[')), "it nests deeper than 64 levels");
}

// The parser that skips comments decides what a bracket is.
TEST(BoundedJson, CommentsHideNoLevels) {
  const std::string deep = nested(30'000);
  for (const char* comment : {"//\"\n", "/* \" */", "/* [ */ //\\\"\n"}) {
    EXPECT_EQ(refusal(comment + deep, JsonComments::ignored), "it nests deeper than 64 levels");
    EXPECT_EQ(refusal(comment + nested(64), JsonComments::ignored), "") << comment;
    EXPECT_EQ(refusal(comment + deep), "line 1 is not valid JSON");
  }
}

TEST(BoundedJson, SaysInOneSentenceWhatIsWrong) {
  EXPECT_EQ(refusal("{\n\"a\": 1,\n}"), "line 3 is not valid JSON");
  EXPECT_EQ(refusal(""), "line 1 is not valid JSON");
  EXPECT_EQ(refusal("[1,\n1e999]"),
            "line 2: the number 1e999 is too large: the limit is 1.8e308; give a smaller one");
  EXPECT_EQ(refusal("-1" + std::string(50'000, '0') + ".5"),
            "line 1: the number -1" + std::string(78, '0') +
                "... is too large: the limit is 1.8e308; give a smaller one");
  EXPECT_EQ(refusal(R"({"a": {"b": 1}, "b": 2})"), "");
  EXPECT_EQ(refusal(R"({"a": {"b": 1, "b": 2}})"),
            "the key \"b\" occurs twice in one object; remove one");
  const std::string key(50'000, 'k');
  EXPECT_EQ(refusal("{\"" + key + "\":1,\"" + key + "\":1}"),
            "the key \"" + key.substr(0, 80) + "...\" occurs twice in one object; remove one");
}

TEST(BoundedJson, ASampleOfAValueIsShort) {
  EXPECT_EQ(json_sample(nlohmann::json({1, "a"})), R"([1,"a"])");
  EXPECT_EQ(json_sample(nlohmann::json(std::string(50'000, 'x'))),
            "\"" + std::string(79, 'x') + "...");
}

}  // namespace
}  // namespace kaz
