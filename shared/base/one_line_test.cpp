// Text from outside stays on its line, and in XML.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/one_line.hpp"

#include <gtest/gtest.h>

#include "shared/base/xml_text.hpp"

namespace kaz {
namespace {

TEST(OneLine, KeepsWordsAndTakesControlCharactersAway) {
  EXPECT_EQ(one_line("Kaz µ 機"), "Kaz µ 機");
  EXPECT_EQ(one_line("a\nb\r\tc"), "a b  c");
  EXPECT_EQ(one_line(std::string_view("\x1b[2J\0\x7f", 6)), "\\x1b[2J\\x00\\x7f");
  EXPECT_EQ(one_line("\xc2\x9b"
                     "2J"),
            "\\xc2\\x9b"
            "2J");
}

TEST(OneLine, BytesThatAreNoUtf8AreNamed) {
  EXPECT_EQ(one_line("a\xff"), "a\\xff");
  EXPECT_EQ(one_line("\xc3"), "\\xc3");                    // cut off
  EXPECT_EQ(one_line("\xc0\xaf"), "\\xc0\\xaf");           // overlong
  EXPECT_EQ(one_line("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // surrogate
  EXPECT_EQ(one_line("\xf0\x9f\x98\x80"), "\xf0\x9f\x98\x80");
}

TEST(CutText, EndsBetweenCharacters) {
  EXPECT_EQ(cut_text("abc", 3), "abc");
  EXPECT_EQ(cut_text("abcd", 3), "abc...");
  EXPECT_EQ(cut_text("ab\xc2\xb5z", 3), "ab...");
  EXPECT_EQ(cut_text("\xf0\x9f\x98\x80\x80", 4), "...") << "no whole character, and none of its bytes";
}

TEST(XmlText, HasNoCharacterThatXmlForbids) {
  EXPECT_EQ(xml_text("<a b='c' d=\"&\">"), "&lt;a b=&apos;c&apos; d=&quot;&amp;&quot;&gt;");
  EXPECT_EQ(xml_text("a\nb\tc"), "a\nb\tc");
  EXPECT_EQ(xml_text("a\x01\x1b\xff"), "a\\x01\\x1b\\xff");
}

}  // namespace
}  // namespace kaz
