// The campaign's five runs in real time: `kaz sim` and `kaz flash` in processes of their own, a pty
// between them, and a fault at a seeded point of the writing.
// SPDX-License-Identifier: Apache-2.0
//
// After each the board can be flashed again with the same options and identifies itself, no partial
// image runs, and every reported success is one. tests/flash has the other 500, in simulated time.
#include <csignal>
#include <filesystem>
#include <memory>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/flash/diagnostic.h"
#include "host/flash/flash_image.h"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/control_socket_testing.h"
#include "tests/system/command_line/process_testing.h"
#include "tests/system/flash/variant_testing.h"

namespace kaz::test {
namespace {

using host::FlashImage;
using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

class FlashPty : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto image =
        std::filesystem::path(kaz({}).front()).parent_path().parent_path() / "firmware/kaz.mot";
    auto loaded = FlashImage::load(image);
    ASSERT_TRUE(loaded) << loaded.error().message;
    old_ = *loaded;
    next_ = flash_test::variant(old_, flash_test::kBuildId, 0x5a);
    save(old_, "old.bin", 0xe000);
    save(next_, "next.bin", 0xe000);
    sim_ = std::make_unique<Process>(
        kaz({"sim", "--world", "empty", "--serial", folder_ / "board", "--erased"}));
    ASSERT_TRUE(sim_->wait_for_output("ready", seconds(30))) << sim_->wait(seconds(0)).err;
  }

  void save(const FlashImage& image, const std::string& name, std::uint32_t end) const {
    const auto bytes = image.bytes({0, end});
    write_file(folder_ / name, {bytes.begin(), bytes.end()});
  }
  json control(const std::string& request) const {
    return parse_json(query_control(folder_ / "board.ctl", request));
  }
  std::vector<std::string> flash(const std::string& verb, const std::string& image,
                                 std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"flash", verb, folder_ / image, "--format",       "raw",
                                 "--at",  "0",  "--port",        folder_ / "board"};
    all.insert(all.end(), more.begin(), more.end());
    return kaz(all);
  }
  // Writes the image with `options`; the firmware answers afterwards.
  void write_whole(const std::string& name, const FlashImage& image,
                   std::vector<std::string> options) const {
    options.emplace_back("--json");
    const Finished done = run(flash("write", name, options), seconds(90));
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const json answer = parse_json(done.out);
    ASSERT_TRUE(answer.is_object()) << done.out;
    EXPECT_TRUE(answer["ok"]);
    EXPECT_TRUE(answer["verified"]);
    EXPECT_EQ(answer["runs"]["crc"], host::hex_word(image.identity()->crc));
  }
  // Flashes, and calls `fault` at a point that the seed says: while the program is downloaded or at some
  // share of the writing.
  Finished write_with(std::uint64_t seed, std::vector<std::string> options, bool may_be_boot,
                      const std::function<void(Process&)>& fault) const {
    std::mt19937_64 random(seed);
    Process program(flash("write", "next.bin", options));
    const std::uint64_t point = random() % (may_be_boot ? 12 : 9);
    const milliseconds later(random() % (point < 9 ? 200 : 1500));
    const std::string phase = point < 9 ? std::to_string(10 * point) + " %  write" : "0 %  boot";
    EXPECT_TRUE(program.wait_for_output(phase, seconds(60))) << program.wait(seconds(0)).err;
    std::this_thread::sleep_for(later);
    fault(program);
    return program.wait(seconds(60));
  }
  void expect_judgements(const Finished& first, const std::vector<std::string>& options) const {
    if (first.exit_code == 0) {
      EXPECT_EQ(run(flash("verify", "next.bin")).exit_code, 0) << "a success that is none";
    }
    EXPECT_TRUE(control("mode run")["ok"]);
    EXPECT_TRUE(control("reset")["ok"]);
    std::this_thread::sleep_for(milliseconds(500));
    const Finished status =
        run(kaz({"status", "--port", folder_ / "board", "--json"}), seconds(20));
    if (status.exit_code == 0) {
      const json said = parse_json(status.out);
      const auto crc = said["crc"];
      EXPECT_TRUE(crc == host::hex_word(old_.identity()->crc) ||
                  crc == host::hex_word(next_.identity()->crc))
          << status.out;
    }
    write_whole("next.bin", next_, options);
  }
  std::vector<std::string> boot() const { return {"--reset", "ctl:" + (folder_ / "board.ctl")}; }

  TemporaryFolder folder_;
  FlashImage old_, next_;
  std::unique_ptr<Process> sim_;
};

TEST_F(FlashPty, PowerCut) {
  const Finished first = write_with(1, boot(), true, [this](Process&) {
    EXPECT_TRUE(control("power off")["ok"]);
    std::this_thread::sleep_for(milliseconds(300));
    EXPECT_TRUE(control("power on")["ok"]);
  });
  // Cut while the writer is downloaded it tries again by itself.
  if (first.exit_code != 0) {
    EXPECT_EQ(first.exit_code, 3) << first.err;
    EXPECT_NE(first.err.find("same command again"), std::string::npos) << first.err;
  }
  expect_judgements(first, boot());
}

TEST_F(FlashPty, KilledWhileTheLoaderWrites) {
  write_whole("old.bin", old_, boot());
  const Finished first =
      write_with(2, {}, false, [](Process& program) { program.signal(SIGKILL); });
  EXPECT_EQ(first.exit_code, 128 + SIGKILL);
  expect_judgements(first, {});
}

TEST_F(FlashPty, Unplugged) {
  const Finished first =
      write_with(3, boot(), true, [this](Process&) { EXPECT_TRUE(control("plug out")["ok"]); });
  EXPECT_EQ(first.exit_code, 3) << first.err;
  for (const char* part : {"unplugged", "same command again"})
    EXPECT_NE(first.err.find(part), std::string::npos) << first.err;
  EXPECT_EQ(run(flash("write", "next.bin", boot())).exit_code, 3) << "there is no port";
  EXPECT_TRUE(control("plug in")["ok"]);
  expect_judgements(first, boot());
}

TEST_F(FlashPty, Noise) {
  write_whole("old.bin", old_, boot());
  const Finished first = write_with(4, {}, false, [this](Process&) {
    EXPECT_TRUE(control("fault for 2 s link_flip 0.002")["ok"]);
  });
  EXPECT_TRUE(control("fault none")["ok"]);
  expect_judgements(first, {});
}

TEST_F(FlashPty, TruncatedImage) {
  write_whole("old.bin", old_, boot());
  std::mt19937_64 random(5);
  for (int k = 0; k < 3; ++k) {
    const auto end = static_cast<std::uint32_t>(0x1200 + random() % (0xe000 - 0x1200));
    save(next_, "cut.bin", end);
    const Finished cut = run(flash("write", "cut.bin", boot()), seconds(20));
    EXPECT_EQ(cut.exit_code, 2) << end << ": " << cut.err;
    EXPECT_NE(cut.err.find("damaged"), std::string::npos) << cut.err;
  }
  EXPECT_EQ(run(flash("verify", "old.bin")).exit_code, 0)
      << "a refused image has changed the flash";
  expect_judgements({.exit_code = 2, .cpu_s = 0, .out = "", .err = ""}, boot());
}

}  // namespace
}  // namespace kaz::test
