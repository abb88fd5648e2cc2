// The server against viewers that are right, wrong, many and slow.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "tools/viewer/client_testing.h"

namespace kaz::viewer {
namespace {

ServerOptions usual() {
  ServerOptions options;
  options.port = 0;
  options.access.token = "secret";
  options.access.open = true;
  options.access.page["/index.html"] = {"text/html", {'p', 'a', 'g', 'e'}};
  options.access.robot["/robot/kaz.urdf"] = {"application/xml", {'u', 'r', 'd', 'f'}};
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
         " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: "
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
  server->publish(a, 1, Bytes{1}, {.kept = true});
  server->publish(a, 2, Bytes{2}, {.kept = true});
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
  EXPECT_NE(
      answer(server->port(), "DELETE / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
          .find("405"),
      std::string::npos);
  EXPECT_NE(answer(server->port(), "no HTTP at all\r\n\r\n").find("400"), std::string::npos);
  EXPECT_EQ(answer(server->port(), get("/" + std::string(20'000, 'x'))).find("200 OK"),
            std::string::npos);
  EXPECT_TRUE(answer(server->port(), get("/")).ends_with("page"));
}

// Token, Host and Origin by themselves: entry_test.cpp.
TEST(ViewServer, WithoutTheTokenThereIsThePageAndNothingElse) {
  auto options = usual();
  options.access.open = false;
  const auto server = opened(options);
  Client right(server->port());
  const std::string refused = answer(server->port(), handshake("/", kSdk));
  EXPECT_TRUE(refused_with("403", refused));
  EXPECT_NE(refused.find("--view-open"), std::string::npos) << refused;
  EXPECT_TRUE(refused_with("403", answer(server->port(), handshake("/?token=secreT", kSdk))));
  EXPECT_TRUE(right.open(kSdk, "/?a=b&token=secret"));
  EXPECT_TRUE(refused_with("403", answer(server->port(), get("/robot/kaz.urdf"))));
  EXPECT_TRUE(answer(server->port(), get("/robot/kaz.urdf?token=secret")).ends_with("urdf"));
  const std::string page = answer(server->port(), get("/"));
  EXPECT_TRUE(page.ends_with("page"));
  EXPECT_EQ(page.find("Access-Control-Allow-Origin"), std::string::npos);
}

TEST(ViewServer, HostAndOriginOfARequestAreChecked) {
  const auto server = opened();
  const auto changed = [&](std::string request, const std::string& from, const std::string& to) {
    request.replace(request.find(from), from.size(), to);
    return answer(server->port(), request);
  };
  const std::string host = "Host: 127.0.0.1\r\n";
  for (const std::string& path : {std::string("/"), std::string("/robot/kaz.urdf")}) {
    EXPECT_TRUE(refused_with("403", changed(get(path), host, "Host: evil.example\r\n"))) << path;
    EXPECT_TRUE(refused_with("403", changed(get(path), host, ""))) << path;
    EXPECT_TRUE(refused_with("403", changed(get(path), host, host + "Host: evil.example\r\n")))
        << path;
  }
  const std::string shake = handshake("/", kSdk);
  EXPECT_TRUE(refused_with("403", changed(shake, host, "Host: evil.example\r\n")));
  EXPECT_TRUE(refused_with("403", changed(shake, host, host + "Origin: https://evil.example\r\n")));
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
  options.most_logged = 1 << 20;
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
  for (int i = 0; i < 1000; ++i) {
    server->publish(a, static_cast<std::uint64_t>(i), data);
    // As fast as the quick one reads.
    for (int k = 0; k < 2000 && got + 5 < static_cast<std::size_t>(i); ++k)
      std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  reader.join();
  EXPECT_EQ(got, 1000u);
  EXPECT_GT(server->left_out(), 500u);  // of the slow one
}

TEST(ViewServer, AViewerHasOneSubscriptionOfAChannel) {
  const auto server = opened();
  const auto a = server->add_channel(text_channel("/a"));
  Client client(server->port());
  ASSERT_TRUE(client.open(kSdk));
  client.send(subscription(1, a));
  ASSERT_TRUE(eventually([&] { return server->subscriptions() == 1; }));
  auto all = nlohmann::json::array();
  for (int id = 2; id < 500; ++id) all.push_back({{"id", id}, {"channelId", a}});
  client.send(nlohmann::json{{"op", "subscribe"}, {"subscriptions", all}});
  const auto warned = client.next_op("status");
  EXPECT_EQ(warned["level"], 1);
  EXPECT_NE(warned["message"].dump().find("already subscribes to this channel"), std::string::npos);
  EXPECT_EQ(server->subscriptions(), 1u);
  server->publish(a, 0, Bytes{7});
  server->publish(a, 0, Bytes{8});
  EXPECT_EQ(client.next_frame(1)->back(), 7);
  EXPECT_EQ(client.next_frame(1)->back(), 8) << "it came twice";
}

// The server's thread is held up in a handler, as by viewers that keep it busy.
TEST(ViewServer, PublishingWaitsForNobody) {
  auto options = usual();
  options.hands = true;
  options.most_queued = 1 << 20;
  const auto server = opened(options);
  const auto a = server->add_channel(text_channel("/a")),
             b = server->add_channel(text_channel("/b"));
  std::promise<void> entered, leave;
  server->on_hand([&](const std::string&) {
    entered.set_value();
    leave.get_future().wait();
    return Result<void>();
  });
  Client client(server->port());
  ASSERT_TRUE(client.open(kSdk, "/?token=secret"));
  client.send(subscription(1, a));
  client.send(nlohmann::json{
      {"op", "advertise"},
      {"channels", {{{"id", 1}, {"topic", "/hand"}, {"encoding", "json"}, {"schemaName", ""}}}}});
  const std::string line = R"({"do": "anything"})";
  Bytes hand{1, 1, 0, 0, 0};
  hand.insert(hand.end(), line.begin(), line.end());
  client.send(hand);
  entered.get_future().wait();
  // It would not return, and the test not end, if it waited for the server's thread or its viewers.
  const Bytes data(10'000);
  for (int i = 0; i < 1000; ++i) server->publish(a, static_cast<std::uint64_t>(i), data);
  for (std::uint8_t i = 0; i < 10; ++i) server->publish(b, i, Bytes{i}, {.kept = true});
  server->publish_time(5);
  server->publish_error("nobody reads this");
  server->add_channel(text_channel("/c"));
  const std::uint64_t left_out = server->left_out();
  EXPECT_GT(left_out, 850u) << "1 MB is 100 of these";
  EXPECT_LT(left_out, 950u + 10u);
  leave.set_value();
  EXPECT_TRUE(client.next_frame(1));
  // The queue was full, but what is kept is there for who comes later.
  Client late(server->port());
  ASSERT_TRUE(late.open(kSdk));
  late.send(subscription(1, b));
  EXPECT_EQ(late.next_frame(1)->back(), 9);
  server->on_hand({});
}

std::size_t resident_mb() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) >> 20;
}

// The short form of a web page that opens as many viewers as it can.
TEST(ViewServer, SixtyFourViewersThatNeverReadCostLittleMemory) {
  const auto server = opened();
  std::vector<std::uint32_t> channels;
  auto everything = nlohmann::json::array();
  const Bytes kept(100'000), data(10'000);
  for (std::uint32_t i = 0; i < 20; ++i) {
    channels.push_back(server->add_channel(text_channel("/" + std::to_string(i)), i % 2 == 0));
    server->publish(channels.back(), 0, kept, {.kept = true});
    for (std::uint32_t k = 0; k < 50; ++k)
      everything.push_back({{"id", 50 * i + k}, {"channelId", channels.back()}});
  }
  const nlohmann::json subscribe{{"op", "subscribe"}, {"subscriptions", everything}},
      unsubscribe{{"op", "unsubscribe"},
                  {"subscriptionIds", nlohmann::json::array({0, 50, 100, 150, 200})}};
  const std::size_t before = resident_mb();
  std::vector<std::unique_ptr<Client>> viewers;
  std::uint64_t published = 0;
  for (int i = 0; i < 64; ++i) {
    auto& client = viewers.emplace_back(std::make_unique<Client>(server->port()));
    client->raw().set_option(boost::asio::socket_base::receive_buffer_size(4096));
    ASSERT_TRUE(client->open(kSdk));
    for (int k = 0; k < 3; ++k) {
      client->send(subscribe);
      client->send(unsubscribe);
    }
    client->send(subscribe);
    // Between them, so that each of them waits for other messages.
    for (int k = 0; k < 1000; ++k, ++published) {
      server->publish(channels[published % 20], published, data, {.kept = published % 7 == 0});
      if (k % 100 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  EXPECT_TRUE(eventually([&] { return server->subscriptions() == 64u * 20u; }))
      << server->subscriptions();
#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(resident_mb() - before, 40u) << published / 100 << " MB were published";
#endif
  EXPECT_GT(server->left_out(), 0u);
  // One that reads is served all the same.
  viewers.pop_back();
  std::unique_ptr<Client> reader;
  bool is_open = false;
  ASSERT_TRUE(eventually([&] {
    if (!is_open) reader = std::make_unique<Client>(server->port());
    return is_open = is_open || reader->open(kSdk).has_value();
  }));
  reader->send(subscription(0, channels[3]));
  ASSERT_TRUE(eventually([&] { return server->subscriptions() == 63u * 20u + 1u; }));
  server->publish(channels[3], 77, Bytes{42});
  std::optional<Bytes> last;
  do last = reader->next_frame(1);
  while (last && last->back() != 42);
  EXPECT_TRUE(last);
}

TEST(ViewServer, AViewerThatTakesNoAnswersIsNotReadFrom) {
  const auto server = opened();
  Client client(server->port());
  client.raw().set_option(boost::asio::socket_base::receive_buffer_size(4096));
  ASSERT_TRUE(client.open(kSdk));
  const std::string request =
      R"({"op":"getParameters","parameterNames":[],"id":")" + std::string(60'000, 'y') + "\"}";
  const std::size_t before = resident_mb();
  std::atomic<int> sent = 0;
  std::thread sender([&] {
    try {
      while (sent < 10'000) {  // 600 MB of answers, if all were made
        client.send(request);
        ++sent;
      }
    } catch (const boost::system::system_error&) {  // shut down
    }
  });
  int then = -1;
  while (then != sent) {
    then = sent;
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  EXPECT_LT(sent, 1000);
#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(resident_mb() - before, 30u);
#endif
  ::shutdown(client.raw().native_handle(), SHUT_RDWR);
  sender.join();
}

TEST(ViewServer, OnlyTheSdksProtocolHasAPlayersState) {
  auto options = usual();
  options.end_ns = 9'000'000'000;
  const auto server = opened(options);
  const auto a = server->add_channel(text_channel("/a"));
  server->publish_playback({});
  server->drain(1);
  // All binary frames that come until the mark, by opcode.
  const auto opcodes = [&](const std::string& protocol) {
    Client client(server->port());
    EXPECT_EQ(client.open(protocol), protocol);
    const auto info = client.next_op("serverInfo");
    const bool sdk = protocol == kSdk;
    EXPECT_EQ(info.contains("dataEndTime"), sdk);
    EXPECT_EQ(info["capabilities"].dump().find("playbackControl") != std::string::npos, sdk);
    client.send(subscription(1, a));
    EXPECT_TRUE(eventually([&] { return server->wanted(a); }));
    server->publish_time(1);
    server->publish_playback({});
    client.send(nlohmann::json{{"op", "fetchAsset"}, {"uri", "x"}, {"requestId", 1}});
    server->publish(a, 0, Bytes{42});
    std::set<int> seen;
    for (std::optional<Bytes> message; (message = client.next());) {
      if (!client.is_text()) seen.insert(message->front());
      if (!client.is_text() && message->front() == 1) break;
    }
    return seen;
  };
  EXPECT_TRUE(opcodes(kSdk).contains(5));
  for (const int opcode : opcodes(kOlder)) EXPECT_LT(opcode, 5) << "foxglove.websocket.v1 has none";
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
}  // namespace kaz::viewer
