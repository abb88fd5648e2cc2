// One call at a time, and a stop that ends it.
// SPDX-License-Identifier: Apache-2.0
#include "python/src/object_lock.h"

namespace kaz::python {

ObjectLock::Call::Call(ObjectLock& lock) : lock_(lock) {
  const std::lock_guard guard(lock_.mutex_);
  const std::thread::id mine = std::this_thread::get_id();
  outer_ = lock_.owner_;
  stops_ = lock_.stops_;
  if (lock_.stopping_ || lock_.waiting_ > 0)
    state_ = State::stopping;
  else if (outer_ != std::thread::id() && outer_ != mine)
    state_ = State::in_use;
  else
    lock_.owner_ = mine;
}

ObjectLock::Call::~Call() {
  const std::lock_guard guard(lock_.mutex_);
  if (state_ == State::begun && lock_.stops_ == stops_) lock_.owner_ = outer_;
}

bool ObjectLock::Call::enter() {
  std::unique_lock guard(lock_.mutex_);
  lock_.left_.wait(guard, [this] { return !lock_.inside_; });
  if (state_ != State::begun || lock_.stops_ != stops_) return false;
  lock_.inside_ = true;
  return true;
}

void ObjectLock::Call::leave() {
  const std::lock_guard guard(lock_.mutex_);
  lock_.inside_ = false;
  lock_.left_.notify_all();
}

ObjectLock::Stop::Stop(ObjectLock& lock) : lock_(lock) {
  std::unique_lock guard(lock_.mutex_);
  ++lock_.stops_;
  ++lock_.waiting_;
  // Another stop, which is at work, must read its reply.
  if (lock_.inside_ && !lock_.stopping_) lock_.interrupt_.request();
  lock_.left_.wait(guard, [this] { return !lock_.inside_; });
  --lock_.waiting_;
  lock_.inside_ = lock_.stopping_ = true;
  lock_.owner_ = std::thread::id();
  lock_.interrupt_.withdraw();
}

ObjectLock::Stop::~Stop() {
  const std::lock_guard guard(lock_.mutex_);
  lock_.inside_ = lock_.stopping_ = false;
  lock_.left_.notify_all();
}

}  // namespace kaz::python
