#include "underbrush/jobs/joined_logs.hpp"

#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::jobs {

JoinedLogs::JoinedLogs(std::vector<std::filesystem::path> files, size_t first_beams)
    : files_(std::move(files)), first_beams_(first_beams) {
  for (const std::filesystem::path& file : files_) size_ += io::LogReader(file).size();
  rewind();
  info_ = reader_->info();
}

void JoinedLogs::rewind() {
  at_ = 0;
  rest_ = BeamLog();
  begun_ = false;
  open();
}

bool JoinedLogs::next(BeamLog& chunk) {
  if (!begun_) {
    begun_ = true;
    return first(chunk);
  }
  if (rest_.empty()) return read(chunk);
  chunk = std::move(rest_);
  rest_ = BeamLog();
  return true;
}

void JoinedLogs::open() {
  reader_ = std::make_unique<io::LogReader>(files_[at_], pipeline::kSimulatedBeams);
}

bool JoinedLogs::read(BeamLog& chunk) {
  while (!reader_->next(chunk)) {
    if (at_ + 1 == files_.size()) return false;
    ++at_;
    open();
  }
  return true;
}

bool JoinedLogs::first(BeamLog& chunk) {
  size_t beams = 0;
  chunk = BeamLog();
  for (BeamLog part; rest_.empty() && read(part);) {
    const std::vector<bool> begins = begins_beam(part);
    size_t end = 0;
    while (end < part.size() && (beams += begins[end]) <= first_beams_) ++end;
    if (chunk.empty()) chunk = part.like();
    chunk.append(part, 0, end);
    rest_ = part.like();
    rest_.append(part, end, part.size());
  }
  return !chunk.empty();
}

}  // namespace underbrush::jobs
