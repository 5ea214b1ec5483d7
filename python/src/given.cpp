#include "given.hpp"

#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::python {
namespace {

constexpr size_t kChunk = 1 << 18;  // rows

/// The first echo, or the miss, of each beam of a log in memory.
class FirstEchoes : public BeamSource {
 public:
  explicit FirstEchoes(const BeamLog& log) : source_(log, kChunk), beams_(log.size()) {
    if (log.extra.contains(kEchoColumn)) {
      const std::vector<bool> begins = begins_beam(log);
      beams_ = size_t(std::count(begins.begin(), begins.end(), true));
    }
  }
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return beams_; }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override {
    while (source_.next(chunk)) {
      keep_first_echoes(chunk);
      if (!chunk.empty()) return true;
    }
    return false;
  }

 private:
  MemorySource source_;
  size_t beams_;
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
  return std::make_unique<FirstEchoes>(memory);
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

std::map<std::string, size_t> skipped_in(const BeamSource& source) {
  if (const auto* reader = dynamic_cast<const io::LogReader*>(&source)) return reader->skipped();
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
