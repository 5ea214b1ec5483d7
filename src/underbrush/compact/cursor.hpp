/// \file
/// Numbers written to a string of bytes and read from one, little-endian.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "underbrush/core/check.hpp"

namespace underbrush::compact {

/// Appends the bytes of a number.
template <class T>
void put(std::string& out, T value) {
  static_assert(std::endian::native == std::endian::little);
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

/// A place in a string of bytes, which is read from the front. Each function throws `FormatError`
/// (with the names given to the constructor) where the bytes end too early.
class Cursor {
 public:
  /// `bytes`, `file` and `place` must outlive the cursor.
  Cursor(std::string_view bytes, const std::string& file, const std::string& place)
      : rest_(bytes), file_(file), place_(place) {}

  /// Returns the next n bytes.
  std::string_view take(size_t n) {
    require(n);
    const std::string_view out = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return out;
  }
  /// Returns the next number.
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  /// Throws unless there are n more bytes; called before memory for them is taken.
  void require(size_t n) const {
    if (n > rest_.size()) fail("its content ends too early");
  }
  /// Throws the error of damaged content.
  [[noreturn]] void fail(const char* reason) const { throw FormatError(file_, place_, reason); }

 private:
  std::string_view rest_;
  const std::string& file_;
  const std::string& place_;
};

}  // namespace underbrush::compact
