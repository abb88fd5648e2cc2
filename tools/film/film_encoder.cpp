// Starts ffmpeg, and writes to its standard input.
// SPDX-License-Identifier: Apache-2.0
#include "tools/film/film_encoder.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "shared/base/files.hpp"
#include "shared/base/one_line.hpp"

namespace kaz::tools {
namespace {

constexpr int kNotFound = 127;  // Child's, as a shell's
constexpr int kPoll_ms = 20;

const std::vector<FilmFormat>& formats() {
  static const std::vector<FilmFormat> all{
      // The index is in front, so that a browser begins at once. yuv420p: what every player has.
      {".mp4",
       30,
       {"-c:v", "libx264", "-preset", "medium", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags",
        "+faststart", "-f", "mp4"}},
      {".webm",
       30,
       {"-c:v", "libvpx-vp9", "-b:v", "0", "-crf", "32", "-deadline", "good", "-cpu-used", "4",
        "-row-mt", "1", "-pix_fmt", "yuv420p", "-f", "webm"}},
      {".webp",
       10,
       {"-c:v", "libwebp_anim", "-quality", "70", "-compression_level", "4", "-pix_fmt", "yuv420p",
        "-loop", "0", "-f", "webp"}},
      // A palette for each picture: one of the whole film would need all pictures in memory.
      {".gif",
       10,
       {"-filter_complex",
        "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=bayer",
        "-loop", "0", "-f", "gif"}}};
  return all;
}

std::string end_of_log(const std::string& log) {
  const auto text = read_whole_file(log, 1 << 20);
  if (!text) return "";
  const auto end = text->find_last_not_of("\r\n ");
  if (end == std::string::npos) return "";
  const auto before = text->find_last_of("\r\n", end);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return cut_text(one_line(std::string_view(*text).substr(begin, end + 1 - begin)), 300);
}

}  // namespace

Result<FilmFormat> film_format(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  std::string endings;
  for (const FilmFormat& format : formats()) {
    if (ending == format.ending) return format;
    endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
  }
  return fail(Fault::usage, "--video '" + cut_text(path) +
                                "': the extension selects the format; use one of " + endings);
}

Result<FilmEncoder> FilmEncoder::begin(const FilmFormat& format, const FilmSize& size,
                                       const std::string& path, const host::Interrupt& interrupt) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    return fail(Fault::environment,
                std::string("cannot open a pipe to ffmpeg: ") + std::strerror(errno));
  const Descriptor output(ends[0]);
  Descriptor input(ends[1]);
  ::fcntl(input.get(), F_SETFL, O_NONBLOCK);
  std::vector<std::string> arguments{"-hide_banner",
                                     "-nostdin",
                                     "-loglevel",
                                     "error",
                                     "-y",
                                     "-f",
                                     "rawvideo",
                                     "-pix_fmt",
                                     "rgb24",
                                     "-s",
                                     std::to_string(size.width) + "x" + std::to_string(size.height),
                                     "-r",
                                     std::to_string(size.fps),
                                     "-i",
                                     "-",
                                     "-fflags",
                                     "+bitexact",
                                     "-flags:v",
                                     "+bitexact"};
  arguments.insert(arguments.end(), format.options.begin(), format.options.end());
  arguments.push_back("file:" + path);  // also where the path looks like an option or a protocol
  std::string log = temporary_file("ffmpeg.log");
  auto child =
      KAZ_TRY(Child::begin("ffmpeg", arguments, log, Child::Lifetime::of_parent, output.get()));
  return FilmEncoder(std::move(child), std::move(input), std::move(log), interrupt);
}

Result<void> FilmEncoder::add(std::span<const std::uint8_t> rgb) {
  while (!rgb.empty()) {
    if (interrupt_->requested()) return tl::unexpected(host::Interrupt::error());
    std::array<pollfd, 2> ready{
        {{input_.get(), POLLOUT, 0}, {interrupt_->descriptor(), POLLIN, 0}}};
    ::poll(ready.data(), ready.size(), -1);
    const ssize_t n = ::write(input_.get(), rgb.data(), rgb.size());
    if (n >= 0) {
      rgb = rgb.subspan(static_cast<std::size_t>(n));
    } else if (errno != EINTR && errno != EAGAIN) {
      return tl::unexpected(failure());
    }
  }
  return {};
}

Result<void> FilmEncoder::finish() {
  input_ = Descriptor();
  while (!child_.ended()) {
    if (interrupt_->requested()) return tl::unexpected(host::Interrupt::error());
    pollfd ready{interrupt_->descriptor(), POLLIN, 0};
    ::poll(&ready, 1, kPoll_ms);
  }
  if (*child_.ended() == 0) return {};
  return tl::unexpected(failure());
}

Error FilmEncoder::failure() {
  const auto status = child_.wait(std::chrono::seconds(5));
  if (status == kNotFound)
    return {Fault::environment,
            "--video needs the program ffmpeg; install ffmpeg: sudo apt install ffmpeg"};
  const std::string line = end_of_log(log_);
  return {Fault::environment, "ffmpeg ended with status " + std::to_string(status.value_or(-1)) +
                                  (line.empty() ? "" : ": " + line)};
}

}  // namespace kaz::tools
