// Calls the functions of libFuzzer without it: for each file of the command line, and for N damaged
// copies of it, as `replay N FILE ...`. A copy has one run of bytes changed, or ends early.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

// The names are libFuzzer's.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" int LLVMFuzzerInitialize(int* count, char*** words);
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
// NOLINTEND(readability-identifier-naming)

namespace {

void give(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
}

std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](size_t n) { return size_t(random()) % n; };
  const size_t at = below(bytes.size());
  if (below(4) == 0) return bytes.substr(0, at);
  for (size_t i = at; i < bytes.size() && i < at + 4; ++i) {
    bytes[i] = char(random());
    if (below(2) == 0) break;
  }
  return bytes;
}

}  // namespace

int main(int count, char** words) {
  LLVMFuzzerInitialize(&count, &words);
  const int copies = count > 1 ? std::atoi(words[1]) : 0;
  for (int i = 2; i < count; ++i) {
    std::ifstream file(words[i], std::ios::binary);
    if (!file) return std::fprintf(stderr, "replay: %s cannot be read\n", words[i]), 2;
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    give(bytes);
    std::mt19937 random(1);
    for (int k = 0; k < copies && !bytes.empty(); ++k) give(damaged(bytes, random));
  }
  return 0;
}
