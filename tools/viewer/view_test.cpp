// A run that is watched: the same as one that is not, and what viewers see of it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/view.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "shared/base/files.hpp"
#include "shared/protocol/messages.h"
#include "sim/body/description/robot_model.h"
#include "sim/runtime/formats/little_endian.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/simulation/recorder.h"
#include "sim/runtime/simulation/simulation.h"
#include "sim/runtime/simulation/world_testing.h"
#include "tools/viewer/client_testing.h"
#include "tools/viewer/player.h"

namespace kaz::viewer {
namespace {

const std::string kTree = KAZ_TREE;
const std::string kRobot = kTree + "/shared/robot/kaz/kaz.urdf";

std::unique_ptr<View> opened(bool wait = false, const char* source = "simulation") {
  ViewOptions options;
  options.where = "127.0.0.1:0";
  options.robot_path = kRobot;
  options.wait = wait;
  options.open = true;
  options.source = source;
  auto view = View::open(options);
  EXPECT_TRUE(view.has_value()) << view.error().message;
  return std::move(*view);
}

// SHA-256 of the recording of 0.3 s.
std::string recorded(const std::string& path, View* view) {
  sim::SimulationOptions options;
  options.world_path = kTree + "/sim/worlds/ball.sdf";
  options.robot_path = kRobot;
  options.camera_path = kTree + "/shared/robot/kaz/camera.json";
  options.recording_path = path;
  options.tap = view;
  auto simulation = sim::Simulation::create(options);
  EXPECT_TRUE(simulation.has_value()) << simulation.error().message;
  for (int i = 0; i < 300; ++i) EXPECT_TRUE((*simulation)->step().has_value());
  const auto hash = (*simulation)->finish_recording();
  return hash ? *hash : hash.error().message;
}

nlohmann::json subscriptions(const std::vector<std::uint32_t>& channels) {
  auto list = nlohmann::json::array();
  for (const auto channel : channels) list.push_back({{"id", channel}, {"channelId", channel}});
  return {{"op", "subscribe"}, {"subscriptions", list}};
}

struct Received {
  std::uint64_t time_ns = 0;
  Bytes data;
  bool operator==(const Received&) const = default;
};

Received received(const Bytes& frame) {
  sim::LittleEndianFields fields(frame);
  fields.number<std::uint8_t>();
  fields.number<std::uint32_t>();
  Received message;
  message.time_ns = fields.number<std::uint64_t>();
  message.data.assign(fields.rest().begin(), fields.rest().end());
  return message;
}

TEST(View, WithoutAPageABrowserShowsTheReason) {
  ViewOptions options;
  options.where = "127.0.0.1:0";
  options.robot_path = kRobot;
  options.page_folder = kTree + "/sim/worlds";  // no index.html in it
  options.no_page = "not built <yet>";
  const auto view = View::open(options);
  ASSERT_TRUE(view.has_value()) << view.error().message;
  const std::string shown = answer((*view)->server().port(), get("/"));
  EXPECT_NE(shown.find("200 OK"), std::string::npos) << shown;
  EXPECT_NE(shown.find("text/plain"), std::string::npos) << "else <yet> would be HTML";
  EXPECT_NE(shown.find("not built <yet>.\nFoxglove"), std::string::npos) << shown;
}

TEST(View, WatchedOrNotTheRecordingIsTheSameAndAReaderThatKeepsUpHasAllOfIt) {
  const sim::TestFolder folder;
  const std::string alone = recorded(folder.file("alone.mcap"), nullptr);
  const auto view = opened(true);
  std::vector<Received> joints, wire, poses, contacts;
  int boards = 0, scenes = 0;
  std::thread viewer([&, port = view->server().port()] {
    Client client(port);
    ASSERT_TRUE(client.open("foxglove.sdk.v1"));
    const auto joint_channel = client.channel("/truth/joints"), tf = client.channel("/tf"),
               board = client.channel("/board/state"), scene = client.channel("/scene"),
               pins = client.channel("/board/pins"), touch = client.channel("/contacts");
    client.send(subscriptions({joint_channel, tf, board, scene, pins, touch}));
    while (joints.size() < 300 || boards < 8) {  // the board's state is made of what came before
      const auto frame = client.next_frame(1);
      ASSERT_TRUE(frame);
      const std::uint32_t id = (*frame)[1];
      if (id == joint_channel) joints.push_back(received(*frame));
      if (id == pins) wire.push_back(received(*frame));
      if (id == tf) poses.push_back(received(*frame));
      if (id == touch) contacts.push_back(received(*frame));
      boards += id == board;
      scenes += id == scene;
    }
  });
  const std::string watched = recorded(folder.file("watched.mcap"), view.get());
  viewer.join();
  EXPECT_EQ(watched, alone);
  const auto file = sim::McapRecording::load(folder.file("watched.mcap"));
  ASSERT_TRUE(file.has_value());
  std::map<std::string, std::vector<Received>> in_file;
  for (const auto& message : file->messages)
    in_file[file->topics.at(message.channel)].push_back({message.time_ns, message.data});
  EXPECT_EQ(joints, in_file["/truth/joints"]);
  EXPECT_EQ(poses, in_file["/tf"]);
  EXPECT_EQ(contacts, in_file["/contacts"]);
  EXPECT_EQ(in_file["/scene"].size(), 1u);
  EXPECT_EQ(in_file["/robot_description"].size(), 1u);
  EXPECT_GE(wire.size(), 299u);
  EXPECT_GE(poses.size(), 8u);  // 30 Hz
  EXPECT_EQ(contacts.size(), poses.size());
  EXPECT_EQ(scenes, 1);
}

// Who comes in the midst of a run sees the robot and its world, too.
TEST(View, WhoComesLaterGetsWhatIsSentOnce) {
  const auto view = opened();
  EXPECT_EQ(recorded("", view.get()), "");
  Client client(view->server().port());
  ASSERT_TRUE(client.open("foxglove.sdk.v1"));
  const auto scene = client.channel("/scene"), robot = client.channel("/robot_description");
  client.send(subscriptions({scene, robot}));
  std::set<std::uint32_t> got;
  while (got.size() < 2) {
    const auto frame = client.next_frame(1);
    ASSERT_TRUE(frame);
    got.insert((*frame)[1]);
  }
  EXPECT_EQ(got, (std::set<std::uint32_t>{scene, robot}));
}

TEST(View, WithoutAFileTheSameIsHeard) {
  const auto view = opened(true);
  std::atomic<int> heard = 0;
  std::thread viewer([&, port = view->server().port()] {
    Client client(port);
    ASSERT_TRUE(client.open("foxglove.websocket.v1"));
    client.send(subscriptions({client.channel("/truth/joints")}));
    while (heard < 300 && client.next_frame(1)) ++heard;
  });
  EXPECT_EQ(recorded("", view.get()), "");
  viewer.join();
  EXPECT_EQ(heard, 300);
}

TEST(View, ARecordingIsPlayedWithPausesAndJumps) {
  const sim::TestFolder folder;
  recorded(folder.file("run.mcap"), nullptr);
  const auto recording = sim::McapRecording::load(folder.file("run.mcap"));
  ASSERT_TRUE(recording.has_value());
  std::atomic<bool> stop = false;
  std::atomic<int> port = 0;
  std::string token;
  PlayOptions options;
  options.view.where = "127.0.0.1:0";
  options.view.robot_path = kRobot;
  options.view.wait = true;
  options.view.stopped = [&] { return stop.load(); };
  options.on_open = [&](const std::string& url) {
    token = url.substr(url.find('?'));
    port = std::stoi(url.substr(url.find(':', 6) + 1));
  };
  std::thread player([&] { EXPECT_TRUE(play(*recording, options).has_value()); });
  while (port == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  {
    Client client(static_cast<std::uint16_t>(port.load()));
    ASSERT_TRUE(client.open("foxglove.sdk.v1", "/" + token));
    EXPECT_EQ(client.next_op("serverInfo")["capabilities"].back(), "playbackControl");
    client.send(subscriptions({client.channel("/tf"), client.channel("/truth/joints")}));
    EXPECT_TRUE(client.next_frame(1));
    // The robot, its world and its poses are those of the recording.
    std::set<std::uint32_t> missing{client.channel("/tf"), client.channel("/scene"),
                                    client.channel("/robot_description")};
    client.send(subscriptions({client.channel("/scene"), client.channel("/robot_description")}));
    while (!missing.empty()) {
      const auto frame = client.next_frame(1);
      ASSERT_TRUE(frame);
      missing.erase((*frame)[1]);
    }
    // Paused at 0.1 s: the state says so.
    client.send(
        Bytes{3, 1, 0, 0, 0x80, 0x3f, 1, 0x00, 0xe1, 0xf5, 0x05, 0, 0, 0, 0, 1, 0, 0, 0, 'x'});
    std::optional<Bytes> state;
    do {
      state = client.next_frame(5);
      ASSERT_TRUE(state);
    } while (state->back() != 'x');
    EXPECT_EQ((*state)[1], 1);  // paused
    EXPECT_EQ((Bytes(state->begin() + 2, state->begin() + 10)),
              (Bytes{0x00, 0xe1, 0xf5, 0x05, 0, 0, 0, 0}));
    // Played from 0.2 s to the end.
    client.send(Bytes{3, 0, 0, 0, 0x80, 0x3f, 1, 0x00, 0xc2, 0xeb, 0x0b, 0, 0, 0, 0, 0, 0, 0, 0});
    do {
      state = client.next_frame(5);
      ASSERT_TRUE(state);
    } while ((*state)[1] != 3);
  }
  stop = true;
  player.join();
}

TEST(View, ARecordingWithoutPicturesSaysHowToRecordSome) {
  sim::McapRecording recording;
  recording.facts = {{"behavior", "search-ball"},
                     {"world", "catch"},
                     {"eyes", "real"},
                     {"imu", "true"},
                     {"seed", "7"}};
  const auto says = [&](const char* part) {
    return no_pictures_text(recording).find(part) != std::string::npos;
  };
  EXPECT_TRUE(
      says("contains no pictures. kaz replay RECORDING --video film.mp4 renders the left eye's "
           "pictures. "));
  EXPECT_TRUE(
      says("kaz run search-ball --world catch --eyes real --imu --seed 7 --out DIR "
           "--record-pictures"));
  recording.facts["behavior"] = std::string(1 << 20, 'x');
  EXPECT_TRUE(says("kaz run BEHAVIOR --world catch"));
  recording.facts = {{"seed", "7"}};
  EXPECT_TRUE(says("kaz sim --record FILE --record-pictures"));
  recording.facts["port"] = "serial:/dev/ttyUSB0";
  EXPECT_TRUE(says("a robot at a port are not recorded"));
  recording.topics[3] = "/eyes/left";
  EXPECT_TRUE(says("not recorded")) << "a channel without messages";
  recording.messages.push_back({3, 0, {}});
  EXPECT_EQ(no_pictures_text(recording), "no pictures yet");
}

TEST(View, ViewersMayReadWhyThereAreNoPictures) {
  const auto view = opened(false, "robot");
  Client client(view->server().port());
  ASSERT_TRUE(client.open("foxglove.sdk.v1"));
  client.send(nlohmann::json{{"op", "getParameters"}, {"parameterNames", {"no_pictures"}}});
  const auto parameters = client.next_op("parameterValues")["parameters"];
  ASSERT_EQ(parameters.size(), 1u);
  EXPECT_NE(parameters[0]["value"].dump().find("use kaz run --camera"), std::string::npos);
}

// What a board states, as the recording of a run at a port has it.
TEST(View, ARobotAtAPortStandsOnItsLowerFootAtTheAnglesOfItsBoards) {
  const auto view = opened(false, "robot");
  const auto recorder = sim::Recorder::create("", {}, view.get());
  ASSERT_TRUE(recorder.has_value());
  Client client(view->server().port());
  ASSERT_TRUE(client.open("foxglove.sdk.v1"));
  const auto tf = client.channel("/tf"), states = client.channel("/joint_states");
  client.send(subscriptions({tf, states}));
  while (view->server().subscriptions() < 2)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));

  sim::States at = 0;
  const auto pass = [&](std::size_t line, u8 type, const auto& message, auto pack) {
    std::array<u8, KZ_BODY_MAX> body{1, type, 1};
    std::array<u8, KZ_FRAME_MAX> frame{};
    const u8 size = pack(&message, body.data() + KZ_HEADER_SIZE);
    const u8 length =
        kz_frame_encode(body.data(), static_cast<u8>(KZ_HEADER_SIZE + size), frame.data());
    std::vector<sim::SerialByte> bytes;
    for (u8 i = 0; i < length; ++i) bytes.push_back({.value = frame[i], .at = at});
    (*recorder)->wire(type == KZ_TYPE_targets ? sim::Recorder::Direction::to_board
                                              : sim::Recorder::Direction::to_host,
                      at, bytes, line);
    at += 100 * KZ_STATES_PER_TICK;
  };
  const auto requested = [&](std::size_t line, std::uint32_t mask) {
    kz_targets targets{};
    targets.mask = mask;
    pass(line, KZ_TYPE_targets, targets, kz_pack_targets);
  };
  const auto stated = [&](std::size_t line, double angle) {
    kz_state_reply state{};
    for (auto& one : state.angle) one = static_cast<s16>(std::lround(angle * KZ_ANGLE_PER_RAD));
    pass(line, KZ_TYPE_state_reply, state, kz_pack_state_reply);
  };
  const auto names = sim::joint_names();
  const auto joint = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  // The second board has the neck.
  requested(1, 1u << joint("neck_pan"));
  stated(0, 0.1);
  stated(1, -0.3);
  std::optional<Bytes> poses, angles;
  for (int i = 0; i < 4; ++i) {
    const auto frame = client.next_frame(1);
    ASSERT_TRUE(frame);
    ((*frame)[1] == tf ? poses : angles) = frame;
  }
  ASSERT_TRUE(poses && angles);
  const auto reals = [](const Bytes& bytes, std::size_t offset) {
    sim::LittleEndianFields fields({bytes.data() + offset, bytes.size() - offset});
    return std::bit_cast<double>(fields.number<std::uint64_t>());
  };
  const Bytes content = received(*angles).data;
  sim::LittleEndianFields fields(content);
  for (int i = 0; i < 3; ++i) fields.number<std::uint32_t>();
  fields.text();
  const auto count = fields.number<std::uint32_t>();
  ASSERT_EQ(count, std::uint32_t{KZ_JOINTS});
  for (std::uint32_t i = 0; i < count; ++i) fields.text();
  ASSERT_EQ(fields.number<std::uint32_t>(), count);
  const std::size_t begin = content.size() - fields.rest().size();
  EXPECT_NEAR(reals(content, begin + 8 * joint("neck_pan")), -0.3, 1e-3);
  EXPECT_NEAR(reals(content, begin + 8 * joint("l_knee")), 0.1, 1e-3);

  const Bytes all = received(*poses).data;
  sim::LittleEndianFields links(all);
  double trunk = 0;
  for (auto left = links.number<std::uint32_t>(); left > 0; --left) {
    for (int i = 0; i < 3; ++i) links.number<std::uint32_t>();
    links.text();
    const bool is_trunk = links.text() == "trunk";
    for (int i = 0; i < 7; ++i) {
      const double x = std::bit_cast<double>(links.number<std::uint64_t>());
      if (is_trunk && i == 2) trunk = x;
    }
  }
  EXPECT_TRUE(links.good());
  EXPECT_GT(trunk, 0.1);
  EXPECT_LT(trunk, 0.2);
}

Bytes published(std::uint32_t channel, const std::string& line) {
  const std::string text = nlohmann::json{{"do", line}}.dump();
  Bytes frame{1, static_cast<std::uint8_t>(channel), 0, 0, 0};
  frame.insert(frame.end(), text.begin(), text.end());
  return frame;
}

TEST(View, WhoHasTheTokenDoesThingsByHandAndNobodyElse) {
  ViewOptions options;
  options.where = "127.0.0.1:0";
  options.robot_path = kRobot;
  options.hands = options.open = true;
  const auto view = View::open(options);
  ASSERT_TRUE(view.has_value());
  const nlohmann::json hand{
      {"op", "advertise"},
      {"channels", {{{"id", 7}, {"topic", "/hand"}, {"encoding", "json"}, {"schemaName", ""}}}}};
  const auto port = (*view)->server().port();
  Client stranger(port);
  ASSERT_TRUE(stranger.open("foxglove.sdk.v1"));
  stranger.send(hand);
  EXPECT_NE(stranger.next_op("status").dump().find("with its token"), std::string::npos);
  stranger.send(published(7, "power_reset"));
  EXPECT_NE(stranger.next_op("status").dump().find("with its token"), std::string::npos);

  Client owner(port);
  const std::string url = (*view)->url();
  ASSERT_TRUE(owner.open("foxglove.websocket.v1", "/" + url.substr(url.find('?'))));
  const auto info = owner.next_op("serverInfo");
  EXPECT_EQ(std::ranges::count(info["capabilities"], "clientPublish"), 1);
  owner.send(published(7, "power_reset"));
  EXPECT_NE(owner.next_op("status").dump().find("advertise the channel"), std::string::npos);
  owner.send(hand);
  owner.send(published(7, "fly away"));
  EXPECT_NE(owner.next_op("status").dump().find("give `push LINK X Y Z`"), std::string::npos);
  owner.send(published(7, "power_reset"));
  owner.send(published(7, "hold moon 0 0 0"));
  owner.send(published(7, "no more"));  // its refusal: the others have been heard
  owner.next_op("status");
  EXPECT_EQ((*view)->take(Time::zero()),
            (std::vector<std::string>{"power_reset", "hold moon 0 0 0"}));
  EXPECT_TRUE((*view)->take(Time::zero()).empty());
  (*view)->refused("hold moon 0 0 0", Error{Fault::usage, "there is no moon"});
  EXPECT_NE(owner.next_op("status").dump().find("there is no moon"), std::string::npos);
  EXPECT_EQ((*view)->done_by_hand(), 1);
}

TEST(View, WithoutHandsNothingIsDoneByThem) {
  const auto view = opened();
  Client owner(view->server().port());
  const std::string url = view->url();
  ASSERT_TRUE(owner.open("foxglove.sdk.v1", "/" + url.substr(url.find('?'))));
  EXPECT_EQ(std::ranges::count(owner.next_op("serverInfo")["capabilities"], "clientPublish"), 0);
  owner.send(published(7, "power_reset"));
  EXPECT_NE(owner.next_op("status").dump().find("cannot be controlled by hand"), std::string::npos);
}

TEST(View, ARunIsPausedStepsAndGoesOnAndIsTheSame) {
  const sim::TestFolder folder;
  ViewOptions options;
  options.where = "127.0.0.1:0";
  options.robot_path = kRobot;
  options.hands = options.wait = options.open = true;
  const auto view = View::open(options);
  ASSERT_TRUE(view.has_value());
  std::thread viewer([&] {
    Client owner((*view)->server().port());
    const std::string url = (*view)->url();
    ASSERT_TRUE(owner.open("foxglove.sdk.v1", "/" + url.substr(url.find('?'))));
    owner.send(nlohmann::json{
        {"op", "advertise"},
        {"channels", {{{"id", 1}, {"topic", "/hand"}, {"encoding", "json"}, {"schemaName", ""}}}}});
    owner.send(published(1, "pause"));
    owner.send(subscriptions({owner.channel("/truth/joints")}));
    const auto last = [&](int milliseconds) {
      std::uint64_t time = 0;
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds);
      while (std::chrono::steady_clock::now() < end) {
        owner.send(published(1, "nothing"));  // its refusal comes at once
        while (const auto message = owner.next()) {
          if (owner.is_text()) break;
          if (message->front() == 1) time = std::max(time, received(*message).time_ns);
        }
      }
      return time;
    };
    const auto first = owner.next_frame(1);
    ASSERT_TRUE(first);
    EXPECT_EQ(received(*first).time_ns, 1'000'000u);
    owner.send(published(1, "pace 1e-300"));  // less than --pace takes
    EXPECT_EQ(last(200), 0u) << "paused behind the first step";
    // Who comes now is shown where the robot is, and that the run pauses.
    Client late((*view)->server().port());
    EXPECT_TRUE(late.open("foxglove.sdk.v1"));
    late.send(subscriptions({late.channel("/tf"), late.channel("/run/pace")}));
    std::vector<std::string> texts;
    for (int i = 0; i < 2; ++i) {
      const auto frame = late.next_frame(1);
      ASSERT_TRUE(frame);
      const Bytes data = received(*frame).data;
      texts.emplace_back(data.begin(), data.end());
    }
    std::ranges::sort(texts, {}, &std::string::size);
    EXPECT_EQ(texts[0], R"({"paused":true,"pace":0.0})");
    EXPECT_NE(texts[1].find("neck_tilt"), std::string::npos);
    owner.send(published(1, "step 0.1"));
    EXPECT_EQ(last(300), 101'000'000u);
    owner.send(published(1, "go"));
    EXPECT_EQ(last(500), 300'000'000u);
  });
  const std::string paused = recorded(folder.file("paused.mcap"), view->get());
  viewer.join();
  EXPECT_EQ(paused, recorded(folder.file("alone.mcap"), nullptr));
}

// A robot's file may lie anywhere, as in somebody's home.
TEST(View, OfTheRobotsFolderOnlyWhatItsFileNamesIsServed) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "kaz-view-package/robot";
  std::filesystem::remove_all(folder.parent_path());
  std::filesystem::create_directories(folder / "meshes");
  const std::string mesh =
      "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\n"
      "vertex 0 0.1 0\nendloop\nendfacet\nendsolid one\n";
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
  };
  write("meshes/part.stl", mesh);
  write("meshes/private.stl", mesh);
  // With a package.xml above, meshes beside the file's folder are drawn, but they are not served.
  write("../package.xml", "<package/>");
  write("../beside.stl", mesh);
  std::filesystem::create_symlink("../../beside.stl", folder / "meshes/link.stl");
  write("holiday.png", "private");
  std::string arm = *read_whole_file(kTree + "/sim/robots/arm/arm.urdf", 1 << 20);
  const std::string plate = R"(<cylinder radius="0.06" length="0.02"/>)";
  for (const char* name : {"meshes/part.stl", "meshes/link.stl", "../beside.stl"}) {
    ASSERT_NE(arm.find(plate), std::string::npos);
    arm.replace(arm.find(plate), plate.size(),
                "<mesh filename=\"" + std::string(name) +
                    "\"/></geometry></visual><visual><geometry>" + plate);
  }
  write("arm.urdf", arm);
  ViewOptions options;
  options.where = "127.0.0.1:0";
  options.robot_path = (folder / "arm.urdf").string();
  options.open = true;
  std::string url;
  const auto server = open_server(options, 0, 0, url);
  ASSERT_TRUE(server.has_value()) << server.error().message;
  const auto found = [&](const std::string& path) {
    return answer((*server)->port(), get(path)).find(" 200 ") != std::string::npos;
  };
  EXPECT_TRUE(found("/robot.urdf"));
  EXPECT_TRUE(found("/robot/arm.urdf"));
  EXPECT_TRUE(found("/robot/meshes/part.stl"));
  EXPECT_FALSE(found("/robot/meshes/private.stl"));
  EXPECT_FALSE(found("/robot/meshes/link.stl"));
  EXPECT_FALSE(found("/robot/beside.stl"));
  EXPECT_FALSE(found("/beside.stl"));
  EXPECT_FALSE(found("/robot/holiday.png"));
  std::filesystem::remove_all(folder.parent_path());
}

TEST(View, AddressesAreUnderstoodOrRefused) {
  EXPECT_EQ(parse_where("")->port, 8765);
  EXPECT_EQ(parse_where("9000")->address, "127.0.0.1");
  EXPECT_EQ(parse_where("[::1]:80")->address, "::1");
  for (const char* wrong : {"x", "localhost:80", "127.0.0.1:", "1.2.3.4:70000", ":80", "-1"})
    EXPECT_FALSE(parse_where(wrong).has_value()) << wrong;
}

TEST(View, WithoutAViewerItCostsNothing) {
  const sim::TestFolder folder;
  const auto view = opened();
  const auto before = view->server().cpu_ns();
  recorded("", view.get());
  EXPECT_LT(view->server().cpu_ns() - before, 5'000'000u);
}

}  // namespace
}  // namespace kaz::viewer
