/// \file
/// This file adds objects to a list that do not exist ([rosenberger20] §5).
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// The options of `FalsePositives`.
struct FalsePositiveOptions {
  double rate_per_s = 0;     ///< Mean number of ghosts that appear in a second.
  double mean_life_s = 0.5;  ///< Mean time for which a ghost stays.
  double least_range_m = 3, most_range_m = 60;
  double field_rad = 2 * M_PI;  ///< Horizontal field of view, about the vehicle's x axis.
  Vec3 least_size_m{0.3, 0.3, 0.3}, most_size_m{2, 2, 1.5};
  double drift_m_s = 0.3;  ///< Standard deviation of a ghost's velocity along x and y.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The numbers of ghosts begin here, so that they never are those of a track.
inline constexpr uint64_t kFirstGhost = uint64_t(1) << 48;

/// Ghost objects, such as spray, dust or reflections make. They appear as a Poisson process, evenly
/// over the field of view in range and bearing, and each stays for a time of an exponential
/// distribution. All random numbers are hashes of the seed, the number of the cycle and that of the
/// ghost in it, so the state is a plain value.
class FalsePositives {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit FalsePositives(const FalsePositiveOptions& options = {}, uint64_t seed = 1);
  /// Adds the ghosts to a list. The first list has no time step, so it gets none.
  void step(ObjectList& list);
  /// Forgets all ghosts, and begins the sequence of random numbers anew.
  void reset();

 private:
  struct Ghost {
    TrackedObject object;
    double end_s;
  };
  void add(const ObjectList& list, uint64_t key, uint32_t k);

  FalsePositiveOptions options_;
  uint64_t seed_, cycle_ = 0, next_ = 0;
  double last_s_ = 0;
  std::vector<Ghost> ghosts_;
};

}  // namespace underbrush::perception
