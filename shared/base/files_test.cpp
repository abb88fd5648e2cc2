// Files that appear whole, and folders for temporary ones: links that others have put there.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/files.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>

#include <fstream>
#include <sstream>

namespace {
std::vector<ino_t> g_synchronized;  // in order
}  // namespace

// In place of the C library's.
extern "C" int fsync(int fd) {
  struct stat about {};
  if (fstat(fd, &about) == 0) g_synchronized.push_back(about.st_ino);
  return static_cast<int>(syscall(SYS_fsync, fd));
}

namespace kaz {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  Files() : folder_(make_temporary_folder("kaz-files-test-").value()) {}
  ~Files() override { fs::remove_all(folder_); }
  std::string operator/(const std::string& name) const { return folder_ + "/" + name; }
  static std::string content(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  std::string folder_;
};

TEST_F(Files, AppearAndReplaceWhatIsThere) {
  const std::string path = *this / "a";
  ASSERT_TRUE(write_whole_file(path, "first"));
  EXPECT_EQ(content(path), "first");
  ASSERT_TRUE(write_whole_file(path, "second"));
  EXPECT_EQ(content(path), "second");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing is left beside it";
}

// Under the name of the partial file, which can be guessed, stands somebody's link to a file of ours.
TEST_F(Files, DoNotFollowAPlantedLink) {
  const std::string path = *this / "a", victim = *this / "victim";
  ASSERT_TRUE(write_whole_file(victim, "precious"));
  fs::create_symlink(victim, path + ".part" + std::to_string(getpid()) + "-0");
  fs::create_symlink(*this / "not-there", path + ".part" + std::to_string(getpid()) + "-1");
  ASSERT_TRUE(write_whole_file(path, "result"));
  EXPECT_EQ(content(path), "result");
  EXPECT_FALSE(fs::is_symlink(path));
  EXPECT_EQ(content(victim), "precious");
  EXPECT_FALSE(fs::exists(*this / "not-there"));
}

TEST_F(Files, KeepTheUsersOwnLink) {
  const std::string real = *this / "real", link = *this / "link";
  ASSERT_TRUE(write_whole_file(real, "old"));
  fs::create_symlink("real", link);
  ASSERT_TRUE(write_whole_file(link, "new"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(content(real), "new");
}

TEST_F(Files, DevicesTakeTheBytes) {
  ASSERT_TRUE(write_whole_file("/dev/null", "bytes"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const auto full = write_whole_file("/dev/full", "bytes");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().fault, Fault::environment);
  EXPECT_NE(full.error().message.find("/dev/full"), std::string::npos);
  EXPECT_TRUE(full.error().disk_full) << full.error().message;
}

TEST_F(Files, SayWhereTheyCannotBe) {
  const auto written = write_whole_file(*this / "no/folder", "bytes");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("no/folder: cannot write here"), std::string::npos)
      << written.error().message;
  EXPECT_FALSE(write_whole_file(folder_, "bytes"));
}

// A rename alone may be undone by a power cut: the folder has to be on the disk, too.
TEST_F(Files, PutTheirFolderOnTheDisk) {
  g_synchronized.clear();
  ASSERT_TRUE(write_whole_file(*this / "a", "bytes"));
  struct stat folder {};
  ASSERT_EQ(stat(folder_.c_str(), &folder), 0);
  ASSERT_EQ(g_synchronized.size(), 2u) << "the file, then its folder";
  EXPECT_NE(g_synchronized[0], folder.st_ino);
  EXPECT_EQ(g_synchronized[1], folder.st_ino);
}

TEST_F(Files, AreReadWhole) {
  const std::string bytes(200'000, '\0');
  ASSERT_TRUE(write_whole_file(*this / "zeros", bytes));
  const auto read = read_whole_file(*this / "zeros", bytes.size());
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, bytes);
}

TEST_F(Files, ThatAreNoneOrTooLargeAreRefused) {
  ASSERT_TRUE(write_whole_file(*this / "large", std::string(2049, 'x')));
  const std::pair<std::string, std::string> refused[] = {
      {*this / "large", "has more than 2 KB"},
      {folder_, "is a folder, not a file"},
      {*this / "none", "cannot be read (No such file or directory)"},
      {"/dev/zero", "is a device, not a file"},
      {*this / "pipe", "is a pipe, not a file"},
      {*this / "socket", "is a socket, not a file"},
      {*this / "link", "is a pipe, not a file"},
  };
  // Nobody writes into the pipe: opening it would block for ever.
  ASSERT_EQ(mkfifo((*this / "pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", *this / "link");
  const Descriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  sockaddr_un address{AF_UNIX, {}};
  (*this / "socket").copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  for (const auto& [path, reason] : refused) {
    const auto read = read_whole_file(path, 2048, "give a file of numbers");
    ASSERT_FALSE(read) << path;
    EXPECT_EQ(read.error().fault, Fault::usage);
    EXPECT_EQ(read.error().message.rfind(path + ": " + reason, 0), 0u) << read.error().message;
    EXPECT_NE(read.error().message.find("; give a file of numbers"), std::string::npos);
  }
}

TEST_F(Files, TemporaryFoldersAreNewAndOnesOwn) {
  const auto one = make_temporary_folder("kaz-files-test-");
  ASSERT_TRUE(one);
  EXPECT_NE(*one, folder_);
  struct stat status {};
  ASSERT_EQ(stat(one->c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
  fs::remove(*one);
}

}  // namespace
}  // namespace kaz
