// One thread with one poll() for all readers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/camera_server.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "shared/base/camera_stream.hpp"

namespace kaz::sim {
namespace {

constexpr std::size_t kMaxReaders = 8;

void append(std::vector<std::uint8_t>& to, const void* from, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(from);
  to.insert(to.end(), bytes, bytes + size);
}

}  // namespace

Result<std::unique_ptr<CameraServer>> CameraServer::open(const std::string& path,
                                                         const vision::CameraModel& model,
                                                         Time latency) {
  std::unique_ptr<CameraServer> server(new CameraServer);
  auto listener = KAZ_TRY(UnixListener::open(path));
  server->listener_ = std::move(listener);
  server->wake_ = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!server->wake_)
    return fail(Fault::environment, std::string("eventfd failed: ") + std::strerror(errno));

  CameraStreamHeader header{};
  std::copy_n(kCameraStreamMagic, sizeof header.magic, header.magic);
  header.version = kCameraStreamVersion;
  header.width = static_cast<std::uint32_t>(model.width);
  header.height = static_cast<std::uint32_t>(model.height);
  header.fx = model.fx;
  header.fy = model.fy;
  header.cx = model.cx;
  header.cy = model.cy;
  header.baseline_m = model.baseline_m;
  header.latency_ns = latency.count();
  std::vector<std::uint8_t> bytes;
  append(bytes, &header, sizeof header);
  server->header_ = std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));
  server->thread_ = std::thread([s = server.get()] { s->run(); });
  return server;
}

CameraServer::~CameraServer() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake();
  if (thread_.joinable()) thread_.join();
}

void CameraServer::wake() {
  const std::uint64_t one = 1;
  // Fails only for a counter near 2^64; the thread is awake then.
  [[maybe_unused]] const ssize_t written = ::write(wake_.get(), &one, sizeof one);
}

void CameraServer::publish(vision::StereoPair pair, Time exposure) {
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back({std::move(pair), exposure});
  }
  wake();
}

void CameraServer::run() {
  while (true) {
    const int wait_ms = listener_->max_wait_ms();  // before fd(), which may be -1 for so long
    std::vector<pollfd> polled{{wake_.get(), POLLIN, 0}, {listener_->fd(), POLLIN, 0}};
    for (const Reader& reader : readers_) {
      const auto wanted = static_cast<short>(POLLIN | (reader.sending ? POLLOUT : 0));
      polled.push_back({reader.socket.get(), wanted, 0});
    }
    if (::poll(polled.data(), polled.size(), wait_ms) < 0) continue;  // EINTR

    std::vector<short> events;
    for (std::size_t i = 2; i < polled.size(); ++i) events.push_back(polled[i].revents);
    serve_readers(events);
    if (polled[1].revents != 0) accept_readers();

    std::uint64_t count = 0;
    [[maybe_unused]] const ssize_t got = ::read(wake_.get(), &count, sizeof count);
    std::deque<Published> published;
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return;
      published.swap(queue_);
    }
    for (const Published& pair : published) send_pair(pair);
  }
}

void CameraServer::accept_readers() {
  while (Descriptor client = listener_->accept()) {
    if (readers_.size() >= kMaxReaders) continue;  // closes it
    readers_.push_back({std::move(client), header_, 0});
    if (!send_more(readers_.back())) readers_.pop_back();
  }
  reader_count_ = static_cast<int>(readers_.size());
}

void CameraServer::serve_readers(const std::vector<short>& events) {
  std::vector<Reader> staying;
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    bool stays = (events[i] & (POLLERR | POLLHUP)) == 0;
    if (stays && (events[i] & POLLIN) != 0) {
      // Readers send nothing: readable means closed, or bytes to be discarded.
      std::uint8_t ignored[256];
      stays = ::recv(readers_[i].socket.get(), ignored, sizeof ignored, 0) > 0;
    }
    if (stays && (events[i] & POLLOUT) != 0) stays = send_more(readers_[i]);
    if (stays) staying.push_back(std::move(readers_[i]));
  }
  readers_ = std::move(staying);
  reader_count_ = static_cast<int>(readers_.size());
}

void CameraServer::send_pair(const Published& published) {
  if (readers_.empty()) return;
  const auto images = published.pair.images.get();
  CameraStreamPair head{};
  std::copy_n(kCameraPairMagic, sizeof head.magic, head.magic);
  head.sequence = published.pair.info.sequence;
  head.exposure_ns = published.exposure.count();
  std::vector<std::uint8_t> bytes;
  bytes.reserve(sizeof head + images->left.rgb.size() + images->right.rgb.size());
  append(bytes, &head, sizeof head);
  append(bytes, images->left.rgb.data(), images->left.rgb.size());
  append(bytes, images->right.rgb.data(), images->right.rgb.size());
  const Bytes shared = std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));

  for (Reader& reader : readers_) {
    if (reader.sending) {
      ++missed_;
      continue;
    }
    reader.sending = shared;
    reader.sent = 0;
    send_more(reader);  // poll() detects a disconnected reader
  }
}

bool CameraServer::send_more(Reader& reader) {
  while (reader.sending) {
    const auto& bytes = *reader.sending;
    const ssize_t sent = ::send(reader.socket.get(), bytes.data() + reader.sent,
                                bytes.size() - reader.sent, MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    reader.sent += static_cast<std::size_t>(sent);
    if (reader.sent == bytes.size()) reader.sending.reset();
  }
  return true;
}

}  // namespace kaz::sim
