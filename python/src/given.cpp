#include "given.hpp"

#include "underbrush/core/first_echoes.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/log_sequence.hpp"

namespace underbrush::python {
namespace {

constexpr size_t kChunk = 1 << 18;  // rows

struct OwnMemorySource {
  MemorySource memory;
};

/// The first echo, or the miss, of each beam of a log in memory.
class MemoryBeams : private OwnMemorySource, public FirstEchoes {
 public:
  explicit MemoryBeams(const BeamLog& log)
      : OwnMemorySource{MemorySource(log, kChunk)}, FirstEchoes(memory) {}
};

}  // namespace

std::unique_ptr<BeamSource> source_of(const GivenLog& log, bool echoes) {
  if (const auto* path = std::get_if<std::filesystem::path>(&log)) {
    if (echoes) return std::make_unique<io::LogReader>(*path);
    return std::make_unique<io::BeamReader>(*path, kChunk);
  }
  const BeamLog& memory = *std::get<const BeamLog*>(log);
  memory.check();
  if (echoes) return std::make_unique<MemorySource>(memory, kChunk);
  return std::make_unique<MemoryBeams>(memory);
}

BeamLog whole_log(BeamSource& source) {
  BeamLog whole;
  for (BeamLog chunk; source.next(chunk);) {
    if (whole.empty()) {
      whole = chunk.like();
      whole.reserve(source.size());
    }
    whole.append(chunk, 0, chunk.size());
  }
  whole.info = source.info();
  return whole;
}

BeamLog joined(std::vector<BeamLog> chunks) {
  BeamLog whole;
  size_t rows = 0;
  for (const BeamLog& chunk : chunks) rows += chunk.size();
  for (BeamLog& chunk : chunks) {
    if (whole.empty()) {
      whole = chunk.like();
      whole.reserve(rows);
    }
    whole.append(chunk, 0, chunk.size());
    chunk = {};
  }
  return whole;
}

std::map<std::string, size_t> skipped_in(const BeamSource& source) {
  if (const auto* reader = dynamic_cast<const io::LogReader*>(&source)) return reader->skipped();
  if (const auto* logs = dynamic_cast<const io::LogSequence*>(&source)) return logs->skipped();
  return {};
}

std::string name_of(const GivenLog& log) {
  const auto* path = std::get_if<std::filesystem::path>(&log);
  return path ? path->string() : "log";
}

const elements::Model& model_of(const GivenModel& model, elements::Model& read) {
  if (const auto* path = std::get_if<std::filesystem::path>(&model)) {
    read = elements::read_model(*path);
    return read;
  }
  return *std::get<const ModelValue*>(model);
}

}  // namespace underbrush::python
