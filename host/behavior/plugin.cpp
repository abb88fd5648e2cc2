// dlopen, with an error message for each cause of failure.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/plugin.h"

#include <cxxabi.h>
#include <dlfcn.h>
#include <elf.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <typeinfo>

namespace kaz::behavior {

namespace {

namespace fs = std::filesystem;

constexpr const char* kHowto = "docs/howto/own-behavior.md";

std::string demangled(const std::string& symbol) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status), std::free);
  return status == 0 ? text.get() : symbol;
}

// `reason` is that of dlerror(), which begins with the path, or not.
tl::unexpected<Error> not_loaded(const std::string& path, const std::string& reason) {
  constexpr std::string_view kUndefined = "undefined symbol: ";
  if (const auto at = reason.find(kUndefined); at != std::string::npos) {
    const auto begin = at + kUndefined.size();
    const std::string symbol = reason.substr(begin, reason.find_first_of(" \t,", begin) - begin);
    return fail(Fault::usage, path + " needs `" + demangled(symbol) +
                                  "`, which this program does not have: rebuild the plug-in "
                                  "against this Kaz, or define or link the missing symbol");
  }
  const auto colon = reason.find(": ");
  return fail(Fault::usage, path + " cannot be loaded as a shared object (" +
                                (colon == std::string::npos ? reason : reason.substr(colon + 2)) +
                                "): build it as " + kHowto + " shows");
}

// The begin of an ELF file, the same for 32 and 64 bit; zeros where there is less of it.
Elf32_Ehdr elf_header(const std::string& path) {
  Elf32_Ehdr header{};
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&header), sizeof header);
  return header;
}

std::string machine_text(const Elf32_Ehdr& header) {
  const std::string bits = header.e_ident[EI_CLASS] == ELFCLASS64 ? "64-bit " : "32-bit ";
  switch (header.e_machine) {
    case EM_X86_64:
      return bits + "x86-64";
    case EM_386:
      return bits + "x86";
    case EM_AARCH64:
      return bits + "AArch64";
    case EM_ARM:
      return bits + "Arm";
    case EM_RISCV:
      return bits + "RISC-V";
    default:
      return bits + "machine " + std::to_string(header.e_machine);
  }
}

// An object of another machine is to dlopen() a file that is not there.
Result<void> check_machine(const std::string& path) {
  const Elf32_Ehdr there = elf_header(path), here = elf_header("/proc/self/exe");
  const std::string_view magic(reinterpret_cast<const char*>(there.e_ident), SELFMAG);
  if (magic != ELFMAG) return {};  // which dlopen() says
  constexpr int kData = EI_DATA;
  if (there.e_machine == here.e_machine && there.e_ident[EI_CLASS] == here.e_ident[EI_CLASS] &&
      there.e_ident[kData] == here.e_ident[kData])
    return {};
  return fail(Fault::usage, path + " is for another machine type (" + machine_text(there) +
                                "; this machine: " + machine_text(here) + "): build it here");
}

// Checks that the behavior of a plug-in has a name and a function, and that its name is not taken.
Result<void> check_behavior(const Behavior* behavior, const std::string& path) {
  if (behavior == nullptr || behavior->run == nullptr || behavior->name.empty())
    return fail(Fault::usage,
                path + " has a behavior without a name or function: add the missing part");
  if (find_behavior(behavior->name))
    return fail(Fault::usage,
                path + " has a behavior named `" + std::string(behavior->name) +
                    "`, which is the name of a built-in behavior: rename the plug-in's behavior");
  if (const auto defaults = OptionValues::parse(behavior->options, {}); !defaults)
    return fail(Fault::usage,
                path + " has an option with a wrong default: " + defaults.error().message);
  return {};
}

}  // namespace

bool names_plugin(std::string_view name) {
  return name.find('/') != std::string_view::npos || name.ends_with(".so");
}

Result<Behavior> load_behavior(const std::string& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status))
    return fail(Fault::usage, path + " does not exist: build it as " + std::string(kHowto) +
                                  " shows, or give the name of a behavior");
  if (!fs::is_regular_file(status))
    return fail(Fault::usage, path + " is not a file: give the plug-in's .so");

  KAZ_TRY(check_machine(path));
  // A path without a slash would be looked for in the folders of the system's libraries.
  const std::string full = fs::absolute(path, error).string();
  void* const object = dlopen(full.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) {
    const char* const reason = dlerror();
    return not_loaded(path, reason == nullptr ? "no reason given" : reason);
  }
  using Factory = const Plugin* (*)();
  const auto factory = reinterpret_cast<Factory>(dlsym(object, kPluginSymbol));
  if (factory == nullptr)
    return fail(Fault::usage, path + " does not export `" + std::string(kPluginSymbol) +
                                  "`: end the plug-in's source with KAZ_BEHAVIOR_PLUGIN(behavior), "
                                  "or rebuild the plug-in if it was built for another version of "
                                  "Kaz");
  const Plugin* plugin = nullptr;
  try {
    plugin = factory();
  } catch (...) {
    return fail(Fault::usage, thrown_error(path).message + " while it was loaded");
  }
  if (plugin == nullptr || plugin->interface == nullptr)
    return fail(Fault::usage, path + " returns no plug-in: use KAZ_BEHAVIOR_PLUGIN(behavior)");
  if (plugin->interface != std::string_view(KAZ_PLUGIN_INTERFACE))
    return fail(Fault::usage,
                path + " was built against another Kaz or with other compiler options (" +
                    plugin->interface + "; this program: " + KAZ_PLUGIN_INTERFACE +
                    "): rebuild it");
  KAZ_TRY(check_behavior(plugin->behavior, path));
  return *plugin->behavior;
}

Error thrown_error(const std::string& who) {
  const std::type_info* const type = abi::__cxa_current_exception_type();
  const std::string what =
      who + " threw " + (type == nullptr ? "an exception" : demangled(type->name()));
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return {Fault::environment, what + ": out of memory"};
  } catch (const std::exception& error) {
    return {Fault::failed, what + ": " + error.what()};
  } catch (...) {
    return {Fault::failed, what};
  }
}

Result<Behavior> named_behavior(const std::string& name) {
  if (names_plugin(name)) return load_behavior(name);
  auto found = find_behavior(name);
  if (!found) found.error().message += ", or the path of a plug-in (./NAME.so)";
  return found;
}

Result<void> load_settings(const std::string& name, std::map<std::string, std::string>& settings) {
  const auto known = named_behavior(name);
  if (!known) return {};
  for (const Option& option : known->options) {
    const auto set = settings.find(std::string(option.name));
    if (option.load == nullptr || set == settings.end()) continue;
    const auto value = KAZ_TRY(option.load(set->second));
    set->second = value;
  }
  return {};
}

}  // namespace kaz::behavior
