// A folder of results with its list and lock.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <mutex>

#include "tools/app/base/output_file.h"
#include "tools/app/base/output_list.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOtherFolder = "; choose another folder with --out";

// A temporary file's name without its ending: NAME.part, NAME.part4711-0.
std::string_view without_part(std::string_view name) {
  const auto at = name.rfind(".part");
  const bool part = at != std::string_view::npos && at > 0 &&
                    name.find_first_not_of("0123456789-", at + 5) == std::string_view::npos;
  return part ? name.substr(0, at) : name;
}

bool is_written_by(const OutputKind& kind, std::string_view name) {
  return std::ranges::any_of(kind.files, [&](const std::string& one) {
    return one.starts_with('*') ? name.ends_with(std::string_view(one).substr(1)) : name == one;
  });
}

// The verbs that write such a folder, which it does not distinguish.
std::string verbs_of(const std::string& kind) {
  return kind == "run" ? "kaz run or kaz demo" : "kaz " + kind;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    names.push_back(at->path().filename().string());
  std::ranges::sort(names);
  return names;
}

tl::unexpected<Error> cannot_write(const std::string& path, int error) {
  if (lacks_space(error)) return write_failure(path, "", error);
  return fail(Fault::usage, "cannot write results to '" + path + "' (" + std::strerror(error) +
                                "): it is not a writable folder" + kOtherFolder);
}

// Creates the folder and those above it; `created` gets those that were not there.
Result<void> make_folders(const std::string& path, std::vector<std::string>& created) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path at = fs::absolute(path).lexically_normal(); !fs::exists(at, error) && !at.empty();
       at = at.parent_path())
    missing.push_back(at);
  for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
    if (::mkdir(at->c_str(), 0777) == 0) {
      created.push_back(at->string());
    } else if (errno != EEXIST) {
      if (lacks_space(errno)) return write_failure(path, "", errno);
      return fail(Fault::usage, "cannot create the folder '" + path +
                                    "' for results: " + std::strerror(errno) + kOtherFolder);
    }
  }
  if (fs::is_directory(path, error)) return {};
  return fail(Fault::usage, "cannot create the folder '" + path +
                                "' for results: a file with this name exists" + kOtherFolder);
}

Result<void> append(int fd, const std::string& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return cannot_write(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return {};
}

Result<std::string> read_list(int fd, const std::string& path) {
  std::string text;
  std::vector<char> block(1 << 16);
  for (;;) {
    const ssize_t n = ::pread(fd, block.data(), block.size(), static_cast<off_t>(text.size()));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return cannot_write(path, errno);
    if (n == 0) return text;
    text.append(block.data(), static_cast<std::size_t>(n));
    if (text.size() > kMaxOutputListBytes) return text;  // parse_output_list() refuses it
  }
}

// That so many bytes fit shows that the disk is not full; of the results themselves nothing is known yet.
Result<void> write_test_file(const std::string& folder) {
  const std::string path = folder + "/" + std::string(kOutputListName) + ".part";
  // Without a name, so that a signal leaves nothing; not every file system has that.
  int fd = ::open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
  if (fd < 0) {
    ::unlink(path.c_str());
    fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  if (fd < 0) return cannot_write(folder, errno);
  auto written = append(fd, folder, std::string(4096, '\n'));
  if (::close(fd) != 0 && written) written = cannot_write(folder, errno);
  ::unlink(path.c_str());
  return written;
}

}  // namespace

struct OutputFolder::State {
  std::string path;
  OutputKind kind;
  OutputList list;
  int fd = -1;
  bool known = false;  // the list is one of ours
  std::vector<std::string> created;
  std::mutex mutex;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();

  std::string list_path() const { return path + "/" + std::string(kOutputListName); }
  bool is_result(const std::string& name) const {
    return list.names.contains(name) || list.names.contains(std::string(without_part(name)));
  }
  Result<bool> lock();
  Result<void> read();
  Result<void> refuse_others() const;
  Result<void> add_line(const std::string& line);
  Result<void> begin_list();
};

OutputFolder::State::~State() {
  if (fd < 0) return;
  bool any = false;
  for (const std::string& name : names_in(path)) any |= is_result(name);
  if (!any && known) ::unlink(list_path().c_str());
  ::close(fd);
  for (auto at = created.rbegin(); !any && at != created.rend(); ++at) ::rmdir(at->c_str());
}

// False: the list was removed by its owner at the same time; try again.
Result<bool> OutputFolder::State::lock() {
  const std::string name = list_path();
  fd =
      ::open(name.c_str(), O_RDWR | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  struct stat here = {}, there = {};
  if (fd < 0) return cannot_write(path, errno);
  if (::fstat(fd, &here) != 0 || !S_ISREG(here.st_mode)) return cannot_write(path, EINVAL);
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    const auto text = read_list(fd, path);
    const auto other = text ? parse_output_list(*text, name) : Result<OutputList>{};
    long process = other ? other->process : 0;
    if (process == 0) process = lock_holder(here);
    ::close(std::exchange(fd, -1));
    return fail(Fault::environment,
                "another run" +
                    (process > 0 ? " (process " + std::to_string(process) + ")" : std::string()) +
                    " is writing results to '" + path +
                    "': wait until that run ends, or choose another folder with --out");
  }
  // Other failures of flock(): a file system without locks, on which none can be had.
  if (::stat(name.c_str(), &there) == 0 && here.st_ino == there.st_ino) return true;
  ::close(std::exchange(fd, -1));
  return false;
}

Result<void> OutputFolder::State::read() {
  const auto text = KAZ_TRY(read_list(fd, path));
  list = KAZ_TRY(parse_output_list(text, list_path()));
  known = true;
  // A line without its end, of a run that was killed.
  const auto whole = text.rfind('\n');
  const auto length = whole == std::string::npos ? 0 : whole + 1;
  if (length < text.size() && ::ftruncate(fd, static_cast<off_t>(length)) != 0)
    return cannot_write(path, errno);
  return {};
}

Result<void> OutputFolder::State::refuse_others() const {
  const bool other_kind = !list.kind.empty() && list.kind != kind.name;
  for (const std::string& name : names_in(path)) {
    const std::string base(without_part(name));
    if (is_result(name)) {
      if (other_kind)
        return fail(Fault::usage, "'" + path + "' contains results of " + verbs_of(list.kind) +
                                      " (" + name + "), and " + verbs_of(kind.name) +
                                      " does not mix these results with its own: choose another "
                                      "folder with --out, or remove the results");
    } else if (is_written_by(kind, base)) {
      return fail(
          Fault::usage,
          "'" + path + "' contains '" + name + "', which is not in its list of results (" +
              std::string(kOutputListName) +
              ") and would be replaced: choose another folder with --out, or remove this file");
    }
  }
  return {};
}

Result<void> OutputFolder::State::add_line(const std::string& line) {
  return append(fd, path, line + "\n");
}

// Of this kind, written by this process, with all files that are known by name.
Result<void> OutputFolder::State::begin_list() {
  OutputList next{kind.name, ::getpid(), {}};
  for (const std::string& name : kind.files) {
    if (!name.starts_with('*')) next.names.insert(name);
  }
  if (list.kind == kind.name) {  // what is there stays in the list
    KAZ_TRY(add_line("process " + std::to_string(next.process)));
    for (const std::string& name : next.names) {
      if (list.names.insert(name).second) KAZ_TRY(add_line("file " + name));
    }
    list.process = next.process;
    return {};
  }
  if (::ftruncate(fd, 0) != 0) return cannot_write(path, errno);
  list = std::move(next);
  return append(fd, path, output_list_text(list));
}

Result<OutputFolder> OutputFolder::open(const std::string& path, const OutputKind& kind) {
  auto state = std::make_shared<State>();
  state->path = path;
  state->kind = kind;
  for (bool locked = false; !locked;) {
    KAZ_TRY(make_folders(path, state->created));
    locked = KAZ_TRY(state->lock());
  }
  KAZ_TRY(state->read());
  KAZ_TRY(state->refuse_others());
  for (const std::string& name : names_in(path)) {
    const std::string base(without_part(name));
    if (base != name && state->list.names.contains(base) && !state->list.names.contains(name))
      ::unlink((path + "/" + name).c_str());
  }
  KAZ_TRY(write_test_file(path));
  KAZ_TRY(state->begin_list());
  return OutputFolder(std::move(state));
}

Result<void> OutputFolder::clear() const {
  const std::lock_guard lock(state_->mutex);
  int removed = 0;
  for (const std::string& name : state_->list.names) {
    if (::unlink(path(name).c_str()) == 0)
      ++removed;
    else if (errno != ENOENT)
      return fail(Fault::usage, "cannot remove the earlier result '" + path(name) + "' (" +
                                    std::strerror(errno) + ")" + kOtherFolder);
  }
  if (removed > 0) std::fprintf(stderr, "earlier results in %s are replaced\n", folder().c_str());
  state_->list = {};
  return state_->begin_list();
}

Result<OutputFolder> OutputFolder::begin(const std::string& path, const OutputKind& kind) {
  auto folder = KAZ_TRY(open(path, kind));
  KAZ_TRY(folder.clear());
  return folder;
}

const std::string& OutputFolder::folder() const {
  return state_->path;
}

Result<std::string> OutputFolder::add(const std::string& name) const {
  const std::lock_guard lock(state_->mutex);
  auto& names = state_->list.names;
  if (names.contains(name)) return path(name);
  if (!is_output_name(name) || names.size() >= kMaxOutputNames)
    return fail(
        Fault::usage,
        "cannot write the result '" + name + "' to '" + folder() +
            "': its name is too long or has control characters, or there are too many results");
  if (fs::exists(fs::symlink_status(path(name))))
    return fail(Fault::usage, "'" + path(name) +
                                  "' is not in the list of results and would be replaced: choose "
                                  "another folder with --out, or remove this file");
  KAZ_TRY(state_->add_line("file " + name));
  names.insert(name);
  return path(name);
}

Result<void> OutputFolder::remove(const std::string& name) const {
  if (::unlink(path(name).c_str()) == 0 || errno == ENOENT) return {};
  return cannot_write(folder(), errno);
}

Result<void> OutputFolder::write(const std::string& name, std::string_view bytes) const {
  return write_whole_file(path(name), bytes);
}

Result<void> OutputFolder::write_json(const std::string& name,
                                      const nlohmann::ordered_json& value) const {
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return write(name, value.dump(2, ' ', false, replace) + "\n");
}

Error OutputFolder::explained(Error error) const {
  // A file of the folder may have listed it already.
  if (!is_disk_full(error) || error.message.find("; saved so far") != std::string::npos)
    return error;
  constexpr std::size_t kMaxNamed = 8;
  std::string saved;
  std::size_t count = 0;
  const std::lock_guard lock(state_->mutex);
  for (const std::string& name : names_in(folder())) {
    if (!state_->is_result(name)) continue;
    if (++count <= kMaxNamed) saved += (count > 1 ? ", " : "") + name;
  }
  if (count > kMaxNamed) saved += " and " + std::to_string(count - kMaxNamed) + " more";
  error.message += "; saved so far in '" + folder() + "': " + (count == 0 ? "nothing" : saved);
  return error;
}

}  // namespace kaz::tools
