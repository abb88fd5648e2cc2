// `kaz evaluate`: episodes that can be repeated, interrupted, shared out and joined.
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A quick one: the head alone, no firmware to emulate.
Finished evaluate(std::vector<std::string> more) {
  std::vector<std::string> all{"evaluate", "search-ball", "--mcu",     "native", "--eyes",
                               "ideal",    "--set",       "seconds=8", "--json", "--bearing",
                               "60",       "--seed",      "3"};
  all.insert(all.end(), more.begin(), more.end());
  return run(kaz(all));
}

std::vector<json> without_speed(const std::string& folder, int episodes) {
  std::vector<json> all;
  for (int i = 0; i < episodes; ++i) {
    const std::string path = folder + "/episodes/00000" + std::to_string(i) + ".json";
    if (!fs::exists(path)) continue;
    all.push_back(parse_json(read_file(path)));
    all.back().erase("rtf");
  }
  return all;
}

TEST(Evaluate, PartsJoinToTheWhole) {
  const TemporaryFolder folder;
  const Finished whole = evaluate({"--episodes", "4", "--jobs", "2", "--out", folder / "whole"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const json result = parse_json(whole.out);
  EXPECT_EQ(result, parse_json(read_file(folder / "whole/result.json")));
  EXPECT_EQ(result["episodes"], 4);
  const double rate = result["success_rate"].get<double>();
  EXPECT_LE(result["interval"][0].get<double>(), rate);
  EXPECT_GE(result["interval"][1].get<double>(), rate);
  EXPECT_GT(result["interval"][1].get<double>() - result["interval"][0].get<double>(), 0.3);
  const auto all = without_speed(folder / "whole", 4);
  ASSERT_EQ(all.size(), 4u);
  // All fields that should vary do.
  for (const char* what : {"seed", "friction", "supply_volts", "ball_m", "start", "lamp", "shade",
                           "lamp_azimuth_rad", "lamp_height_rad"}) {
    ASSERT_TRUE(all[0]["scenario"].contains(what)) << what;
    EXPECT_NE(all[0]["scenario"][what], all[1]["scenario"][what]) << what;
  }
  // A failure leaves its recording, a success does not.
  for (int i = 0; i < 4; ++i) {
    const bool success = all[static_cast<std::size_t>(i)]["success"].get<bool>();
    const std::string kept = folder / ("whole/failures/00000" + std::to_string(i));
    EXPECT_EQ(fs::exists(kept + "/recording.mcap"), !success) << i;
  }

  for (const char* part : {"1/2", "2/2"}) {
    const Finished done = evaluate({"--episodes", "4", "--shard", part, "--out", folder / part});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(parse_json(done.out)["episodes"], 2);
  }
  const Finished merged = run(kaz(
      {"evaluate", "merge", folder / "1/2", folder / "2/2", "--out", folder / "merged", "--json"}));
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(without_speed(folder / "merged", 4), all);
  EXPECT_EQ(parse_json(merged.out)["success_rate"], result["success_rate"]);

  // Of a part alone the merge is kept, but it is no whole.
  const Finished half =
      run(kaz({"evaluate", "merge", folder / "1/2", "--out", folder / "half", "--json"}));
  EXPECT_EQ(half.exit_code, 3) << half.err;
  EXPECT_NE(half.err.find("no folder contains part 2/2 (episodes 1, 3)"), std::string::npos)
      << half.err;
  const json half_result = parse_json(read_file(folder / "half/result.json"));
  EXPECT_EQ(half_result["episodes"], 2);
  EXPECT_EQ(half_result["missing"], json::array({1, 3}));
  EXPECT_EQ(half_result["interrupted"], true);
  EXPECT_FALSE(parse_json(merged.out).contains("interrupted")) << merged.out;

  // More of the same go on, others do not mix in.
  const Finished more = evaluate({"--episodes", "5", "--out", folder / "whole"});
  ASSERT_EQ(more.exit_code, 0) << more.err;
  EXPECT_EQ(parse_json(more.out)["episodes"], 5);
  EXPECT_EQ(without_speed(folder / "whole", 4), all);
  // A report of fewer than are there would not be of the folder.
  const std::string report = read_file(folder / "whole/result.json");
  for (const auto& [fewer, others] :
       {std::pair{std::vector<std::string>{"--episodes", "2"}, "(numbers 2, 3, 4): run"},
        {{"--episodes", "5", "--shard", "1/2"}, "(numbers 1, 3): run"}}) {
    auto words = fewer;
    words.insert(words.end(), {"--out", folder / "whole"});
    const Finished refused = evaluate(words);
    EXPECT_EQ(refused.exit_code, 2) << refused.out << refused.err;
    EXPECT_NE(refused.err.find(others), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("choose another folder with --out"), std::string::npos)
        << refused.err;
  }
  EXPECT_EQ(read_file(folder / "whole/result.json"), report);
  const Finished other = evaluate({"--friction", "0.3", "0.4", "--out", folder / "whole"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("another evaluation"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("friction"), std::string::npos) << other.err;
  const Finished strange =
      run(kaz({"evaluate", "merge", folder / "1/2", folder.path(), "--out", folder / "strange"}));
  EXPECT_EQ(strange.exit_code, 2);
  EXPECT_NE(strange.err.find("campaign.json"), std::string::npos) << strange.err;
}

TEST(Evaluate, GoesOnAfterAnInterruption) {
  const TemporaryFolder folder;
  const std::vector<std::string> command =
      kaz({"evaluate", "search-ball", "--mcu", "native", "--eyes", "ideal", "--set", "seconds=2",
           "--episodes", "9", "--out", folder / "out"});
  Process first(command);
  ASSERT_TRUE(first.wait_for_output("succeeded", std::chrono::seconds(30)));
  first.signal(SIGINT);
  const Finished stopped = first.wait(std::chrono::seconds(10));
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_NE(stopped.err.find("continues"), std::string::npos) << stopped.err;
  const auto kept = without_speed(folder / "out", 9);
  ASSERT_GE(kept.size(), 1u);
  ASSERT_LT(kept.size(), 9u);
  const Finished merged =
      run(kaz({"evaluate", "merge", folder / "out", "--out", folder / "merged", "--json"}));
  EXPECT_EQ(merged.exit_code, 3) << merged.err;
  EXPECT_NE(merged.err.find("out' was interrupted by SIGINT"), std::string::npos) << merged.err;
  EXPECT_EQ(parse_json(merged.out)["interrupted"], true);
  EXPECT_EQ(parse_json(merged.out)["signal"], "SIGINT");
  const Finished second = run(command);
  EXPECT_NE(second.err.find("already done"), std::string::npos) << second.err;
  const auto all = without_speed(folder / "out", 9);
  ASSERT_EQ(all.size(), 9u);
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), all.begin()));
}

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> all;
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator("/proc", gone)) {
    const std::string number = entry.path().filename();
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    // "PID (NAME) STATE PARENT ...", where a name may have brackets too.
    const std::string line = read_file("/proc/" + number + "/stat");
    const auto end = line.rfind(") ");
    if (end != std::string::npos && std::atoi(line.c_str() + end + 3) == parent)
      all.push_back(std::stoi(number));
  }
  return all;
}

bool holds_robot_files(const std::string& folder) {
  std::error_code gone;
  for (fs::recursive_directory_iterator at(folder, gone), end; !gone && at != end;
       at.increment(gone))
    if (at->path().filename() == "kaz.urdf") return true;
  return false;
}

// Also where the processes of its episodes do not react and have to be killed, and where a second signal ends
// the program while it waits for them.
TEST(Evaluate, LeavesNoTemporaryFileHoweverItIsEnded) {
  struct Case {
    int first, second;
    bool stopped;
  };
  for (const auto& [first, second, stopped] :
       {Case{SIGINT, 0, false}, {SIGTERM, 0, true}, {SIGINT, SIGINT, true}}) {
    SCOPED_TRACE(std::to_string(first) + " " + std::to_string(second));
    const TemporaryFolder folder;
    const std::string temporary = folder / "tmp";
    fs::create_directory(temporary);
    std::vector<std::string> command =
        kaz({"evaluate", "search-ball", "--mcu", "native", "--eyes", "ideal", "--set", "seconds=8",
             "--episodes", "200", "--jobs", "2", "--out", folder / "out"});
    command.insert(command.begin(), {"/usr/bin/env", "TMPDIR=" + temporary});
    Process program(command);
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    bool begun = false;
    while (!begun && std::chrono::steady_clock::now() < until) {
      begun = holds_robot_files(temporary);
      if (begun && stopped) {
        for (const pid_t child : children_of(program.id())) ::kill(child, SIGSTOP);
        // One that has just ended has removed its files: those of the next one, then.
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        begun = holds_robot_files(temporary);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(begun) << program.wait(std::chrono::seconds(0)).err;
    program.signal(first);
    if (second != 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(430));  // later than kOneSignal
      program.signal(second);
    }
    const Finished end = program.wait(std::chrono::seconds(10));
    EXPECT_EQ(end.exit_code, 128 + first) << end.err;
    EXPECT_TRUE(fs::is_empty(temporary)) << end.err;
  }
}

// After the episode its world and robot are nowhere but beside the recording.
TEST(Evaluate, FailuresReplay) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", kept = out + "/failures/000000";
  const Finished made = run(kaz({"evaluate", "search-ball", "--mcu", "native", "--eyes", "ideal",
                                 "--set", "seconds=1", "--episodes", "1", "--out", out}));
  ASSERT_EQ(made.exit_code, 1) << made.out << made.err;
  ASSERT_TRUE(fs::exists(kept + "/recording.mcap")) << made.out;
  const std::string moved = folder / "moved";
  fs::rename(kept, moved);
  const Finished again = run(kaz({"replay", moved + "/recording.mcap"}));
  EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
  EXPECT_NE(again.out.find("identical"), std::string::npos) << again.out;
}

// Of a folder that somebody has worked in: what is not of Kaz stays, and what is not of the campaign is
// refused.
TEST(Evaluate, KeepsWhatOthersPutIntoItsFolder) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", kept = out + "/failures/000000";
  const std::string episode = out + "/episodes/000000.json";
  ASSERT_EQ(evaluate({"--episodes", "1", "--out", out}).exit_code, 0);
  fs::create_directories(kept);
  write_file(kept + "/notes.txt", "mine");
  fs::remove(episode);
  ASSERT_EQ(evaluate({"--episodes", "1", "--out", out}).exit_code, 0);
  EXPECT_EQ(read_file(kept + "/notes.txt"), "mine");

  const Finished onto = run(kaz({"evaluate", "merge", out, "--out", out + "/."}));
  EXPECT_EQ(onto.exit_code, 2) << onto.err;
  EXPECT_NE(onto.err.find("is one of the folders to merge"), std::string::npos) << onto.err;
  ASSERT_EQ(run(kaz({"evaluate", "merge", out, "--out", folder / "merged"})).exit_code, 0);
  EXPECT_EQ(read_file(folder / "merged/failures/000000/notes.txt"), "mine");

  // Episodes of an earlier merge that are none of these parts would be in its folder, and in no rate.
  json other = parse_json(read_file(episode));
  other["episode"] = 7;
  write_file(folder / "merged/episodes/000007.json", other.dump());
  const Finished mixed = run(kaz({"evaluate", "merge", out, "--out", folder / "merged"}));
  EXPECT_EQ(mixed.exit_code, 2) << mixed.err;
  EXPECT_NE(mixed.err.find("(7) that are not in any of the parts"), std::string::npos) << mixed.err;

  fs::rename(episode, out + "/episodes/000001.json");
  const Finished renamed = evaluate({"--episodes", "2", "--out", out});
  EXPECT_EQ(renamed.exit_code, 2) << renamed.err;
  EXPECT_NE(renamed.err.find("000001.json: contains episode 0"), std::string::npos) << renamed.err;
}

// Two more processes and a pty. Whether it finds the ball in time is the machine's affair here: that
// the behavior ran to an end of its own is not.
TEST(Evaluate, RunsInRealTimeToo) {
  const TemporaryFolder folder;
  const Finished finished =
      evaluate({"--realtime", "--episodes", "1", "--colors", "green", "--out", folder / "live"});
  EXPECT_LE(finished.exit_code, 1) << finished.err;
  const auto all = without_speed(folder / "live", 1);
  ASSERT_EQ(all.size(), 1u) << finished.err;
  const std::string cause = all[0]["cause"];
  EXPECT_TRUE(cause.empty() || cause == "not found") << all[0].dump(1);
  EXPECT_TRUE(all[0]["simulator"].contains("lost_s")) << all[0];
  // The truth of the other process: it has stayed where it stood.
  EXPECT_EQ(all[0]["truth"]["fell"], false) << all[0];
  EXPECT_NEAR(all[0]["truth"]["forward_m"].get<double>(), 0, 0.05);
  EXPECT_GT(all[0]["seconds"].get<double>(), 0);
  EXPECT_EQ(fs::exists(folder / "live/failures/000000/run.txt"), !cause.empty());
}

// A walk without a gyro begins 4.6 s sooner, and has as many pushes.
TEST(Evaluate, PushesAWalkFromItsFirstStep) {
  const TemporaryFolder folder;
  const auto walk = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> all{"evaluate",     "go-forward", "--mcu",      "native",     "--set",
                                 "distance=0.3", "--push",     "0.1",        "--episodes", "1",
                                 "--json",       "--out",      folder / name};
    all.insert(all.end(), more.begin(), more.end());
    return parse_json(run(kaz(all)).out);
  };
  const json with = walk("with", {}), without = walk("without", {"--no-imu"});
  EXPECT_EQ(with["pushes"]["least"], 4) << with["pushes"];
  EXPECT_EQ(without["pushes"]["least"], 4) << without["pushes"];
  EXPECT_FALSE(with["pushes"].contains("note"));
  const json late = walk("late", {"--push-from", "30"});
  EXPECT_EQ(late["pushes"]["episodes_without"], 1) << late["pushes"];
  EXPECT_EQ(late["pushes"]["note"],
            "1 of 1 episodes had no push; 1 ended within 30 s of the first step: give a smaller "
            "--push-from");
}

TEST(Evaluate, RefusesInOneSentence) {
  const TemporaryFolder folder;
  const auto refused = [&](std::vector<std::string> arguments, const std::string& word) {
    arguments.insert(arguments.begin(), "evaluate");
    const Finished finished = run(kaz(arguments));
    EXPECT_EQ(finished.exit_code, 2) << finished.err;
    EXPECT_NE(finished.err.find(word), std::string::npos) << finished.err;
  };
  refused({"--out", folder / "a"}, "BEHAVIOR is missing");
  refused({"search-ball"}, "--out");
  refused({"dance", "--out", folder / "a"}, "search-ball");
  refused({"search-ball", "--set", "second=3", "--out", folder / "a"}, "seconds");
  refused({"search-ball", "--shard", "3/2", "--out", folder / "a"}, "1/4");
  refused({"search-ball", "--shard", "3/3", "--episodes", "2", "--out", folder / "a"},
          "none of the 2");
  refused({"search-ball", "--episodes", "0", "--out", folder / "a"}, "--episodes");
  refused({"search-ball", "--supply", "11", "9", "--out", folder / "a"}, "smaller");
  refused({"search-ball", "--lamp", "2", "1", "--out", folder / "a"}, "smaller");
  refused({"search-ball", "--colors", "pink", "--out", folder / "a"}, "red");
  EXPECT_FALSE(fs::exists(folder / "a"));
}

}  // namespace
}  // namespace kaz::test
