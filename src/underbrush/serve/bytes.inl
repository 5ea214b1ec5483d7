// Replies that are bytes. Only sources of this module include this file.
#pragma once
#include <string>

namespace underbrush::serve {

/// Appends values as they lie in memory: little-endian, as the page reads them.
template <class T>
void append(std::string& bytes, const T* values, size_t n) {
  bytes.append(reinterpret_cast<const char*>(values), n * sizeof(T));
}
template <class T>
void append(std::string& bytes, const T& value) {
  append(bytes, &value, 1);
}

}  // namespace underbrush::serve
