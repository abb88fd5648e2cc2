// Serialization of states. Each class lists its members once, and the list is used for writing and reading.
// SPDX-License-Identifier: Apache-2.0
//
// A class lists its members in a member function
//   template <class A> void transfer(A& a) { a(first_, second_); }
//
// StateWriter appends the members, StateReader fills them. Numbers are little-endian and as wide as their
// type. A container begins with the number of elements. A reader never reads beyond the end of the archive.
// If bytes are missing, the reader refuses the archive and sets the missing numbers to zero.
//
// Bytes may be damaged or hostile, and a checksum does not exclude hostile bytes. So the reader refuses
// values out of range. The limit of an enumeration is last_value(). kMaxArchived limits floating-point
// numbers, and kMaxArchivedTime limits times. A length cannot exceed the number of remaining bytes. All other
// indices, lengths, shifts and divisors are checked by each class, with require() in its transfer().
//
// After a refusal, the members can have arbitrary values, and the owner of the object must restore the old
// values.
#ifndef KAZ_SHARED_BASE_ARCHIVE_HPP
#define KAZ_SHARED_BASE_ARCHIVE_HPP

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace kaz {

namespace archive_detail {
template <class T>
inline constexpr bool is_sequence = false;
template <class T>
inline constexpr bool is_sequence<std::vector<T>> = true;
template <class T>
inline constexpr bool is_sequence<std::deque<T>> = true;
template <>
inline constexpr bool is_sequence<std::string> = true;
template <class T>
inline constexpr bool is_fixed = std::is_bounded_array_v<T>;
template <class T, std::size_t n>
inline constexpr bool is_fixed<std::array<T, n>> = true;
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_pair = false;
template <class T, class U>
inline constexpr bool is_pair<std::pair<T, U>> = true;
template <class T>
inline constexpr bool is_duration = false;
template <class R, class P>
inline constexpr bool is_duration<std::chrono::duration<R, P>> = true;
}  // namespace archive_detail

// Maximum magnitudes of numbers and times. The product of two such numbers is finite, and the difference of
// two such times fits in 64 bits.
inline constexpr double kMaxArchived = 1e15;
// Maximum value of a time or counter. A time in ns is at most 9 years, and a time in H8 states is at most 495
// years.
inline constexpr std::int64_t kMaxArchivedTime = std::int64_t{1} << 58;

// Returns whether a time or counter is within the limit. Also returns true for the maximum of std::int64_t
// and for half of this maximum: these two values mean "never".
constexpr bool is_archivable(std::int64_t number) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  return number == kMax || number == kMax / 2 ||
         (number >= -kMaxArchivedTime && number <= kMaxArchivedTime);
}

// Enumeration that begins at 0 and has a function last_value(), found by argument-dependent lookup:
//   enum class Regime { held, forward, backward };
//   constexpr Regime last_value(Regime) { return Regime::backward; }   // in a class: friend constexpr
template <class E>
concept BoundedEnum = requires(E e) {
  { last_value(e) } -> std::same_as<E>;
};

// Base class of writer and reader. The derived class defines number(), plain() and `reading`. Not
// thread-safe.
template <class Derived>
class StateArchive {
 public:
  // Writes or reads the values in order.
  template <class... T>
  void operator()(T&&... values) {
    (one(values), ...);
  }

  // Returns the first error; empty if there was no error. In the text, the words "it" and "its" stand for the
  // archive. So a caller that prints the text must name the archive first.
  const std::string& error() const { return error_; }
  bool good() const { return error_.empty(); }
  // Records an error. After the first error, further errors are ignored.
  void refuse(std::string why) {
    if (good()) error_ = std::move(why);
  }
  // Refuses the archive if `fits` is false; `what` names the value. Returns good(). A StateWriter also checks
  // the values, so that every written archive can be read again.
  bool require(bool fits, const char* what) {
    if (!fits) refuse_range(what);
    return good();
  }

 protected:
  template <class T>
  void one(T& value) {
    using namespace archive_detail;
    Derived& self = static_cast<Derived&>(*this);
    if constexpr (requires { value.transfer(self); }) {
      value.transfer(self);
    } else if constexpr (std::is_enum_v<T>) {
      static_assert(BoundedEnum<T>, "this enumeration has no last_value()");
      auto number = static_cast<std::underlying_type_t<T>>(value);
      one(number);
      const auto last = static_cast<std::underlying_type_t<T>>(last_value(value));
      if (require(number >= 0 && number <= last, "enumeration")) value = static_cast<T>(number);
    } else if constexpr (std::same_as<T, bool>) {
      std::uint8_t number = value ? 1 : 0;
      self.number(number);
      value = number != 0;
    } else if constexpr (std::is_integral_v<T>) {
      auto number = static_cast<std::make_unsigned_t<T>>(value);
      self.number(number);
      value = static_cast<T>(number);
      if constexpr (std::is_signed_v<T> && sizeof(T) == 8) require(is_archivable(value), "number");
    } else if constexpr (std::same_as<T, double>) {
      auto number = std::bit_cast<std::uint64_t>(value);
      self.number(number);
      value = std::bit_cast<double>(number);
      require(std::abs(value) <= kMaxArchived, "number");
    } else if constexpr (is_duration<T>) {
      auto count = value.count();
      one(count);
      value = T(count);
    } else if constexpr (is_fixed<T>) {
      for (auto& item : value) one(item);
    } else if constexpr (is_pair<T>) {
      one(value.first);
      one(value.second);
    } else if constexpr (is_optional<T>) {
      bool there = value.has_value();
      one(there);
      if (!there) return value.reset();
      if (!value) value.emplace();
      one(*value);
    } else if constexpr (std::same_as<T, std::vector<bool>>) {
      std::vector<std::uint8_t> bits(value.begin(), value.end());
      one(bits);
      value.assign(bits.begin(), bits.end());
    } else {
      static_assert(is_sequence<T>, "this type has no transfer()");
      auto size = static_cast<std::uint64_t>(value.size());
      self.number(size);
      if constexpr (Derived::reading) {
        if (!self.holds(size)) return;
        value.clear();
        // Adds the elements one by one instead of allocating memory for all elements first. Reason: `size`
        // may be wrong, and an element can be larger in memory than in the archive.
        for (; size > 0 && good(); --size) {
          value.push_back({});
          one(value.back());
        }
      } else {
        for (auto& item : value) one(item);
      }
    }
  }

 private:
  // Not inline: the function runs rarely, and inlining would bloat the code for each number.
  [[gnu::noinline]] void refuse_range(const char* what) {
    if (good()) error_.append("its ").append(what).append(" is out of range");
  }
  std::string error_;
};

// Serializes a state to bytes.
class StateWriter : public StateArchive<StateWriter> {
 public:
  static constexpr bool reading = false;
  void number(std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  // Copies the memory of a C struct into the archive. The struct must not contain pointers. Only the same
  // build can read these bytes.
  template <class T>
  void plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    number(static_cast<std::uint32_t>(sizeof value));
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Restores a state from bytes, which must outlive the reader.
class StateReader : public StateArchive<StateReader> {
 public:
  static constexpr bool reading = true;
  explicit StateReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::unsigned_integral T>
  void number(T& value) {
    value = 0;
    if (!holds(sizeof value)) return;
    for (std::size_t i = 0; i < sizeof value; ++i)
      value = static_cast<T>(value | static_cast<T>(T{bytes_[i]} << (8 * i)));
    bytes_ = bytes_.subspan(sizeof value);
  }
  template <class T>
  void plain(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::uint32_t size = 0;
    number(size);
    if (good() && size != sizeof value) refuse("it is from another build");
    if (!holds(sizeof value)) return;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
  }
  // Returns whether `size` bytes are left; refuses the archive if not.
  bool holds(std::uint64_t size) {
    if (good() && size > bytes_.size()) refuse("it ends too early");
    return good();
  }
  // Returns the number of unread bytes.
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace kaz

#endif
