/// \file
/// Tables in which every beam has its own origin.
#pragma once
#include <map>
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

/// Source that owns the log that it reads from.
class LogInMemory : public BeamSource {
 public:
  explicit LogInMemory(BeamLog log) : log_(std::move(log)), source_(log_) {}
  LogInMemory(const LogInMemory&) = delete;
  LogInMemory& operator=(const LogInMemory&) = delete;
  const LogInfo& info() const override { return log_.info; }
  size_t size() const override { return log_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override { return source_.next(chunk); }

 private:
  BeamLog log_;
  MemorySource source_;
};

/// Whether the table has the columns ox, oy and oz.
bool has_origins(const Table& table);

/// Makes a log from a table of end points x y z and origins ox oy oz (m, world). Where a column
/// `hit` is 0, the beam is a miss that points at x y z. The columns time, intensity, ring, scan,
/// packet and flags are understood; all others become extra columns. The maximum range is the
/// longest beam. Beams that are not finite or have no length are counted in `skipped`. Throws
/// `FormatError`, naming `file`.
BeamLog beams_from_table(const std::string& file, Table table,
                         std::map<std::string, size_t>& skipped);

}  // namespace underbrush::io
