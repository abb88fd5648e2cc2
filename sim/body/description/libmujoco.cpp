// Loads libmujoco and calls its compiler.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/libmujoco.h"

#include <dlfcn.h>

#include <cstring>
#include <mutex>
#include <stdexcept>

#include <mujoco/mujoco.h>

namespace kaz::sim {
namespace {

constexpr const char* kMujocoLibrary = "libmujoco.so.2.2.2";
static_assert(mjVERSION_HEADER == 222);

struct Mujoco {
  decltype(&mj_loadXML) load = nullptr;
  decltype(&mj_deleteModel) delete_model = nullptr;
  decltype(&mj_defaultVFS) default_files = nullptr;
  decltype(&mj_makeEmptyFileVFS) make_file = nullptr;
  decltype(&mj_deleteVFS) delete_files = nullptr;
  decltype(&mju_user_error) on_error = nullptr;
  decltype(&mju_user_warning) on_warning = nullptr;
};

template <class T>
bool found_symbol(void* library, const char* name, T& to) {
  to = reinterpret_cast<T>(dlsym(library, name));
  return to != nullptr;
}

// The library stays loaded until the process ends.
const Mujoco* open_mujoco() {
  static const std::unique_ptr<const Mujoco> opened = []() -> std::unique_ptr<const Mujoco> {
    void* library = dlopen(kMujocoLibrary, RTLD_NOW | RTLD_LOCAL);
    auto out = std::make_unique<Mujoco>();
    const bool complete = library != nullptr && found_symbol(library, "mj_loadXML", out->load) &&
                          found_symbol(library, "mj_deleteModel", out->delete_model) &&
                          found_symbol(library, "mj_defaultVFS", out->default_files) &&
                          found_symbol(library, "mj_makeEmptyFileVFS", out->make_file) &&
                          found_symbol(library, "mj_deleteVFS", out->delete_files) &&
                          found_symbol(library, "mju_user_error", out->on_error) &&
                          found_symbol(library, "mju_user_warning", out->on_warning);
    return complete ? std::move(out) : nullptr;
  }();
  return opened.get();
}

// libmujoco's own handlers end the process and write MUJOCO_LOG.TXT.
[[noreturn]] void throw_error(const char* message) {
  throw std::runtime_error(message);
}
void drop_warning(const char*) {}

struct MujocoFiles {
  explicit MujocoFiles(const Mujoco& mujoco) : mujoco_(mujoco) { mujoco_.default_files(vfs.get()); }
  ~MujocoFiles() { mujoco_.delete_files(vfs.get()); }
  MujocoFiles(const MujocoFiles&) = delete;
  MujocoFiles& operator=(const MujocoFiles&) = delete;

  bool add(const std::string& name, const std::string& bytes) {
    if (mujoco_.make_file(vfs.get(), name.c_str(), static_cast<int>(bytes.size())) != 0)
      return false;
    std::memcpy(vfs->filedata[vfs->nfile - 1], bytes.data(), bytes.size());
    return true;
  }

  std::unique_ptr<mjVFS> vfs = std::make_unique<mjVFS>();

 private:
  const Mujoco& mujoco_;
};

}  // namespace

Result<std::shared_ptr<const mjModel_>> compile_mujoco(
    const std::map<std::string, std::string>& files, const std::string& main) {
  const Mujoco* mujoco = open_mujoco();
  if (mujoco == nullptr)
    return fail(Fault::environment, std::string(kMujocoLibrary) +
                                        " cannot be loaded, which reads MJCF; install the package "
                                        "libmujoco2.2.2");
  MujocoFiles kept(*mujoco);
  for (const auto& [name, bytes] : files) {
    if (!kept.add(name, bytes))
      return fail(Fault::usage, "the model has more than " + std::to_string(mjMAXVFS) + " files");
  }
  // The handlers and the compiler are global.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  *mujoco->on_error = throw_error;
  *mujoco->on_warning = drop_warning;
  char error[1000] = "";
  try {
    mjModel* model = mujoco->load(main.c_str(), kept.vfs.get(), error, sizeof error);
    if (model != nullptr)
      return std::shared_ptr<const mjModel>(
          model, [mujoco](const mjModel* m) { mujoco->delete_model(const_cast<mjModel*>(m)); });
  } catch (const std::exception& thrown) {
    return fail(Fault::usage, thrown.what());
  }
  return fail(Fault::usage, error);
}

}  // namespace kaz::sim
