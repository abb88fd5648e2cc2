// `kaz sim --bus` with clients over its pty: the example in Python, wrong usage, and how it ends.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/control_socket_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;

const std::string kArm = "sim/robots/so101/so101.urdf";

std::vector<std::string> simulator(const std::string& port) {
  return kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port});
}

TEST(ServoBusVerb, ServesTheExampleInPython) {
  const TemporaryFolder folder;
  const std::string port = folder / "arm";
  Process sim(simulator(port));
  ASSERT_TRUE(sim.wait_for_output("ready: 6 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished waved = run({KAZ_PYTHON, "-B", "examples/python/servo_arm.py", port});
  EXPECT_EQ(waved.exit_code, 0) << waved.out << waved.err;
  EXPECT_NE(waved.out.find("servo 6: 7.4 V"), std::string::npos) << waved.out;
  EXPECT_NE(waved.out.find("lost or damaged: 0"), std::string::npos) << waved.out;
  const Finished after =
      run(kaz({"bus", "status", "--robot", "feetech:" + port, "--robot-file", kArm, "--json"}));
  EXPECT_EQ(after.exit_code, 0) << after.err;
  EXPECT_EQ(after.out.find("\"torque\": true"), std::string::npos) << after.out;
  EXPECT_NE(after.out.find("\"torque\": false"), std::string::npos) << after.out;
  sim.signal(SIGINT);
  const Finished ended = sim.wait(seconds(10));
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.out.find("host sends at 1000000 baud"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("lost: 0;"), std::string::npos) << ended.out;
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(port)));
  EXPECT_FALSE(std::filesystem::exists(port + ".ctl"));
}

TEST(ServoBusVerb, ServesDynamixelsToTheExampleInPython) {
  const TemporaryFolder folder;
  const std::string port = folder / "mini";
  Process sim(kaz({"sim", "--bus", "dynamixel", "--robot-file", "sim/robots/mini/mini.urdf",
                   "--serial", port, "--suspended"}));
  ASSERT_TRUE(sim.wait_for_output("ready: 18 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished nodded = run({KAZ_PYTHON, "-B", "examples/python/servo_humanoid.py", port});
  EXPECT_EQ(nodded.exit_code, 0) << nodded.out << nodded.err;
  EXPECT_NE(nodded.out.find("18 servos, 5.0 V"), std::string::npos) << nodded.out;
  EXPECT_NE(nodded.out.find("lost or damaged: 0"), std::string::npos) << nodded.out;
  // At another rate nobody answers.
  const Finished silent = run({KAZ_PYTHON, "-B", "examples/python/servo_humanoid.py", port,
                               "--baud", "115200", "--ids", "1-5"});
  EXPECT_EQ(silent.exit_code, 3) << silent.out;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

TEST(ServoBusVerb, ScanFindsServosAndWhatIsWrongWithThem) {
  const TemporaryFolder folder;
  const std::string port = folder / "arm";
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", "sim/robots/so101/so101.urdf",
                   "--serial", port}));
  ASSERT_TRUE(sim.wait_for_output("ready: 6 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const auto scan = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"bus", "scan", "--port", port, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run(kaz(words), seconds(60));
  };
  const Finished good =
      scan({"--protocol", "feetech", "--baud", "1000000,500000", "--ids", "0-10"});
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  const auto json = nlohmann::json::parse(good.out);
  ASSERT_EQ(json["servos"].size(), 6u) << good.out;
  for (int i = 0; i < 6; ++i) {
    const auto& servo = json["servos"][static_cast<std::size_t>(i)];
    EXPECT_EQ(servo["id"], i + 1);
    EXPECT_EQ(servo["model"], "sts3215");
    EXPECT_EQ(servo["baud"], 1000000);
    EXPECT_EQ(servo["damaged"], 0);
    EXPECT_EQ(servo["torque"], false);
    EXPECT_NEAR(servo["volts"].get<double>(), 7.4, 0.3);
  }
  // A noisy wire is one for all servos; each is still found.
  query_control(port + ".ctl", "damage 0.003");
  const Finished noisy =
      scan({"--protocol", "feetech", "--baud", "1000000", "--ids", "1-6", "--readings", "300"});
  EXPECT_EQ(noisy.exit_code, 1) << noisy.out;
  EXPECT_EQ(nlohmann::json::parse(noisy.out)["servos"].size(), 6u) << noisy.out;
  EXPECT_NE(noisy.out.find("check plugs"), std::string::npos) << noisy.out;
  query_control(port + ".ctl", "damage 0");
  query_control(port + ".ctl", "supply 3.8");
  const Finished low = scan({"--protocol", "feetech", "--baud", "1000000", "--ids", "1-6"});
  EXPECT_EQ(low.exit_code, 1) << low.out;
  EXPECT_NE(low.out.find("its voltage is out of bounds"), std::string::npos) << low.out;
  const Finished nobody = run(kaz({"bus", "scan", "--port", port, "--protocol", "dynamixel",
                                   "--baud", "57600", "--ids", "1-9"}));
  EXPECT_EQ(nobody.exit_code, 1) << nobody.out;
  EXPECT_NE(nobody.out.find("no servo answers on "), std::string::npos) << nobody.out;
  EXPECT_EQ(scan({"--ids", "7-3"}).exit_code, 2);
  EXPECT_EQ(run(kaz({"bus", "scan", "--port", "can:can0"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"bus", "scan", "--port", folder / "none"})).exit_code, 3);
}

// Both answer a ping with the same bytes; what they measure differs.
TEST(ServoBusVerb, ScanSuspectsTwoServosOfOneId) {
  const TemporaryFolder folder;
  const std::string robot = folder / "robot";
  std::filesystem::copy("sim/robots/so101", robot, std::filesystem::copy_options::recursive);
  auto bus = nlohmann::json::parse(std::ifstream(robot + "/bus.json"));
  bus["servos"][1]["id"] = bus["servos"][2]["id"];
  std::ofstream(robot + "/bus.json") << bus.dump(1);
  const std::string port = folder / "arm";
  Process sim(
      kaz({"sim", "--bus", "feetech", "--robot-file", robot + "/so101.urdf", "--serial", port}));
  ASSERT_TRUE(sim.wait_for_output("ready: 6 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished scan = run(kaz({"bus", "scan", "--port", port, "--protocol", "feetech", "--baud",
                                 "1000000", "--ids", "1-6"}),
                            seconds(60));
  EXPECT_EQ(scan.exit_code, 1) << scan.out << scan.err;
  EXPECT_NE(scan.out.find("perhaps because two servos have this id:"), std::string::npos)
      << scan.out;
}

TEST(ServoBusVerb, ConformanceOfServosOfBothMakers) {
  const TemporaryFolder folder;
  const struct {
    std::string protocol, robot, ready, model;
    std::vector<std::string> more;
  } buses[] = {{"feetech", kArm, "ready: 6 servos", "sts3215", {}},
               {"dynamixel",
                "sim/robots/mini/mini.urdf",
                "ready: 18 servos",
                "xl330-m288",
                {"--baud", "1000000"}}};
  for (const auto& bus : buses) {
    const std::string port = folder / bus.protocol;
    Process sim(kaz({"sim", "--bus", bus.protocol, "--robot-file", bus.robot, "--serial", port,
                     "--suspended"}));
    ASSERT_TRUE(sim.wait_for_output(bus.ready, seconds(30))) << sim.wait(seconds(0)).err;
    const auto conformance = [&](std::vector<std::string> more) {
      std::vector<std::string> words{"conformance", "--bus", bus.protocol, "--port", port};
      words.insert(words.end(), bus.more.begin(), bus.more.end());
      words.insert(words.end(), more.begin(), more.end());
      return run(kaz(words), seconds(90));
    };
    const Finished good = conformance({"--id", "2", "--json"});
    EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
    const auto json = parse_json(good.out);
    EXPECT_EQ(json["failed"], 0);
    EXPECT_GE(json["passed"].get<int>(), 15);
    EXPECT_EQ(json["board"].get<std::string>().find(bus.model + ", id 2"), 0u) << json["board"];
    for (const auto& one : json["results"]) {
      if (one["verdict"] == "left out") {
        EXPECT_NE(one["message"], "") << one["id"];
      }
    }
    const Finished moved =
        conformance({"--id", "2", "--allow-motion", "--filter", "^motion", "--junit",
                     folder / "report.xml", "--html", folder / "report.html"});
    EXPECT_EQ(moved.exit_code, 0) << moved.out << moved.err;
    EXPECT_NE(read_file(folder / "report.xml").find("motion.goal"), std::string::npos);
    EXPECT_NE(read_file(folder / "report.html").find("conforms"), std::string::npos);
    // Ctrl-C: what is altered is put back, and the torque is off.
    const auto altered = [&] {
      std::string text;
      const auto status = parse_json(query_control(port + ".ctl", "status"));
      for (const auto& servo : status["servos"]) text += servo["torque"].dump() + " ";
      return text;
    };
    Process broken(kaz({"conformance", "--bus", bus.protocol, "--port", port, "--baud", "1000000",
                        "--id", "2", "--allow-motion", "--filter", "^motion.goal"}));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    broken.signal(SIGINT);
    const int code = broken.wait(seconds(10)).exit_code;
    EXPECT_TRUE(code == 128 + SIGINT || code == 0) << code;  // 0: it was faster
    EXPECT_EQ(altered().find('1'), std::string::npos) << altered();
    const Finished nobody = conformance({"--id", "200"});
    EXPECT_EQ(nobody.exit_code, 3) << nobody.out;
    EXPECT_NE(nobody.err.find("servo 200 on "), std::string::npos) << nobody.err;
    // A noisy wire is no conforming servo: it fails, or cannot be judged.
    query_control(port + ".ctl", "damage 0.02");
    EXPECT_NE(conformance({"--id", "2"}).exit_code, 0);
    sim.signal(SIGINT);
    EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
  }
  EXPECT_EQ(run(kaz({"conformance", "--bus", "feetech"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"conformance", "--id", "3", "--port", "x"})).exit_code, 2);
  EXPECT_EQ(
      run(kaz({"conformance", "--bus", "feetech", "--port", "x", "--filter", "motion"})).exit_code,
      2);
  EXPECT_EQ(run(kaz({"conformance", "--bus", "feetech", "--list"})).exit_code, 0);
  const auto list =
      parse_json(run(kaz({"conformance", "--bus", "dynamixel", "--list", "--json"})).out);
  ASSERT_GT(list.size(), 30u);
  for (const auto& one : list) {
    if (one["id"] == "motion.goal") {
      EXPECT_EQ(one["needs"], nlohmann::json({"motion"}));
    }
  }
}

TEST(ServoBusVerb, APendulumIsRecordedAndItsServoFitted) {
  const TemporaryFolder folder;
  const std::string port = folder / "bench";
  Process sim(kaz({"sim", "--bus", "feetech", "--robot-file", "sim/robots/pendulum/pendulum.urdf",
                   "--serial", port}));
  ASSERT_TRUE(sim.wait_for_output("ready: 1 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const auto record = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"bench",  "pendulum", "--bus",    "feetech", "--port", port,
                                   "--mass", "0.3",      "--length", "0.15",    "--arm",  "0.02"};
    words.insert(words.end(), more.begin(), more.end());
    return kaz(words);
  };
  const auto torque = [&] {
    return parse_json(query_control(port + ".ctl", "status"))["servos"][0]["torque"];
  };
  // Ctrl-C while it swings.
  Process broken(record({"--yes", "--out", folder / "none"}));
  std::this_thread::sleep_for(seconds(4));
  EXPECT_EQ(torque(), 1);
  broken.signal(SIGINT);
  EXPECT_EQ(broken.wait(seconds(10)).exit_code, 128 + SIGINT);
  EXPECT_EQ(torque(), 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
  const Finished nobody = run(record({"--out", folder / "none"}));
  EXPECT_EQ(nobody.exit_code, 2) << nobody.err;
  EXPECT_NE(nobody.err.find("nothing was moved"), std::string::npos) << nobody.err;

  // With --seconds 3, the motions are so fast that the fitted torque constant is 30 % too high.
  const Finished done = run(record({"--yes", "--out", folder / "logs", "--json"}), seconds(300));
  ASSERT_EQ(done.exit_code, 0) << done.out << done.err;
  EXPECT_EQ(torque(), 0);
  std::vector<std::string> fit{"bench", "servo"}, held{"--held-out"};
  const auto recorded = parse_json(done.out);
  for (const auto& log : recorded["logs"]) {
    EXPECT_EQ(log["goals"], "profile");
    (log["held_out"].get<bool>() ? held : fit)
        .push_back(folder / "logs/" + log["file"].get<std::string>());
  }
  ASSERT_EQ(fit.size(), 10u);
  ASSERT_EQ(held.size(), 5u);
  fit.insert(fit.end(), held.begin(), held.end());
  for (const char* word : {"--model", "1", "--json", "--out"}) fit.push_back(word);
  fit.push_back(folder / "fit");
  const Finished fitted = run(kaz(fit), seconds(300));
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const auto model = parse_json(fitted.out)["models"][0];
  // In real time, beside others: 1 degree. The motor file has 1.297 Nm/A.
  EXPECT_LT(model["held_out"]["position_rad"].get<double>(), 0.0175);
  EXPECT_NEAR(model["params"]["kt"]["value"].get<double>(), 1.297, 0.3);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

TEST(ServoBusVerb, RefusesWhatABusDoesNotHave) {
  const TemporaryFolder folder;
  const std::string port = folder / "arm";
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"sim", "--bus", "feetech", "--serial", port}, "--robot-file is missing"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm}, "--serial is missing"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port, "--mcu", "native"},
       "--mcu: not supported with --bus; leave --mcu or --bus out"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port, "--stand"},
       "--stand: not supported with --bus; leave --stand or --bus out"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port, "--view"},
       "--view: not supported with --bus yet; leave --view or --bus out"},
      // The arm's joints are not a board's, in the verbs that simulate one.
      {{"run", "stand", "--robot-file", kArm},
       "is a robot with bus servos (bus.json): start `kaz sim --bus feetech --robot-file "},
      {{"sim", "--bus", "feetech", "--robot-file", "sim/robots/arm/arm.urdf", "--serial", port},
       "sim/robots/arm/bus.json"},
      {{"sim", "--bus", "dynamixel", "--robot-file", kArm, "--serial", port},
       "has servos of the protocol feetech"},
      {{"sim", "--bus", "can", "--robot-file", kArm, "--serial", port}, "--bus"}};
  for (const auto& [arguments, reason] : wrong) {
    const Finished finished = run(kaz(arguments));
    EXPECT_EQ(finished.exit_code, 2) << reason;
    EXPECT_NE(finished.err.find(reason), std::string::npos) << finished.err;
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(port))) << reason;
  }
}

}  // namespace
}  // namespace kaz::test
