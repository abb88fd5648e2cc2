// The monitor's lines fit into its window, whatever its size.
// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/board_view.h"

#include <gtest/gtest.h>

#include "shared/base/one_line.hpp"

namespace kaz::tools {
namespace {

BoardView board() {
  BoardView view;
  view.port = "/dev/serial/by-id/a-very-long-name-of-an-adapter";
  view.there = true;
  view.joints.resize(KZ_JOINTS);
  return view;
}

std::string text_of(const Line& line) {
  std::string text;
  for (const Span& span : line) text += span.text;
  return text;
}

std::size_t columns_of(const std::string& text) {
  std::size_t columns = 0;
  for (std::size_t at = 0; at < text.size(); ++columns)
    at += std::max<std::size_t>(1, utf8_length(text, at));
  return columns;
}

TEST(BoardView, FitsIntoAnyWindow) {
  BoardView view = board();
  view.fault =
      "a fault with a long sentence that says what happened and what is to be done about it";
  for (int rows = 0; rows <= 30; ++rows) {
    for (int columns = 0; columns <= 100; ++columns) {
      const auto all = lines(view, 9, "", rows, columns);
      ASSERT_LE(all.size(), static_cast<std::size_t>(rows));
      for (const Line& line : all)
        ASSERT_LE(columns_of(text_of(line)), static_cast<std::size_t>(columns)) << text_of(line);
    }
  }
}

TEST(BoardView, InASmallWindowShowsMotorsSelectedJointWordsAndKeys) {
  for (const int selected : {0, 9, KZ_JOINTS - 1}) {
    const auto all = lines(board(), selected, "looks only", 10, 40);
    ASSERT_EQ(all.size(), 10u);
    EXPECT_EQ(text_of(all.front()).rfind("motors off", 0), 0u);
    int rows = 0;
    for (const Line& line : all) {
      if (line.front().ink != Ink::selected) continue;
      ++rows;
      const std::string name = host::joint_table()[static_cast<std::size_t>(selected)].name;
      EXPECT_NE(text_of(line).find(name), std::string::npos) << text_of(line);
      EXPECT_NE(text_of(line).find("0.0 off"), std::string::npos) << text_of(line);
    }
    EXPECT_EQ(rows, 1);
    EXPECT_EQ(text_of(all[8]), "looks only");
    EXPECT_NE(text_of(all[9]).find("q quit  SPACE stop"), std::string::npos);
  }
}

TEST(BoardView, InASmallWindowAFaultIsWholeWhereThereIsRoom) {
  BoardView view = board();
  view.fault = "a fault with a long sentence that says what happened and what to do about it";
  std::string shown;
  for (const Line& line : lines(view, 9, "", 14, 40)) {
    if (line.front().ink == Ink::bad && line.front().text != "no answer")
      shown += (shown.empty() ? "" : " ") + text_of(line);
  }
  EXPECT_EQ(shown, view.fault);
}

TEST(BoardView, SaysThatAWindowIsTooSmall) {
  const auto all = lines(board(), 0, "", 3, 20);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(text_of(all[0]), "window too small:");
  EXPECT_EQ(text_of(all[1]), "20 x 3, needs");
  EXPECT_EQ(text_of(all[2]), "28 x 5");
}

TEST(BoardView, HasAllJointsWhereThereIsRoom) {
  const auto all = lines(board(), 0, "looks only");
  ASSERT_EQ(all.size(), static_cast<std::size_t>(kLines));
  EXPECT_NE(text_of(all[0]).find("kaz monitor"), std::string::npos);
  for (int joint = 0; joint < KZ_JOINTS; ++joint)
    EXPECT_NE(text_of(all[static_cast<std::size_t>(4 + joint)])
                  .find(host::joint_table()[static_cast<std::size_t>(joint)].name),
              std::string::npos);
}

TEST(BoardView, SpellsControlCharactersOut) {
  BoardView view = board();
  view.port = "b\x1b[2Jd";
  EXPECT_NE(text_of(lines(view, 0, "")[0]).find("b\\x1b[2Jd"), std::string::npos);
}

}  // namespace
}  // namespace kaz::tools
