/// \file
/// A part of a log, as a log of its own.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// A source that can pass over beams without making them.
class SeekableSource : public BeamSource {
 public:
  /// Starts at beam `beam` or a little before it, and returns the number of the beam that `next`
  /// gives first.
  virtual size_t seek(size_t beam) = 0;
};

/// The beams [first, end) of another source, which must outlive it. The part ends where the source
/// does, if that is before `end`. The beams before it are read, unless the source is seekable.
class BeamWindow : public BeamSource {
 public:
  BeamWindow(BeamSource& source, size_t first, size_t end)
      : source_(source), first_(first), end_(end) {}
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override;
  void rewind() override;
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  size_t first_, end_;
  size_t at_ = 0;  ///< The number of the source's next beam.
};

}  // namespace underbrush
