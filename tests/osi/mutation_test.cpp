// Damaged messages: whatever the bytes are, reading ends with a message or a FormatError.
// `make fuzz-long` tries more of them, under sanitizers.
#include <gtest/gtest.h>

#include "messages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush {
namespace {

constexpr size_t kMutants = 5000;

// Flips, inserts, removes, repeats and moves bytes, or makes a length absurd.
void mutate(std::string& s, Stream& random) {
  const uint64_t changes = 1 + random.below(4);
  for (uint64_t k = 0; k < changes && !s.empty(); ++k) {
    const size_t at = random.below(s.size());
    const size_t n = std::min<size_t>(1 + random.below(16), s.size() - at);
    switch (random.below(7)) {
      case 0:
        s[at] = char(uint8_t(s[at]) ^ (1u << random.below(8)));
        break;
      case 1:
        s[at] = char(random.below(256));
        break;
      case 2:
        s.erase(at, n);
        break;
      case 3:
        s.insert(at, s.substr(random.below(s.size()), n));
        break;
      case 4:
        s.resize(at);
        break;
      case 5:
        s.replace(at, n, std::string(n, '\xFF'));
        break;
      default:
        s.insert(at, n, '\0');
    }
  }
}

template <class Read>
void try_mutants(const std::string& seed, uint64_t key, size_t count, Read read) {
  Stream random(key);
  size_t errors = 0;
  for (size_t k = 0; k < count; ++k) {
    std::string bytes = seed;
    mutate(bytes, random);
    osi::type_of_message(bytes);
    try {
      read(bytes);
    } catch (const FormatError& e) {
      ++errors;
      EXPECT_FALSE(e.reason().empty());
    }
  }
  EXPECT_GT(errors, count / 20);
  EXPECT_LT(errors, count);
}

TEST(Mutants, AreMessagesOrFormatErrors) {
  std::string view, data, truth, configuration;
  osi::write(test::view(), view);
  osi::SensorData d = test::data();
  d.views = {std::make_shared<osi::SensorView>(test::view())};
  osi::write(d, data);
  osi::write(test::truth(), truth);
  osi::SensorViewConfiguration c;
  c.cycle_s = 0.1;
  c.lidar = {*test::view().lidar[0].configuration};
  osi::write(c, configuration);
  // What was read can be written, and what was written can be read.
  try_mutants(view, 1, kMutants * 2 / 5, [](const std::string& bytes) {
    std::string out;
    osi::write(osi::read_sensor_view(bytes, "mutant"), out);
    osi::read_sensor_view(out, "again");
  });
  try_mutants(data, 2, kMutants * 2 / 5, [](const std::string& bytes) {
    std::string out;
    osi::write(osi::read_sensor_data(bytes, "mutant"), out);
    osi::read_sensor_data(out, "again");
  });
  try_mutants(truth, 3, kMutants / 10,
              [](const std::string& b) { osi::read_ground_truth(b, "mutant"); });
  try_mutants(configuration, 4, kMutants / 10,
              [](const std::string& b) { osi::read_configuration(b, "mutant"); });
}

}  // namespace
}  // namespace underbrush
