// Which requests get in: token, Host, Origin.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/entry.h"

#include <gtest/gtest.h>

namespace kaz::viewer {
namespace {

Access access_of(bool open = false) {
  Access access;
  access.token = "secret";
  access.open = open;
  access.names = {"robot7", "robot7.local"};
  access.page["/index.html"] = {"text/html", {'p'}};
  access.robot["/robot/kaz.urdf"] = {"application/xml", {'u'}};
  return access;
}

constexpr std::string_view kHost = "127.0.0.1:8765";

unsigned viewer(const Access& access, std::string_view target, std::string_view origin = "",
                std::string_view host = kHost) {
  return answer_to({"GET", target, host, origin, kSdkProtocol, true}, access).status;
}
unsigned file(const Access& access, std::string_view target, std::string_view host = kHost,
              std::string_view method = "GET", std::string_view origin = "") {
  return answer_to({method, target, host, origin, "", false}, access).status;
}

TEST(Entry, LookingTakesTheTokenWhateverTheOrigin) {
  const Access access = access_of();
  for (const char* origin : {"", "http://127.0.0.1:8765", "https://evil.example", "file://", "null",
                             "https://app.foxglove.dev"}) {
    EXPECT_EQ(viewer(access, "/", origin), 403u) << origin;
    EXPECT_EQ(viewer(access, "/?token=secreT", origin), 403u) << origin;
    EXPECT_EQ(viewer(access, "/?token=", origin), 403u) << origin;
    EXPECT_EQ(viewer(access, "/?a=b&token=secret", origin), 101u) << origin;
  }
  EXPECT_EQ(file(access, "/robot/kaz.urdf"), 403u);
  EXPECT_EQ(file(access, "/robot/kaz.urdf?token=secret"), 200u);
  Access without;
  EXPECT_EQ(viewer(without, "/?token="), 403u) << "no token is not the empty token";
}

TEST(Entry, OpenLetsProgramsLookAndOwnPagesButNoOtherPage) {
  const Access access = access_of(true);
  for (const char* origin :
       {"", "file://", "app://lichtblick", "http://127.0.0.1:8765", "https://127.0.0.1:8765"}) {
    const Answer answer = answer_to({"GET", "/", kHost, origin, kSdkProtocol, true}, access);
    EXPECT_EQ(answer.status, 101u) << origin;
    EXPECT_FALSE(answer.control) << origin;
    EXPECT_EQ(file(access, "/robot/kaz.urdf", kHost, "GET", origin), 200u) << origin;
  }
  for (const char* origin :
       {"https://evil.example", "HTTP://evil.example", "null", "http://127.0.0.1",
        "http://127.0.0.1:8766", "http://localhost:8765", "httpW//127.0.0.1:8765"}) {
    EXPECT_EQ(viewer(access, "/", origin), 403u) << origin;
    EXPECT_EQ(viewer(access, "/?token=secret", origin), 101u) << origin;
    EXPECT_EQ(file(access, "/robot/kaz.urdf", kHost, "GET", origin), 403u) << origin;
  }
  EXPECT_EQ(viewer(access, "/?token=other"), 403u)
      << "a wrong token is an error, if none is needed";
  EXPECT_TRUE(answer_to({"GET", "/?token=secret", kHost, "", kSdkProtocol, true}, access).control);
}

TEST(Entry, AForeignHostIsRefused) {
  const Access access = access_of(true);
  for (const char* host : {"127.0.0.1", "127.0.0.1:9", "10.0.0.7:8765", "localhost:8765",
                           "LOCALHOST", "[::1]:8765", "[::1]", "robot7:8765", "Robot7.local"}) {
    EXPECT_EQ(file(access, "/", host), 200u) << host;
    EXPECT_EQ(viewer(access, "/", "", host), 101u) << host;
  }
  using namespace std::string_view_literals;
  for (const std::string_view host :
       {""sv, "127.0.0.1\0.evil.example"sv, "[::1\0]"sv, "evil.example"sv, "evil.example:8765"sv,
        "127.0.0.1.evil.example"sv, "localhost.evil.example"sv, "robot7.evil.example"sv,
        "127.0.0.1:8765@evil.example"sv, "127.0.0.1:x"sv, "[evil.example]"sv,
        "[::1].evil.example"sv, "::1"sv, "[::1"sv, "127.1"sv, "2130706433"sv, "localhost."sv}) {
    EXPECT_EQ(file(access, "/", host), 403u) << host;
    EXPECT_EQ(viewer(access, "/", "", host), 403u) << host;
    EXPECT_EQ(viewer(access, "/?token=secret", "", host), 403u) << host;
  }
}

TEST(Entry, OnlyFilesOfTheRobotAreReadableForOtherPages) {
  const Access access = access_of();
  const Answer page = answer_to({"GET", "/", kHost, "", "", false}, access);
  EXPECT_EQ(page.file, &access.page.at("/index.html"));
  EXPECT_FALSE(page.any_origin);
  const Answer robot = answer_to(
      {"HEAD", "/robot/kaz.urdf?token=secret", kHost, "https://app.foxglove.dev", "", false},
      access);
  EXPECT_EQ(robot.file, &access.robot.at("/robot/kaz.urdf"));
  EXPECT_TRUE(robot.any_origin);
}

TEST(Entry, OtherMethodsPathsAndProtocolsAreRefused) {
  const Access access = access_of();
  EXPECT_EQ(file(access, "/", kHost, "POST"), 405u);
  for (const char* path : {"/nothing", "/../etc/passwd", "/robot/../index.html", "", "//"})
    EXPECT_EQ(file(access, path), 404u) << path;
  EXPECT_EQ(answer_to({"GET", "/?token=secret", kHost, "", "chat", true}, access).status, 400u);
}

}  // namespace
}  // namespace kaz::viewer
