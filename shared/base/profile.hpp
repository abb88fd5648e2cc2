// Profiler: measures CPU time and waiting time of each part of the program and of each thread.
// SPDX-License-Identifier: Apache-2.0
//
// A ProfileScope assigns the time of its thread to a part of the program. Scopes nest, and time counts for
// the innermost scope. So the times of the parts add up to the time of the outermost scopes. If no Profile
// exists, a scope executes only one load and one branch. If a Profile exists, a scope reads two clocks at its
// beginning and at its end. All these readings together take 1.55 us.
#ifndef KAZ_SHARED_BASE_PROFILE_HPP
#define KAZ_SHARED_BASE_PROFILE_HPP

#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace kaz {

// Collects the times. parts() and threads() may be called from any thread.
class Profile {
 public:
  struct Part {
    std::string name;
    double cpu_s = 0;         // CPU time of all threads in scopes of this part
    double waiting_s = 0;     // wall time minus CPU time: waiting for a lock, a file, a processor
    std::uint64_t count = 0;  // ended scopes
  };
  struct Thread {
    // Name of the thread: the name of its outermost scope. If an earlier thread has the same name, a number
    // is appended.
    std::string name;
    double cpu_s = 0;  // CPU time in scopes
  };

  // A Profile measures the scopes of all threads during the lifetime of the Profile. At most one Profile may
  // exist. A scope does not count if it is open when the Profile begins or ends.
  Profile() {
    epoch().fetch_add(1);
    current().store(this);
  }
  ~Profile() { current().store(nullptr); }
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  // Returns the parts that had scopes, by decreasing CPU time.
  std::vector<Part> parts() const {
    std::vector<Part> all;
    const std::lock_guard lock(mutex_);
    for (const auto& table : tables_) {
      for (const Row& row : table->rows) {
        auto found = std::ranges::find(all, row.name, &Part::name);
        if (found == all.end()) found = all.insert(all.end(), {row.name, 0, 0, 0});
        const double cpu_s = 1e-9 * static_cast<double>(row.cpu_ns.load());
        found->cpu_s += cpu_s;
        found->waiting_s += std::max(0.0, 1e-9 * static_cast<double>(row.wall_ns.load()) - cpu_s);
        found->count += row.count.load();
      }
    }
    std::ranges::stable_sort(all, std::ranges::greater(), &Part::cpu_s);
    return all;
  }

  // Returns the threads that had scopes, by decreasing CPU time.
  std::vector<Thread> threads() const {
    std::vector<Thread> all;
    const std::lock_guard lock(mutex_);
    for (const auto& table : tables_) {
      Thread thread{table->name, 0};
      for (const Row& row : table->rows)
        thread.cpu_s += 1e-9 * static_cast<double>(row.cpu_ns.load());
      const auto same = std::ranges::count_if(
          all, [&](const Thread& other) { return other.name.starts_with(table->name); });
      if (same > 0) thread.name += " " + std::to_string(same + 1);
      all.push_back(std::move(thread));
    }
    std::ranges::stable_sort(all, std::ranges::greater(), &Thread::cpu_s);
    return all;
  }

 private:
  friend class ProfileScope;
  // Times of one part in one thread. Only the thread of the Row writes the times; any thread may read the
  // times.
  struct Row {
    explicit Row(const char* part) : name(part) {}
    std::string name;
    std::atomic<std::int64_t> cpu_ns{0}, wall_ns{0};
    std::atomic<std::uint64_t> count{0};
  };
  struct Table {
    std::string name;
    std::deque<Row> rows;  // appended under the profile's mutex
  };

  static std::atomic<Profile*>& current() {
    static std::atomic<Profile*> profile{nullptr};
    return profile;
  }
  // Number of profiles so far. With this number, a thread detects a new profile even if the new profile is at
  // the address of an earlier profile.
  static std::atomic<std::uint64_t>& epoch() {
    static std::atomic<std::uint64_t> count{0};
    return count;
  }

  std::shared_ptr<Table> new_table(const std::string& name) {
    const std::lock_guard lock(mutex_);
    tables_.push_back(std::make_shared<Table>(Table{name, {}}));
    return tables_.back();
  }
  Row& row_of(Table& table, const char* part) {
    for (Row& row : table.rows) {
      if (row.name == part) return row;
    }
    const std::lock_guard lock(mutex_);
    return table.rows.emplace_back(part);
  }

  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Table>> tables_;  // one table per thread
};

// While a ProfileScope exists, the time of the scope's thread counts for a part of the program.
class ProfileScope {
 public:
  // `part` must outlive the scope.
  explicit ProfileScope(const char* part) {
    Profile* const profile = Profile::current().load(std::memory_order_relaxed);
    if (profile == nullptr) return;
    Local& local = this_thread();
    const std::uint64_t epoch = Profile::epoch().load(std::memory_order_relaxed);
    if (local.table == nullptr || local.epoch != epoch) {
      local = {profile->new_table(part), epoch, nullptr, {}};
    }
    const Moment now = Moment::now();
    if (local.innermost != nullptr) local.innermost->charge(now, local.last);
    local.last = now;
    epoch_ = epoch;
    row_ = &profile->row_of(*local.table, part);
    outer_ = local.innermost;
    local.innermost = this;
  }
  ~ProfileScope() {
    if (row_ == nullptr) return;
    Local& local = this_thread();
    // If another profile has begun, row_ no longer exists.
    if (local.epoch != epoch_) return;
    const Moment now = Moment::now();
    charge(now, local.last);
    row_->count.fetch_add(1, std::memory_order_relaxed);
    local.last = now;
    local.innermost = outer_;
  }
  ProfileScope(const ProfileScope&) = delete;
  ProfileScope& operator=(const ProfileScope&) = delete;

 private:
  struct Moment {
    std::int64_t cpu_ns = 0, wall_ns = 0;
    static std::int64_t ns(clockid_t clock) {
      timespec t{};
      clock_gettime(clock, &t);
      return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
    }
    static Moment now() { return {ns(CLOCK_THREAD_CPUTIME_ID), ns(CLOCK_MONOTONIC)}; }
  };
  struct Local {
    std::shared_ptr<Profile::Table> table;
    std::uint64_t epoch = 0;
    ProfileScope* innermost = nullptr;
    Moment last;
  };
  static Local& this_thread() {
    thread_local Local local;
    return local;
  }
  void charge(const Moment& now, const Moment& since) {
    row_->cpu_ns.fetch_add(now.cpu_ns - since.cpu_ns, std::memory_order_relaxed);
    row_->wall_ns.fetch_add(now.wall_ns - since.wall_ns, std::memory_order_relaxed);
  }

  Profile::Row* row_ = nullptr;
  std::uint64_t epoch_ = 0;
  ProfileScope* outer_ = nullptr;
};

}  // namespace kaz

#endif
