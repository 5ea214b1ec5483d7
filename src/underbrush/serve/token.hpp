/// \file
/// The token that the clients of a server must name.
#pragma once
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

namespace underbrush::serve {

/// Returns 128 random bits of the system's generator, as 32 digits.
inline std::string random_token() {
  std::random_device device;
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (int k = 0; k < 4; ++k) {
    const uint32_t bits = device();
    for (int shift = 28; shift >= 0; shift -= 4) out += kDigits[bits >> shift & 15];
  }
  return out;
}

/// Compares tokens in a time that does not depend on the number of equal characters.
inline bool same_token(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (size_t i = 0; i < a.size(); ++i) different |= unsigned(uint8_t(a[i]) ^ uint8_t(b[i]));
  return different == 0;
}

}  // namespace underbrush::serve
