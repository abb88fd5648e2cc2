// Planted files: whatever a file holds, `kaz` ends at once, with one sentence that names it.
// SPDX-License-Identifier: Apache-2.0
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <thread>

#include <gtest/gtest.h>
#include <zlib.h>

#include "shared/base/camera_stream.hpp"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using std::string;

constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();

// Little-endian.
template <class T>
string number(T value) {
  string bytes;
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
  return bytes;
}
string text(const string& value) {
  return number(static_cast<std::uint32_t>(value.size())) + value;
}
string record(char opcode, const string& content) {
  return opcode + number(std::uint64_t{content.size()}) + content;
}

// MCAP by the letter of the specification, not by our writer.
const string kMagic = "\x89MCAP0\r\n";
string mcap(const string& records) {
  return kMagic + record(1, text("") + text("planted")) + records;
}
string schema() {
  return record(3, number(std::uint16_t{1}) + text("S") + text("ros1msg") + text("uint8 a"));
}
string channel(std::uint16_t id, const string& topic) {
  return record(4, number(id) + number(std::uint16_t{1}) + text(topic) + text("ros1") + text(""));
}
string message(std::uint16_t channel, std::uint64_t time_ns, const string& data) {
  return record(
      5, number(channel) + number(std::uint32_t{0}) + number(time_ns) + number(time_ns) + data);
}
string chunk(const string& records, std::uint64_t first_ns = 0, std::uint64_t last_ns = 1'000'000) {
  return record(6, number(first_ns) + number(last_ns) + number(std::uint64_t{records.size()}) +
                       number(std::uint32_t{0}) + text("") + number(std::uint64_t{records.size()}) +
                       records);
}
string compressed_chunk(const string& compression, std::uint64_t size, const string& data) {
  return record(6, number(std::uint64_t{0}) + number(std::uint64_t{0}) + number(size) +
                       number(std::uint32_t{0}) + text(compression) +
                       number(std::uint64_t{data.size()}) + data);
}
string metadata(const std::vector<std::pair<string, string>>& entries) {
  string map;
  for (const auto& [key, value] : entries) map += text(key) + text(value);
  return record(0x0C, text("kaz") + text(map));
}
string data_end(const string& before = "") {
  const auto crc = before.empty() ? 0
                                  : crc32(0, reinterpret_cast<const Bytef*>(before.data()),
                                          static_cast<uInt>(before.size()));
  return record(0x0F, number(static_cast<std::uint32_t>(crc)));
}
// Content of a recording of `kaz run`, as far as `kaz replay` needs it.
string facts(const string& camera = "32 24 30 30 15.5 11.5 0.04 0.015") {
  return metadata({{"behavior", "stand"},
                   {"backend", "{}"},
                   {"settings", "{}"},
                   {"seed", "1"},
                   {"camera", camera}});
}
string run_of(const string& topic, const string& data) {
  return mcap(facts() + schema() + channel(1, topic) + chunk(message(1, 1'000'000, data)) +
              data_end());
}
string nested_chunks(int depth) {
  string inside;
  for (int i = 0; i < depth; ++i) inside = chunk(inside);
  return inside;
}
// One pair's picture as the recorder writes it.
string picture(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return number(std::uint32_t{1}) + number(seconds) + number(nanoseconds) + text("left_eye") +
         text("png") + text("no png");
}

struct Planted {
  const char* name;
  string content;
};

// One sentence on standard error that names the file, the exit status, and no crash.
void expect_sentence(const Finished& finished, int exit_code, const string& file) {
  EXPECT_EQ(finished.exit_code, exit_code) << finished.err;
  EXPECT_EQ(finished.err.rfind("kaz ", 0), 0u) << finished.err;
  EXPECT_EQ(std::ranges::count(finished.err, '\n'), 1) << finished.err;
  EXPECT_NE(finished.err.find(file), string::npos) << finished.err;
}

constexpr std::chrono::seconds kAtMost{5};

TEST(HostileFiles, RecordingsAreRefusedAtOnce) {
  string metadata_loop = kMagic + '\x0C' + number(std::uint64_t{16}) + text("") +
                         number(std::uint32_t{8}) + number(0xffffffffu) + "abcd";
  ASSERT_EQ(metadata_loop.size(), 33u);
  const string map_past_its_end = text("kaz") + number(std::uint32_t{100}) + "abcd";
  const string good = mcap(facts() + schema() + channel(1, "/board/pins"));
  const Planted planted[] = {
      {"33 bytes whose metadata looped", metadata_loop},
      {"the same behind a header",
       mcap(record(0x0C, text("") + number(std::uint32_t{8}) + number(0xffffffffu) + "abcd"))},
      {"metadata past its end", mcap(record(0x0C, map_past_its_end))},
      {"metadata entry twice", mcap(metadata({{"seed", "1"}, {"seed", "2"}}))},
      {"chunk in a chunk", mcap(chunk(chunk("")))},
      {"chunks in chunks, deep", mcap(nested_chunks(2000))},
      {"metadata in a chunk", mcap(chunk(facts()))},
      {"record of 2^64-1 bytes", mcap(string("\x06") + number(kHuge))},
      {"record of 2^40 bytes", mcap(string("\x05") + number(std::uint64_t{1} << 40))},
      {"record of type 0", mcap(record(0, ""))},
      {"chunk of no length", mcap(record(6, ""))},
      {"chunk of 2^64-1 bytes in a short record",
       mcap(record(6, number(kHuge) + number(kHuge) + number(kHuge) + number(std::uint32_t{0}) +
                          text("") + number(kHuge)))},
      {"chunk that ends within a record", mcap(schema() + chunk(channel(1, "/a").substr(0, 20)))},
      {"chunk of a record of 2^64-1 bytes", mcap(chunk("\x05" + number(kHuge)))},
      {"chunk that ends before it begins", mcap(chunk("", 2, 1))},
      {"LZ4 chunk without content", mcap(compressed_chunk("lz4", 9, ""))},
      {"LZ4 chunk of 2^64-1 bytes", mcap(compressed_chunk("lz4", kHuge, "abc"))},
      {"zstd chunk of 2^28 bytes", mcap(compressed_chunk("zstd", 1 << 28, "abc"))},
      {"chunk with an unknown compression", mcap(compressed_chunk("a\nb", 9, "abc"))},
      {"message of no channel", mcap(chunk(message(7, 5, "x")))},
      {"message shorter than its head", good + record(5, "abc") + data_end()},
      {"channel defined twice", mcap(schema() + channel(1, "/a") + channel(1, "/b"))},
      {"topic of 4 GB", mcap(record(4, number(std::uint32_t{1}) + number(0xffffffffu) + "abc"))},
      {"schema of number 0",
       mcap(record(3, number(std::uint16_t{0}) + text("") + text("") + text("")))},
      {"message after the end of time", good + chunk(message(1, kHuge, ""), 0, kHuge) + data_end()},
      {"message outside of its chunk", good + chunk(message(1, 5, ""), 6, 7) + data_end()},
      {"data end of no length", mcap(record(0x0F, ""))},
      {"wrong checksum of the data", good + data_end("something else")},
      {"footer in place of data", mcap(record(2, string(20, '\0')))},
      {"header twice", mcap(record(1, text("") + text("")))},
      {"empty", ""},
      {"magic alone", kMagic},
      {"cut off before anything was written", mcap("").substr(0, 12)},
      {"no recording of kaz", mcap(schema() + data_end())},
      {"bytes that do not fit their schema", run_of("/wire/to_board", "\1\2\3")},
      {"bytes that claim to be 4 billion", run_of("/wire/to_host", number(0xffffffffu))},
      {"byte before the start",
       mcap(facts() + schema() + channel(1, "/wire/to_board") +
            chunk(message(1, 0,
                          text("a") + number(std::uint32_t{1}) + number(std::uint16_t{0}) +
                              text(string(1, '\0')))) +
            data_end())},
      {"picture without its partner", run_of("/eyes/left", picture(0, 500'000))},
      {"picture that arrives before it is taken", run_of("/eyes/left", picture(4'000'000'000, 0))},
      {"picture of 4 billion nanoseconds", run_of("/eyes/left", picture(0, 4'000'000'000))},
  };
  const TemporaryFolder folder;
  const string file = folder / "planted.mcap";
  for (const Planted& one : planted) {
    SCOPED_TRACE(one.name);
    write_file(file, one.content);
    expect_sentence(run(kaz({"replay", file, "--host"}), kAtMost), 2, file);
  }
  // By its other door.
  for (const std::size_t k : {0, 4, 7}) {
    SCOPED_TRACE(planted[k].name);
    write_file(file, planted[k].content);
    expect_sentence(run(kaz({"vision", "run", "--in", file, "--out", folder / "found"}), kAtMost),
                    2, file);
  }
  expect_sentence(run(kaz({"replay", "/dev/zero"}), kAtMost), 2, "/dev/zero");
}

// A file of ROS 2 is not malformed.
TEST(HostileFiles, RecordingsOfOtherProgramsAreNamedAsSuch) {
  const TemporaryFolder folder;
  const string file = folder / "other.mcap", second = folder / "second.mcap";
  constexpr std::uint64_t kIn2024_ns = 1'700'000'000'000'000'000;
  for (const string& path : {file, second})
    write_file(path, mcap(schema() + channel(1, "/x") +
                          chunk(message(1, kIn2024_ns, "x"), kIn2024_ns, kIn2024_ns) + data_end()));
  for (const auto& arguments :
       {std::vector<string>{"replay", file}, std::vector<string>{"compare", file, second},
        std::vector<string>{"vision", "run", "--in", file, "--out", folder / "found"}}) {
    const Finished refused = run(kaz(arguments), kAtMost);
    expect_sentence(refused, 2, file);
    EXPECT_NE(refused.err.find("is an MCAP file of another program"), string::npos) << refused.err;
  }
}

// The camera of a recording: both pictures are there, its numbers are none.
TEST(HostileFiles, CamerasOfRecordingsAreRefused) {
  const TemporaryFolder folder;
  const string file = folder / "planted.mcap";
  for (const char* camera : {"", "nan nan nan nan 0 0 0 0", "32 24 1e308 1e308 15 11 0.04 0.015",
                             "-32 24 30 30 15 11 0.04 0.015", "32 24 30 30 15 11 inf 0.015",
                             "2147483647 2147483647 30 30 15 11 0.04 0.015",
                             "32 24 30 30 15 11 0.04 1e300", "32 24 30 30 15 11 0.04 -1"}) {
    SCOPED_TRACE(camera);
    const string left = message(1, 1'000'000, picture(0, 500'000));
    const string right = message(2, 1'000'000, picture(0, 500'000));
    write_file(file, mcap(facts(camera) + schema() + channel(1, "/eyes/left") +
                          channel(2, "/eyes/right") + chunk(left + right) + data_end()));
    expect_sentence(run(kaz({"replay", file, "--host"}), kAtMost), 2, file);
  }
}

TEST(HostileFiles, PicturesAreRefused) {
  const string png_head = string("\x89PNG\r\n\x1a\n", 8) + string("\0\0\0\rIHDR", 8);
  const Planted planted[] = {
      {"JPEG that ends in its head", "\xFF\xD8\xFF"},
      {"JPEG of 65535 x 65535 pixels",
       string("\xFF\xD8\xFF\xC0\0\x11\x08\xFF\xFF\xFF\xFF\3\1\x22\0\2\x11\1\3\x11\1\xFF\xD9", 23)},
      {"JPEG of no pixels",
       string("\xFF\xD8\xFF\xC0\0\x11\x08\0\0\0\0\3\1\x22\0\2\x11\1\3\x11\1\xFF\xD9", 23)},
      {"PNG of 2^31 pixels a side", png_head + string("\x7F\xFF\xFF\xFF\x7F\xFF\xFF\xFF", 8)},
      {"PPM of more pixels than it has", "P6 16000 4000 255\nabc"},
      {"PPM of 10^30 pixels", "P6 1000000000000000 1000000000000000 255\n"},
      {"PGM without a size", "P5"},
      {"no picture", "text"},
  };
  const TemporaryFolder folder;
  const string file = folder / "planted.jpg";
  for (const Planted& one : planted) {
    SCOPED_TRACE(one.name);
    write_file(file, one.content);
    expect_sentence(run(kaz({"vision", "learn-color", "--in", file, "--region", "0,0,4,4", "--out",
                             folder / "color.json"}),
                        kAtMost),
                    2, file);
  }
}

// It wrote 786 KB behind a buffer of 3 bytes. By libjpeg it is a picture of 512 x 512 pixels; what is
// missing for a calibration is the board.
TEST(HostileFiles, AJpegOfTwoSizesIsAPicture) {
  const TemporaryFolder folder;
  for (const char* name : {"left0.jpg", "right0.jpg"}) fs::copy_file(KAZ_DECOY_JPEG, folder / name);
  const Finished seen = run(
      kaz({"calibrate", "stereo", "--left", folder / "left0.jpg", "--right", folder / "right0.jpg",
           "--board", "9x6", "--square", "0.025", "--out", folder / "stereo.yml", "--json"}),
      kAtMost);
  expect_sentence(seen, 1, "left0.jpg");
  EXPECT_NE(seen.err.find("the whole board is not visible"), string::npos) << seen.err;
}

TEST(HostileFiles, CalibrationsAndColoursAreRefused) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "pictures");
  write_file(folder / "pictures/a.ppm", "P6 4 4 255\n" + string(48, 'a'));
  const string file = folder / "planted";
  for (const char* content : {"", "{", "%YAML:1.0\n---\nimage_width: .nan\n",
                              R"({"image_width": 1e99, "image_height": -1})", "[[[[[[[[[[[[[[[["}) {
    SCOPED_TRACE(content);
    write_file(file, content);
    expect_sentence(run(kaz({"vision", "run", "--in", folder / "pictures", "--calibration", file,
                             "--out", folder / "found"}),
                        kAtMost),
                    2, file);
    expect_sentence(run(kaz({"vision", "run", "--in", folder / "pictures", "--view", "60",
                             "--color", file, "--out", folder / "found"}),
                        kAtMost),
                    2, file);
  }
}

// Paths at which `kaz sim` would put something: what belongs to others stays.
// In the place of every file that a verb reads: a folder, a device without end, a pipe that nobody writes.
TEST(HostileFiles, WhatIsNoFileIsRefused) {
  const TemporaryFolder folder;
  const string out = folder / "out";
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const string& file : {string(folder / "."), string("/dev/zero"), string(folder / "pipe")}) {
    const std::vector<std::vector<string>> verbs = {
        {"run", "stand", "--mcu", "native", "--faults", file, "--out", out},
        {"run", "search-ball", "--mcu", "native", "--color", file, "--out", out},
        {"bench", "motor", "--mcu", "native", "--motor-file", file, "--out", out},
        {"run", "stand", "--mcu", "native", "--world", file, "--out", out},
        {"run", "stand", "--mcu", "native", "--sensors", file, "--out", out},
        {"fuzz", "--replay", file},
        {"bench", "motor", "--limits", file, "--out", out},
        {"bench", "fit", file, "--out", out},
        {"replay", file},
        {"mcu", "run", file},
        {"run", "stand", "--mcu", "native", "--robot-file", file, "--out", out},
        {"run", "stand", "--robot", "boards:" + file, "--out", out},
        {"evaluate", "stand", "--parallel-hosts", file, "--out", out},
    };
    for (const auto& verb : verbs) expect_sentence(run(kaz(verb), kAtMost), 2, file);
  }
}

// One of the readers of XML prints a second line of its own where it meets them.
TEST(HostileFiles, XmlThatIsEmptyOrHasADocumentTypeIsRefused) {
  const TemporaryFolder folder;
  const string file = folder / "planted.xml", out = folder / "out";
  for (const char* content : {"", "\n", "<!DOCTYPE motors><motors/>"}) {
    SCOPED_TRACE(content);
    write_file(file, content);
    const std::vector<std::vector<string>> verbs = {
        {"bench", "motor", "--mcu", "native", "--motor-file", file, "--out", out},
        {"run", "stand", "--mcu", "native", "--world", file, "--out", out}};
    for (const auto& verb : verbs) expect_sentence(run(kaz(verb), kAtMost), 2, file);
  }
}

// A failing case is written at the end: whether it can be is known before.
TEST(HostileFiles, ACaseIntoNoFolderIsRefusedBeforeTheFirstOne) {
  const TemporaryFolder folder;
  const string out = folder / "none/case";
  expect_sentence(run(kaz({"fuzz", "--cases", "1000000", "--out", out}), kAtMost), 2, out);
}

TEST(HostileFiles, WhatStandsInTheWayOfASimulatorStays) {
  const TemporaryFolder folder;
  const string path = folder / "board", mine = folder / "notes.txt";
  write_file(mine, "mine");
  fs::create_symlink(mine, path);
  expect_sentence(run(kaz({"sim", "--serial", path, "--mcu", "native"}), kAtMost), 2, path);
  EXPECT_EQ(fs::read_symlink(path), mine);
  fs::remove(path);
  expect_sentence(run(kaz({"sim", "--serial", path, "--mcu", "native", "--memory", mine}), kAtMost),
                  2, mine);
  write_file(folder / "board.ctl", "mine too");
  expect_sentence(run(kaz({"sim", "--serial", path, "--mcu", "native"}), kAtMost), 2, "board.ctl");
  fs::remove(folder / "board.ctl");
  expect_sentence(
      run(kaz({"sim", "--serial", path, "--cameras", mine, "--mcu", "native"}), kAtMost), 2, mine);
  EXPECT_EQ(read_file(mine), "mine");
}

// A camera is another process, which is why the status is that of the environment.
TEST(HostileFiles, CameraStreamsAreRefused) {
  CameraStreamHeader good{};
  std::memcpy(good.magic, kCameraStreamMagic, sizeof good.magic);
  good.version = kCameraStreamVersion;
  good.width = 32;
  good.height = 24;
  good.fx = good.fy = 30;
  good.baseline_m = 0.04;
  const std::function<void(CameraStreamHeader&)> spoilings[] = {
      [](auto& h) { h.fx = std::nan(""); },
      [](auto& h) { h.baseline_m = std::numeric_limits<double>::infinity(); },
      [](auto& h) { h.cy = -1e300; }, [](auto& h) { h.width = 0xffffffff; },
      [](auto& h) { h.latency_ns = std::numeric_limits<std::int64_t>::max(); }};
  for (std::size_t k = 0; k < std::size(spoilings); ++k) {
    SCOPED_TRACE(k);
    const TemporaryFolder folder;
    const string path = folder / "eyes";
    CameraStreamHeader header = good;
    spoilings[k](header);
    const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ASSERT_EQ(::listen(listener, 1), 0);
    std::thread publisher([&] {
      const int client = ::accept(listener, nullptr, nullptr);
      (void)::send(client, &header, sizeof header, MSG_NOSIGNAL);
      char until_it_goes = 0;
      (void)::recv(client, &until_it_goes, 1, 0);
      ::close(client);
    });
    const Finished seen =
        run(kaz({"vision", "run", "--in", path, "--out", folder / "found"}), kAtMost);
    ::shutdown(listener, SHUT_RDWR);
    publisher.join();
    ::close(listener);
    expect_sentence(seen, 3, path);
    EXPECT_NE(seen.err.find("impossible camera"), string::npos) << seen.err;
  }
}

}  // namespace
}  // namespace kaz::test
