/// \file
/// The echoes of a log's pulses, by number, range and class.
#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::studies {

/// Counts the pulses of a log that return by their number of echoes (1, 2, 3 or more), the range of
/// the first echo in bands, and whether that echo is on the ground.
class EchoCounts {
 public:
  static constexpr size_t kBands = 4;

  /// `ground` is the model whose ground mesh decides the class: an echo less than 0.2 m above it is
  /// on the ground; one beside the mesh is not.
  EchoCounts(const BeamLog& log, const elements::Model& ground);

  /// The share of the returning pulses that have at least so many echoes (2 or 3).
  double share(size_t echoes) const;
  /// The share with at least two echoes of the pulses of a class, or of a band.
  double share_of_class(bool ground) const;
  double share_in_band(size_t band) const;
  /// "0 to 2 m" …
  static std::string name_of_band(size_t band);
  /// The quartiles of the distances of neighbouring echoes of a pulse, m.
  std::array<double, 3> gaps() const;
  /// The distance of the numbers of echoes from those of a real log: half the sum of the absolute
  /// differences of their shares, in each class and band, averaged by the real pulses there. It is
  /// 0 for equal shares and 1 for disjoint ones.
  double distance(const EchoCounts& real) const;

 private:
  static constexpr size_t kNumbers = 3;
  using Choice = std::function<bool(size_t band, bool ground)>;
  static size_t index(size_t number, size_t band, bool ground) {
    return (number * kBands + band) * 2 + ground;
  }
  /// The share with at least so many echoes of the chosen pulses.
  double share_where(const Choice& of, size_t echoes) const;

  std::array<size_t, kNumbers * kBands * 2> counts_{};
  size_t pulses_ = 0;
  std::vector<double> gaps_;
};

}  // namespace underbrush::studies
