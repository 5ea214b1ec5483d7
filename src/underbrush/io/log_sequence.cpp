#include "underbrush/io/log_sequence.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

std::string meters(double range_m) {
  return std::isfinite(range_m) ? std::to_string(int(std::lround(range_m))) + " m" : "unlimited";
}

std::string named(const std::string& name) { return name.empty() ? "unknown" : name; }

/// Throws unless a log fits to the first one of its sequence.
void check_fit(const LogInfo& first, const fs::path& first_file, const LogInfo& info,
               const fs::path& file) {
  const auto fail = [&](const std::string& what, const std::string& a, const std::string& b) {
    throw FormatError(file.string(), "",
                      what + " is " + b + ", that of " + first_file.string() + " is " + a +
                          ": logs of one fit have the same");
  };
  if (info.sensor != first.sensor || info.sensor_file != first.sensor_file) {
    fail("its sensor", named(first.sensor), named(info.sensor));
  }
  if (info.max_range_m != first.max_range_m) {
    fail("its maximum range", meters(first.max_range_m), meters(info.max_range_m));
  }
  if (info.classes != first.classes || info.element_classes != first.element_classes) {
    fail("its label set", named(first.classes), named(info.classes));
  }
}

}  // namespace

LogSequence::LogSequence(std::vector<fs::path> files) : files_(std::move(files)) {
  require(!files_.empty(), "a sequence of logs needs a log");
  for (const fs::path& file : files_) add(LogReader(file), file);
  end_ = size();
  skipped_.resize(files_.size());
}

void LogSequence::add(const LogReader& reader, const fs::path& file) {
  const size_t k = starts_.size() - 1;
  LogInfo info = reader.info();
  for (size_t earlier = 0; earlier < k; ++earlier) {
    if (files_[earlier].lexically_normal() != file.lexically_normal()) continue;
    throw FormatError(file.string(), "", "the log is named twice");
  }
  for (ScanInfo& scan : info.scans) scan.scan += uint32_t(starts_[k]);
  if (k == 0) {
    info_ = std::move(info);
  } else {
    check_fit(info_, files_[0], info, file);
    info_.min_range_m = std::min(info_.min_range_m, info.min_range_m);
    info_.has_misses &= info.has_misses;
    info_.deskewed &= info.deskewed;
    info_.scans.insert(info_.scans.end(), info.scans.begin(), info.scans.end());
  }
  starts_.push_back(starts_[k] + reader.size());
}

void LogSequence::open(size_t file) {
  at_ = file;
  reader_ = std::make_unique<LogReader>(files_[file]);
  const size_t begin = starts_[file], n = starts_[file + 1] - begin;
  const size_t first = std::clamp(first_, begin, begin + n) - begin;
  const size_t end = std::clamp(end_, begin, begin + n) - begin;
  if (first > 0 || end < n) reader_->keep_rows(first, end);
}

void LogSequence::rewind() {
  if (reader_ && files_.size() == 1) return reader_->rewind();
  reader_.reset();
}

bool LogSequence::next(BeamLog& chunk) {
  const auto is_wanted = [&](size_t k) { return starts_[k + 1] > first_ && starts_[k] < end_; };
  size_t next_file = reader_ ? at_ + 1 : 0;
  while (true) {
    if (reader_ && reader_->next(chunk)) break;
    if (reader_) skipped_[at_] = reader_->skipped();
    while (next_file < files_.size() && !is_wanted(next_file)) ++next_file;
    if (next_file >= files_.size()) {
      chunk.resize(0);
      return false;
    }
    open(next_file++);
  }
  skipped_[at_] = reader_->skipped();
  if (files_.size() == 1) return true;
  chunk.info = info_;
  const auto before = uint32_t(starts_[at_]);
  for (uint32_t& scan : chunk.scan) scan += before;
  for (uint32_t& packet : chunk.packet) packet += before;
  return true;
}

void LogSequence::keep_rows(size_t first, size_t end) {
  end_ = std::min(end, size());
  first_ = std::min(first, end_);
  reader_.reset();
}

std::map<std::string, size_t> LogSequence::skipped() const {
  std::map<std::string, size_t> out;
  for (const auto& of_file : skipped_) {
    for (const auto& [why, n] : of_file) out[why] += n;
  }
  return out;
}

}  // namespace underbrush::io
