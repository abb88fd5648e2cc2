// Files of boards: which joint is on which.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/board_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/robot/robot.h"

namespace kaz::tools {
namespace {

// Names of the joints `first` to before `end`, as JSON.
std::string names(int first, int end) {
  std::string text;
  for (int j = first; j < end; ++j)
    text += std::string(j > first ? ", " : "") + "\"" +
            host::joint_table()[static_cast<std::size_t>(j)].name + "\"";
  return "[" + text + "]";
}

std::string board(const std::string& port, const std::string& address, const std::string& joints) {
  return R"({"port": ")" + port + "\"" + (address.empty() ? "" : ", \"address\": " + address) +
         ", \"joints\": " + joints + "}";
}

std::string file(const std::vector<std::string>& boards) {
  std::string text;
  for (const std::string& one : boards) text += (text.empty() ? "" : ",\n") + one;
  return "{\"boards\": [" + text + "]}";
}

std::string error_of(const std::string& text) {
  const auto boards = parse_boards("kaz.boards", text);
  return boards ? "" : boards.error().message;
}

TEST(BoardFile, TwoBoardsOnOneBus) {
  const auto boards = parse_boards("kaz.boards", file({board("can:can0", "2", names(0, 10)),
                                                       board("can:can0", "", names(10, 18))}));
  ASSERT_TRUE(boards) << boards.error().message;
  ASSERT_EQ(boards->size(), 2u);
  EXPECT_EQ((*boards)[0].port.name(), "can:can0");
  EXPECT_EQ((*boards)[0].address, 2);
  EXPECT_EQ((*boards)[0].joints, 0x3FFu);
  EXPECT_EQ((*boards)[1].address, 1);
  EXPECT_EQ((*boards)[1].joints, host::kAllJoints & ~0x3FFu);
}

TEST(BoardFile, EachMistakeHasItsSentence) {
  const std::string all = names(0, 18);
  EXPECT_EQ(error_of("{}").find("kaz.boards: not a file of boards; give {\"boards\": [{"), 0u);
  EXPECT_EQ(error_of("{\"boards\": [\n,]}").find("kaz.boards: line 2 is not valid JSON; give {"),
            0u);
  EXPECT_EQ(error_of("").find("kaz.boards: line 1 is not valid JSON; give {"), 0u);
  EXPECT_EQ(error_of(R"({"boards": [{"port": "x", "adress": 2, "joints": []}]})"),
            "kaz.boards, board 1: unknown key `adress`: use port, address or joints");
  EXPECT_EQ(error_of(file({"{}"})).find("kaz.boards, board 1: its port is missing; give"), 0u);
  EXPECT_EQ(
      error_of(file({board("can:", "", all)})).find("kaz.boards, board 1: can:: the interface"),
      0u);
  EXPECT_EQ(error_of(file({board("x", "15", all)})),
            "kaz.boards, board 1: its address must be 1 to 14: give the address of the board");
  EXPECT_EQ(error_of(file({board("x", "", "[\"tail\"]")})),
            "kaz.boards, board 1: unknown joint \"tail\": give names such as neck_pan; "
            "docs/reference/robot.md lists them");
  EXPECT_EQ(error_of(file({board("x", "", names(1, 18))})),
            "kaz.boards: no board drives neck_pan: assign each joint to a board");
  EXPECT_EQ(error_of(file({board("x", "", all), board("y", "", names(3, 4))})),
            "kaz.boards: two boards drive l_sh_roll: assign each joint to one board");
  EXPECT_EQ(
      error_of(file({board("can:can0", "", names(0, 9)), board("can:can0", "", names(9, 18))})),
      "kaz.boards: two boards have address 1 on can:can0: give the boards different "
      "addresses (kaz recover --address)");
  EXPECT_EQ(error_of(file({board("x", "1", names(0, 9)), board("serial:x", "2", names(9, 18))})),
            "kaz.boards: two boards are at x: give each board its own port, or connect the boards "
            "to a CAN bus with `kaz can-bridge`");
}

// A comment hides nothing of what follows, and a value that is no name is not printed whole.
TEST(BoardFile, DeepAndLongValuesAreRefusedInAShortSentence) {
  const std::string deep(30'000, '['), closed = deep + std::string(30'000, ']');
  for (const std::string& start : {std::string(), std::string("//\"\n")}) {
    EXPECT_EQ(error_of(start + deep).find("kaz.boards: it nests deeper than 64 levels; give {"),
              0u);
    EXPECT_EQ(error_of(start + file({board("x", "", closed)}))
                  .find("kaz.boards: it nests deeper than 64 levels; give {"),
              0u);
  }
  const std::string many(50'000, '1'), text = "\"" + many + "\"";
  for (const std::string& one :
       {board("x", "", "[" + text + "]"), board("x", "", "[" + many + "]"), board(many, "", "[]"),
        board("can:" + many, "", "[]"), "{" + text + ": 1, \"port\": \"x\"}"}) {
    const std::string error = error_of(file({one}));
    EXPECT_FALSE(error.empty());
    EXPECT_LT(error.size(), 400u) << error.substr(0, 400);
  }
}

TEST(BoardFile, AFileThatIsNotThereIsASentence) {
  const auto boards = read_boards("/kaz/none.json");
  ASSERT_FALSE(boards);
  EXPECT_EQ(boards.error().fault, Fault::usage);
  EXPECT_NE(boards.error().message.find("/kaz/none.json"), std::string::npos);
}

}  // namespace
}  // namespace kaz::tools
