// Temporary files of an evaluation's episodes: removed however it ends, also by a second Ctrl-C.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/work_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "shared/base/files.hpp"
#include "tools/base/interrupt_signals.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxDepth = 8;

// What the handler of a signal needs: it may not allocate.
char g_path[PATH_MAX] = "";
std::atomic<pid_t> g_owner{0};
std::array<std::atomic<pid_t>, WorkFolder::kMaxUsers> g_users{};
static_assert(std::atomic<pid_t>::is_always_lock_free);

int open_folder(int at, const char* path) {
  return ::openat(at, path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

void remove_content(int folder, int depth);

bool remove_entry(int folder, const char* name, int depth) {
  if (::unlinkat(folder, name, 0) == 0) return true;
  if (depth == 0) return false;
  const int inner = open_folder(folder, name);
  if (inner < 0) return false;
  remove_content(inner, depth - 1);
  ::close(inner);
  return ::unlinkat(folder, name, AT_REMOVEDIR) == 0;
}

// One pass over the entries: true if any was removed.
bool remove_content_once(int folder, int depth) {
  alignas(dirent64) char entries[4096];
  bool removed = false;
  ::lseek(folder, 0, SEEK_SET);
  for (long size; (size = ::syscall(SYS_getdents64, folder, entries, sizeof entries)) > 0;) {
    for (long at = 0; at < size;) {
      const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
      at += entry->d_reclen;
      if (std::strcmp(entry->d_name, ".") == 0 || std::strcmp(entry->d_name, "..") == 0) continue;
      if (remove_entry(folder, entry->d_name, depth)) removed = true;
    }
  }
  return removed;
}

// In system calls alone, as std::filesystem and opendir() allocate. Links are removed, not followed. Reading
// while removing may skip entries: until a pass removes nothing.
void remove_content(int folder, int depth) {
  while (remove_content_once(folder, depth)) {
  }
}

void pause_10_ms() {
  const timespec pause{0, 10'000'000};
  ::nanosleep(&pause, nullptr);
}

bool any_user_runs() {
  for (const auto& user : g_users)
    if (user > 0 && ::waitpid(user, nullptr, WNOHANG) == 0) return true;
  return false;
}

// In a signal handler. First the processes, as they would write on. The number of one whose end was waited
// for may be another's by now, and is no child of this process then.
void remove_at_once() noexcept {
  if (::getpid() != g_owner) return;
  for (const auto& user : g_users)
    if (user > 0 && ::waitpid(user, nullptr, WNOHANG) == 0) ::kill(user, SIGKILL);
  for (int i = 0; i < 50 && any_user_runs(); ++i) pause_10_ms();
  // Programs that those processes began are killed with them, and may still be at their last system call.
  for (int i = 0; i < 20 && !remove_entry(AT_FDCWD, g_path, kMaxDepth) && errno == ENOTEMPTY; ++i)
    pause_10_ms();
}

// True where no evaluation holds it, nor is about to: it is locked shortly after it was made.
bool is_stale(int folder) {
  constexpr std::time_t kMinAge_s = 60;
  struct stat info {};
  return ::fstat(folder, &info) == 0 && info.st_uid == ::geteuid() &&
         ::time(nullptr) - info.st_mtime > kMinAge_s && ::flock(folder, LOCK_EX | LOCK_NB) == 0;
}

void remove_stale(const fs::path& parent) {
  constexpr std::size_t kRandom = 6;  // letters at the end of a temporary name
  std::error_code wrong;
  for (fs::directory_iterator at(parent, wrong), end; !wrong && at != end; at.increment(wrong)) {
    const std::string name = at->path().filename();
    if (!name.starts_with(WorkFolder::kPrefix) ||
        name.size() != std::string_view(WorkFolder::kPrefix).size() + kRandom)
      continue;
    const int folder = open_folder(AT_FDCWD, at->path().c_str());
    if (folder < 0) continue;
    if (is_stale(folder)) remove_entry(AT_FDCWD, at->path().c_str(), kMaxDepth);
    ::close(folder);
  }
}

}  // namespace

Result<WorkFolder> WorkFolder::make() {
  std::string path = KAZ_TRY(make_temporary_folder(kPrefix));
  const int folder = open_folder(AT_FDCWD, path.c_str());
  ::flock(folder, LOCK_EX | LOCK_NB);
  remove_stale(fs::path(path).parent_path());
  for (auto& user : g_users) user = 0;
  // Absolute: nothing may be removed elsewhere. Of a longer path no file could be opened anyway.
  std::error_code none;
  const std::string absolute = fs::absolute(path, none).string();
  if (absolute.size() < sizeof g_path) {
    g_path[absolute.copy(g_path, sizeof g_path - 1)] = '\0';
    g_owner = ::getpid();
    does_at_last(remove_at_once);
  }
  return WorkFolder(std::move(path), folder);
}

WorkFolder::~WorkFolder() {
  if (path_.empty()) return;
  // As in remove_at_once(): programs of a killed process may be at their last system call.
  for (int i = 0; i < 20 && !remove_entry(AT_FDCWD, path_.c_str(), kMaxDepth) && errno == ENOTEMPTY;
       ++i)
    pause_10_ms();
  does_at_last(nullptr);
  g_owner = 0;
  if (folder_ >= 0) ::close(folder_);
}

void WorkFolder::add_user(pid_t child) {
  for (auto& user : g_users) {
    if (user != 0) continue;
    user = child;
    return;
  }
}

void WorkFolder::remove_user(pid_t child) {
  for (auto& user : g_users)
    if (user == child) user = 0;
}

}  // namespace kaz::tools
