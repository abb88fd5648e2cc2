// Temporary files of an evaluation: removed with it, and where a killed one left them.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/work_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <gtest/gtest.h>

#include "shared/base/files.hpp"
#include "tools/base/interrupt_signals.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

class Work : public testing::Test {
 protected:
  Work() : folder_(make_temporary_folder("kaz-work-test-").value()) {
    if (const char* const before = std::getenv("TMPDIR")) before_ = before;
    ::setenv("TMPDIR", folder_.c_str(), 1);
  }
  ~Work() override {
    if (before_) {
      ::setenv("TMPDIR", before_->c_str(), 1);
    } else {
      ::unsetenv("TMPDIR");
    }
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  // A folder as an evaluation leaves it if it is killed, `age` ago.
  std::string left_behind(const std::string& name, std::chrono::seconds age) const {
    const std::string path = folder_ + "/" + name;
    fs::create_directories(path + "/kaz-robot-abcdef");
    EXPECT_TRUE(write_whole_file(path + "/kaz-robot-abcdef/kaz.urdf", "<robot/>"));
    fs::last_write_time(path, fs::file_time_type::clock::now() - age);
    return path;
  }

  std::string folder_;
  std::optional<std::string> before_;
};

TEST_F(Work, FolderGoesWithAllThatIsInIt) {
  const std::string elsewhere = folder_ + "/elsewhere";
  fs::create_directory(elsewhere);
  ASSERT_TRUE(write_whole_file(elsewhere + "/mine", "mine"));
  std::string path;
  {
    const auto work = WorkFolder::make();
    ASSERT_TRUE(work) << work.error().message;
    path = work->path();
    EXPECT_TRUE(path.starts_with(folder_ + "/kaz-evaluate-")) << path;
    fs::create_directories(path + "/one/two/three");
    for (int i = 0; i < 300; ++i)  // more than one reading of the folder returns
      ASSERT_TRUE(write_whole_file(path + "/one/a_long_name_" + std::to_string(i), "x"));
    fs::create_directory_symlink(elsewhere, path + "/one/link");
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(fs::exists(elsewhere + "/mine")) << "a link is not followed";
}

TEST_F(Work, FoldersOfKilledEvaluationsAreRemovedAndNoOthers) {
  using std::chrono::hours;
  const std::string stale = left_behind("kaz-evaluate-staleX", hours(2));
  const std::string running = left_behind("kaz-evaluate-locked", hours(2));
  const std::string young = left_behind("kaz-evaluate-youngX", std::chrono::seconds(5));
  const std::string users = left_behind("kaz-evaluate-results", hours(2));
  const int lock = ::open(running.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
  {
    const auto work = WorkFolder::make();
    ASSERT_TRUE(work) << work.error().message;
    // Its own is locked, whatever its age.
    const int own = ::open(work->path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    EXPECT_NE(::flock(own, LOCK_EX | LOCK_NB), 0);
    ::close(own);
  }
  ::close(lock);
  EXPECT_FALSE(fs::exists(stale));
  EXPECT_TRUE(fs::exists(running + "/kaz-robot-abcdef/kaz.urdf"));
  EXPECT_TRUE(fs::exists(young + "/kaz-robot-abcdef/kaz.urdf"));
  EXPECT_TRUE(fs::exists(users + "/kaz-robot-abcdef/kaz.urdf")) << "not a temporary name";
}

// A signal where nothing takes an interrupt ends the program at once: the child's child, which ignores other
// signals, and the files go too.
TEST_F(Work, FolderGoesWithAProgramThatEndsAtOnce) {
  int user_of_folder[2];
  ASSERT_EQ(::pipe(user_of_folder), 0);
  const pid_t program = ::fork();
  if (program == 0) {
    InterruptSignals::forget_earlier();
    catch_signals();
    auto work = WorkFolder::make();
    if (!work || !write_whole_file(work->path() + "/file", "x")) ::_exit(1);
    const pid_t user = ::fork();
    if (user == 0) {
      std::signal(SIGTERM, SIG_IGN);
      while (true) ::pause();
    }
    work->add_user(user);
    if (::write(user_of_folder[1], &user, sizeof user) != sizeof user) ::_exit(1);
    while (true) ::pause();
  }
  ::close(user_of_folder[1]);
  pid_t user = -1;
  ASSERT_EQ(::read(user_of_folder[0], &user, sizeof user), static_cast<ssize_t>(sizeof user));
  ASSERT_FALSE(fs::is_empty(folder_));
  ::kill(program, SIGTERM);
  int status = 0;
  ASSERT_EQ(::waitpid(program, &status, 0), program);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_NE(::kill(user, 0), 0) << "its process is gone";
  ::close(user_of_folder[0]);
}

}  // namespace
}  // namespace kaz::tools
