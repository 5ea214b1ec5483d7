/// \file
/// Reading of the next beams while their reader works on those before.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush {

/// The beams of another source, which must outlive it. The source makes its next chunk, where a
/// thread is free, while the caller works on the one before. `info` is that of the time of the
/// chunk.
class ReadAhead : public BeamSource {
 public:
  explicit ReadAhead(BeamSource& source);
  const LogInfo& info() const override { return info_; }
  size_t size() const override { return size_; }
  void rewind() override;
  bool next(BeamLog& chunk) override;

 private:
  void start();

  BeamSource& source_;
  LogInfo info_;
  size_t size_;
  BeamLog ahead_;  // the next chunk, and what it ends with:
  LogInfo info_ahead_;
  bool is_begun_ = false, is_at_end_ = false;
  Background background_;  // the last member: it ends before the others do
};

}  // namespace underbrush
