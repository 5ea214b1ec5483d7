#include "underbrush/io/log_file.hpp"

namespace underbrush::io {

BeamReader::BeamReader(const std::filesystem::path& path, size_t chunk_size)
    : LogReader(path, chunk_size), beams_(LogReader::size()) {
  BeamLog chunk;
  if (!LogReader(path, 1).next(chunk) || chunk.extra.count(kEchoColumn) == 0) return;
  size_t beams = 0;
  while (BeamReader::next(chunk)) beams += chunk.size();
  beams_ = beams;
  LogReader::rewind();
}

size_t BeamReader::seek(size_t beam) {
  if (beams_ == LogReader::size()) return LogReader::seek(beam);
  rewind();
  return 0;
}

bool BeamReader::next(BeamLog& chunk) {
  while (LogReader::next(chunk)) {
    keep_first_echoes(chunk);
    if (!chunk.empty())
      return true;  // A chunk may hold nothing but further echoes; then the next
                    // one is read.
  }
  return false;
}

}  // namespace underbrush::io
