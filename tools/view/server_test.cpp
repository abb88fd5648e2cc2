// The server against viewers that are right, wrong, many and slow.
// SPDX-License-Identifier: Apache-2.0
#include "tools/view/server.h"

#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "tools/view/client_testing.h"

namespace kaz::watch {
namespace {

ServerOptions usual() {
  ServerOptions options;
  options.port = 0;
  options.token = "secret";
  options.page["/index.html"] = {"text/html", {'p', 'a', 'g', 'e'}};
  options.robot["/robot/kaz.urdf"] = {"application/xml", {'u', 'r', 'd', 'f'}};
  return options;
}

std::unique_ptr<Server> opened(ServerOptions options = usual()) {
  auto server = Server::open(std::move(options));
  EXPECT_TRUE(server.has_value()) << server.error().message;
  return std::move(*server);
}

Channel text_channel(const std::string& topic) {
  return {0, topic, "ros1", "std_msgs/String", "ros1msg", "string data\n"};
}

bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 500 && !holds(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return holds();
}

std::string handshake(const std::string& path, const std::string& offered) {
  return "GET " + path +
         " HTTP/1.1\r\nHost: a\r\nConnection: Upgrade\r\nUpgrade: "
         "websocket\r\nSec-WebSocket-Version: "
         "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         (offered.empty() ? "" : "Sec-WebSocket-Protocol: " + offered + "\r\n") + "\r\n";
}

bool refused_with(const char* status, const std::string& text) {
  return text.starts_with(std::string("HTTP/1.1 ") + status);
}

const std::string kSdk = "foxglove.sdk.v1", kOlder = "foxglove.websocket.v1";

nlohmann::json subscription(std::uint32_t id, std::uint32_t channel) {
  return {{"op", "subscribe"},
          {"subscriptions", nlohmann::json::array({{{"id", id}, {"channelId", channel}}})}};
}

TEST(ViewServer, BothNamesOfTheProtocolAreSpoken) {
  const auto server = opened();
  EXPECT_EQ(Client(server->port()).open(kSdk), kSdk);
  EXPECT_EQ(Client(server->port()).open(kOlder), kOlder);
  EXPECT_EQ(Client(server->port()).open(kOlder + ", " + kSdk), kSdk);
  for (const char* other : {"", "chat", "foxglove.sdk.v10"}) {
    EXPECT_EQ(Client(server->port()).open(other), std::nullopt) << other;
    EXPECT_TRUE(refused_with("400", answer(server->port(), handshake("/", other)))) << other;
  }
}

TEST(ViewServer, ViewersGetWhatTheySubscribedTo) {
  const auto server = opened();
  const auto a = server->add_channel(text_channel("/a")),
             b = server->add_channel(text_channel("/b"));
  Client client(server->port());
  ASSERT_TRUE(client.open(kSdk));
  const auto info = client.next_op("serverInfo");
  EXPECT_EQ(info["name"], "kaz");
  EXPECT_EQ(info["capabilities"],
            (nlohmann::json{"assets", "parameters", "parametersSubscribe", "time"}));
  ASSERT_EQ(client.channel("/b"), b);
  EXPECT_FALSE(server->wanted(b));
  client.send(subscription(7, b));
  ASSERT_TRUE(eventually([&] { return server->wanted(b); }));
  EXPECT_FALSE(server->wanted(a));
  server->publish(a, 1, Bytes{1});
  server->publish(b, 0x0102030405060708, Bytes{42, 43});
  EXPECT_EQ(client.next_frame(1), (Bytes{1, 7, 0, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, 42, 43}));
  client.send(nlohmann::json{{"op", "unsubscribe"}, {"subscriptionIds", {7}}});
  EXPECT_TRUE(eventually([&] { return !server->wanted(b); }));
  // A channel that comes later is announced.
  server->add_channel(text_channel("/late"));
  EXPECT_EQ(client.channel("/late"), 2u);
}

TEST(ViewServer, WhatIsKeptIsGivenToWhoeverComesLater) {
  const auto server = opened();
  const auto a = server->add_channel(text_channel("/a"));
  server->publish(a, 1, Bytes{1}, true);
  server->publish(a, 2, Bytes{2}, true);
  Client client(server->port());
  ASSERT_TRUE(client.open(kSdk));
  client.send(subscription(0, a));
  EXPECT_EQ(client.next_frame(1), (Bytes{1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 2}));
}

TEST(ViewServer, TheRobotIsServedOverHttpAndAsAnAsset) {
  const auto server = opened();
  const std::string urdf = answer(server->port(), get("/robot/kaz.urdf"));
  EXPECT_NE(urdf.find("200 OK"), std::string::npos);
  EXPECT_NE(urdf.find("Access-Control-Allow-Origin: *"), std::string::npos);
  EXPECT_TRUE(urdf.ends_with("\r\n\r\nurdf"));
  EXPECT_TRUE(answer(server->port(), get("/")).ends_with("page"));
  Client client(server->port());
  ASSERT_TRUE(client.open(kSdk));
  client.send(
      nlohmann::json{{"op", "fetchAsset"}, {"uri", "package://robot/kaz.urdf"}, {"requestId", 5}});
  EXPECT_EQ(client.next_frame(4), (Bytes{4, 5, 0, 0, 0, 0, 0, 0, 0, 0, 'u', 'r', 'd', 'f'}));
  client.send(
      nlohmann::json{{"op", "fetchAsset"}, {"uri", "file:///etc/passwd"}, {"requestId", 6}});
  const auto none = client.next_frame(4);
  ASSERT_TRUE(none);
  EXPECT_EQ((*none)[5], 1);  // an error
}

TEST(ViewServer, ParametersAreReadAndNeverSet) {
  auto options = usual();
  options.parameters = {{"robot", "kaz.urdf"}, {"source", "simulation"}};
  const auto server = opened(options);
  Client client(server->port());
  ASSERT_TRUE(client.open(kOlder));
  const nlohmann::json all{
      {"op", "getParameters"}, {"parameterNames", nlohmann::json::array()}, {"id", "a"}};
  client.send(all);
  const auto before = client.next_op("parameterValues");
  EXPECT_EQ(before["id"], "a");
  EXPECT_EQ(before["parameters"].size(), 2u);
  client.send(nlohmann::json{
      {"op", "setParameters"},
      {"parameters", nlohmann::json::array({{{"name", "source"}, {"value", "other"}}})}});
  EXPECT_EQ(client.next_op("status")["level"], 2);
  client.send(all);
  EXPECT_EQ(client.next_op("parameterValues"), before);
}

TEST(ViewServer, UnknownPathsAndMethodsAreRefused) {
  const auto server = opened();
  for (const char* path :
       {"/nothing", "/../etc/passwd", "/robot/../../etc/passwd", "/%2e%2e/x", "//"})
    EXPECT_NE(answer(server->port(), get(path)).find("404 Not Found"), std::string::npos) << path;
  EXPECT_NE(answer(server->port(), "DELETE / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
                .find("405"),
            std::string::npos);
  EXPECT_NE(answer(server->port(), "no HTTP at all\r\n\r\n").find("400"), std::string::npos);
  EXPECT_EQ(answer(server->port(), get("/" + std::string(20'000, 'x'))).find("200 OK"),
            std::string::npos);
  EXPECT_TRUE(answer(server->port(), get("/")).ends_with("page"));
}

TEST(ViewServer, TheTokenIsRequiredWhereItHasToBe) {
  auto options = usual();
  options.token_to_look = true;
  const auto server = opened(options);
  Client right(server->port());
  EXPECT_TRUE(refused_with("403", answer(server->port(), handshake("/", kSdk))));
  EXPECT_TRUE(refused_with("403", answer(server->port(), handshake("/?token=secreT", kSdk))));
  EXPECT_TRUE(right.open(kSdk, "/?a=b&token=secret"));
  EXPECT_NE(answer(server->port(), get("/robot/kaz.urdf")).find("403"), std::string::npos);
  EXPECT_TRUE(answer(server->port(), get("/robot/kaz.urdf?token=secret")).ends_with("urdf"));
  // A wrong one is an error where none is needed, too.
  const auto open_one = opened();
  EXPECT_FALSE(Client(open_one->port()).open(kSdk, "/?token=other"));
  EXPECT_TRUE(Client(open_one->port()).open(kSdk));
}

TEST(ViewServer, OnlyWhoHasTheTokenControlsThePlayer) {
  auto options = usual();
  options.end_ns = 9'000'000'000;
  const auto server = opened(options);
  std::atomic<int> heard = 0;
  server->on_playback([&](const Playback& wanted) {
    if (wanted.command == Playback::Command::pause && wanted.seek && wanted.seek_ns == 5) ++heard;
  });
  const Bytes pause{3, 1, 0, 0, 0x80, 0x3f, 1, 5, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 'x'};
  Client looks(server->port());
  ASSERT_TRUE(looks.open(kSdk));
  EXPECT_EQ(looks.next_op("serverInfo")["dataEndTime"]["sec"], 9);
  looks.send(pause);
  EXPECT_NE(looks.next_op("status")["message"].get<std::string>().find("token"), std::string::npos);
  EXPECT_EQ(heard, 0);
  Client controls(server->port());
  ASSERT_TRUE(controls.open(kSdk, "/?token=secret"));
  controls.send(pause);
  EXPECT_TRUE(eventually([&] { return heard == 1; }));
  server->on_playback({});
}

TEST(ViewServer, MalformedRequestsAreAnsweredAndTooManyEndTheConnection) {
  const auto server = opened();
  Client client(server->port());
  ASSERT_TRUE(client.open(kSdk));
  const std::string wrong[] = {
      "{",
      "[]",
      "7",
      "{\"op\":5}",
      "{\"op\":\"advertise\"}",
      "{\"op\":\"subscribe\"}",
      subscription(0, 99).dump(),
      std::string(1000, '['),
      "{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":-1,\"channelId\":0}]}"};
  for (const std::string& text : wrong) {
    client.send(text);
    EXPECT_EQ(client.next_op("status")["level"], 2) << text;
  }
  for (int i = 0; i < 20; ++i) {
    try {
      client.send(Bytes{9, 9, 9});
    } catch (const boost::system::system_error&) {
      break;  // it has ended
    }
  }
  while (client.next()) continue;
  EXPECT_TRUE(eventually([&] { return server->viewers() == 0; }));
  // One that is too long.
  Client huge(server->port());
  ASSERT_TRUE(huge.open(kSdk));
  try {
    huge.send(std::string(kLongestRequest + 1, ' '));
  } catch (const boost::system::system_error&) {
  }
  while (huge.next()) continue;
  EXPECT_TRUE(eventually([&] { return server->viewers() == 0; }));
}

TEST(ViewServer, TwoHundredConnectionsAreSurvived) {
  const auto server = opened();
  const auto a = server->add_channel(text_channel("/a"));
  std::vector<std::unique_ptr<Client>> clients;
  std::size_t open = 0, refused = 0;
  for (int i = 0; i < 200; ++i) {
    auto& client = clients.emplace_back(std::make_unique<Client>(server->port()));
    client->open(kSdk) ? ++open : ++refused;
  }
  EXPECT_EQ(open, 64u);
  EXPECT_EQ(refused, 136u);
  clients.front()->send(subscription(0, a));
  ASSERT_TRUE(eventually([&] { return server->wanted(a); }));
  server->publish(a, 0, Bytes{5});
  EXPECT_TRUE(clients.front()->next_frame(1));
  clients.clear();
  EXPECT_TRUE(eventually([&] { return server->viewers() == 0; }));
  EXPECT_TRUE(Client(server->port()).open(kSdk));
}

TEST(ViewServer, ASlowViewerGetsLessAndHoldsUpNobody) {
  auto options = usual();
  options.most_waiting = 1 << 20;
  const auto server = opened(options);
  const auto a = server->add_channel(text_channel("/a"));
  Client slow(server->port()), quick(server->port());
  ASSERT_TRUE(slow.open(kSdk));
  ASSERT_TRUE(quick.open(kSdk));
  slow.send(subscription(0, a));
  quick.send(subscription(0, a));
  ASSERT_TRUE(eventually([&] { return server->subscriptions() == 2; }));
  std::size_t got = 0;
  std::thread reader([&] {
    while (got < 1000 && quick.next_frame(1)) ++got;
  });
  const Bytes data(100'000);
  std::chrono::steady_clock::duration longest{};
  for (int i = 0; i < 1000; ++i) {
    const auto before = std::chrono::steady_clock::now();
    server->publish(a, static_cast<std::uint64_t>(i), data);
    longest = std::max(longest, std::chrono::steady_clock::now() - before);
    // As fast as the quick one reads.
    for (int k = 0; k < 2000 && got + 5 < static_cast<std::size_t>(i); ++k)
      std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  reader.join();
  EXPECT_EQ(got, 1000u);
  EXPECT_GT(server->left_out(), 500u);  // of the slow one
  EXPECT_LT(longest, std::chrono::milliseconds(500));
}

TEST(ViewServer, APortThatIsTakenIsReported) {
  const auto server = opened();
  auto options = usual();
  options.port = server->port();
  const auto other = Server::open(options);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().fault, Fault::environment);
  EXPECT_NE(other.error().message.find("--view 127.0.0.1"), std::string::npos);
}

}  // namespace
}  // namespace kaz::watch
