// `kaz replay --video`: a film of a recording, by ffmpeg or by a program in its place.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
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
using std::chrono::seconds;

constexpr std::size_t kWidth = 640, kHeight = 480, kPicture = 3 * kWidth * kHeight;

class Film : public testing::Test {
 protected:
  // One run for all cases: the head finds the ball, some 3 s.
  static void SetUpTestSuite() {
    run_folder_ = new TemporaryFolder;
    const Finished made = run(kaz({"run", "search-ball", "--mcu", "native", "--record-pictures",
                                   "--out", *run_folder_ / "out"}),
                              seconds(100));
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  static void TearDownTestSuite() {
    delete run_folder_;
    run_folder_ = nullptr;
  }

  static std::string recording() { return *run_folder_ / "out/recording.mcap"; }

  // Arguments of a film of 11 pictures or so.
  std::vector<std::string> film(const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"replay", recording(), "--video",     folder_ / name,
                                       "--pace", "3",         "--video-fps", "10"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return kaz(arguments);
  }
  // The same with this shell script in place of ffmpeg.
  std::vector<std::string> with_script(const std::string& script, std::vector<std::string> film) {
    fs::create_directory(folder_ / "bin");
    write_file(folder_ / "bin/ffmpeg", "#!/bin/sh\n" + script);
    fs::permissions(folder_ / "bin/ffmpeg", fs::perms::owner_all);
    film.insert(film.begin(), {"/usr/bin/env", "PATH=" + folder_.path() + "/bin:/usr/bin:/bin"});
    return film;
  }
  // Neither a film nor a part of one is left.
  void expect_no_film(const std::string& name) {
    EXPECT_FALSE(fs::exists(folder_ / name));
    EXPECT_FALSE(fs::exists(folder_ / (name + ".part")));
  }

  TemporaryFolder folder_;

 private:
  inline static TemporaryFolder* run_folder_ = nullptr;
};

// Takes the pictures as they are; the file's name is the last argument.
constexpr const char* kKeepsPictures = R"(for name; do :; done; exec cat >"${name#file:}")";

TEST_F(Film, HasEachFormatThatItsEndingNames) {
  for (const auto& [name, codec] :
       {std::pair{"a.mp4", "h264"}, {"a.webm", "vp9"}, {"a.gif", "gif"}}) {
    const Finished made = run(film(name, {"--json"}), seconds(100));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const json result = parse_json(made.out);
    EXPECT_EQ(result["path"], folder_ / name);
    EXPECT_EQ(result["bytes"].get<std::uintmax_t>(), fs::file_size(folder_ / name));
    EXPECT_EQ(result["eye"], "recorded");
    EXPECT_GE(result["frames"].get<int>(), 8);
    EXPECT_NEAR(result["seconds"].get<double>(), result["frames"].get<int>() / 10.0, 1e-9);

    const Finished probed = run({"/usr/bin/env", "ffprobe", "-v", "error", "-count_frames",
                                 "-show_streams", "-show_format", "-of", "json", folder_ / name});
    ASSERT_EQ(probed.exit_code, 0) << probed.err;
    const json about = parse_json(probed.out), stream = about["streams"][0];
    EXPECT_EQ(stream["codec_name"], codec);
    EXPECT_EQ(stream["width"], kWidth);
    EXPECT_EQ(stream["height"], kHeight);
    EXPECT_EQ(stream["nb_read_frames"], std::to_string(result["frames"].get<int>()));
    EXPECT_NEAR(std::stod(about["format"]["duration"].get<std::string>()),
                result["seconds"].get<double>(), 0.051)
        << name;
    // Every player and browser has this codec.
    if (std::string(codec) == "h264") {
      EXPECT_EQ(stream["pix_fmt"], "yuv420p");
    }
  }
  EXPECT_EQ(run(film("a.gif"), seconds(100)).exit_code, 0) << "not replaced";
}

// ffprobe of Debian 12 reads no animated WebP: its frames are chunks of the file.
TEST_F(Film, IsAnAnimatedWebP) {
  const Finished made = run(film("a.webp", {"--json"}), seconds(100));
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string bytes = read_file(folder_ / "a.webp");
  ASSERT_EQ(bytes.substr(0, 4) + bytes.substr(8, 8), "RIFFWEBPVP8X");
  int frames = 0;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    frames += bytes.substr(at, 4) == "ANMF" ? 1 : 0;
    std::size_t size = 0;
    for (std::size_t i = 4; i-- > 0;)
      size = 256 * size + static_cast<unsigned char>(bytes[at + 4 + i]);
    at += 8 + size + size % 2;
  }
  EXPECT_EQ(frames, parse_json(made.out)["frames"].get<int>());
}

TEST_F(Film, HasTheSamePicturesEachTime) {
  for (const char* name : {"a.mp4", "b.mp4"}) {
    const Finished made = run(with_script(kKeepsPictures, film(name, {"--json"})), seconds(100));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    ASSERT_EQ(fs::file_size(folder_ / name),
              kPicture * parse_json(made.out)["frames"].get<std::size_t>());
  }
  const std::string pictures = read_file(folder_ / "a.mp4");
  EXPECT_TRUE(pictures == read_file(folder_ / "b.mp4"));
  EXPECT_FALSE(pictures.substr(0, kPicture) == pictures.substr(pictures.size() - kPicture))
      << "nothing has moved";
}

TEST_F(Film, NamesThePackageWhereFfmpegIsMissing) {
  auto arguments = film("a.mp4");
  arguments.insert(arguments.begin(), {"/usr/bin/env", "PATH=" + folder_.path()});
  const Finished done = run(arguments);
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_NE(done.err.find("install ffmpeg: sudo apt install ffmpeg"), std::string::npos)
      << done.err;
  expect_no_film("a.mp4");
}

TEST_F(Film, RefusesOtherEndings) {
  for (const char* name : {"a.avi", "a", "mp4", "a.mp4.txt"}) {
    const Finished done = run(film(name));
    EXPECT_EQ(done.exit_code, 2) << done.err;
    EXPECT_NE(done.err.find(".mp4, .webm, .webp, .gif"), std::string::npos) << done.err;
    expect_no_film(name);
  }
}

TEST_F(Film, ShowsTheLastLineOfAnFfmpegThatFails) {
  const Finished done = run(with_script(
      "echo first >&2; echo \"Unknown encoder 'libx264'\" >&2; exit 1\n", film("a.mp4")));
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_NE(done.err.find("ffmpeg ended with status 1: Unknown encoder 'libx264'"),
            std::string::npos)
      << done.err;
  expect_no_film("a.mp4");
}

TEST_F(Film, NamesTheFileThatDoesNotFit) {
  auto arguments =
      with_script(std::string(kKeepsPictures) + " 2>/dev/null || exit 1\n", film("a.mp4"));
  arguments.insert(arguments.begin(), {"/bin/sh", "-c", "ulimit -f 64; exec \"$@\"", "sh"});
  const Finished done = run(arguments, seconds(100));
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_NE(done.err.find("disk full while writing " + folder_ / "a.mp4"), std::string::npos)
      << done.err;
  expect_no_film("a.mp4");
}

TEST_F(Film, LeavesNothingWhenItIsInterrupted) {
  const std::string id = folder_ / "id";
  auto arguments =
      with_script("echo $$ >'" + id + ".new'; mv '" + id + ".new' '" + id + "'; " + kKeepsPictures,
                  film("a.mp4"));
  // A thousand times as many pictures.
  for (std::string& argument : arguments) {
    if (argument == "3") argument = "0.01";
  }
  Process filming(arguments);
  for (int i = 0; i < 600 && !fs::exists(folder_ / "a.mp4.part"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  for (int i = 0; i < 600 && !fs::exists(id); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(fs::exists(id));
  filming.signal(SIGINT);
  const Finished done = filming.wait(seconds(60));
  EXPECT_EQ(done.exit_code, 128 + SIGINT) << done.err;
  expect_no_film("a.mp4");
  EXPECT_NE(::kill(std::stoi(read_file(id)), 0), 0) << "ffmpeg goes on";
}

TEST_F(Film, RefusesWhatItIsNotFor) {
  const std::string no_poses = folder_ / "a.mcap";
  std::string bytes = read_file(recording());
  for (std::size_t at = 0; (at = bytes.find("/tf", at)) != std::string::npos; ++at)
    bytes.replace(at, 3, "/xf");
  write_file(no_poses, bytes);
  for (const auto& arguments :
       {std::vector<std::string>{"replay", recording(), "--pace", "2"},
        {"replay", recording(), "--video-fps", "10"},
        {"replay", recording(), "--video", folder_ / "a.mp4", "--view"},
        {"replay", recording(), "--video", folder_ / "a.mp4", "--seed", "2"},
        {"replay", recording(), "--video", folder_ / "a.mp4", "--video-fps", "0"},
        {"replay", no_poses, "--video", folder_ / "a.mp4"}}) {
    const Finished done = run(kaz(arguments));
    EXPECT_EQ(done.exit_code, 2) << done.err;
    expect_no_film("a.mp4");
  }
}

}  // namespace
}  // namespace kaz::test
