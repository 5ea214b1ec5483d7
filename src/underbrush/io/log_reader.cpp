#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/io/log_path.hpp"
#include "underbrush/io/log_rows.hpp"

namespace underbrush::io {
namespace {

std::unique_ptr<LogRows> open_rows(const std::filesystem::path& path) {
  return is_compact(checked_log_path(path)) ? compact_format()->open(path) : open_ply_rows(path);
}

}  // namespace

bool is_compact(const std::filesystem::path& path) {
  const CompactFormat* format = compact_format();
  return format && format->is(path);
}

bool LogWindow::has(const BeamLog& log, size_t i) const {
  if (!(log.time_s[i] >= first_s && log.time_s[i] <= last_s)) return false;
  if (!has_place()) return true;
  const Vec3 end = log.end_point(i);
  return log.is_hit(i) && (end.array() >= least.array()).all() &&
         (end.array() <= most.array()).all();
}

struct LogReader::State {
  State(const std::filesystem::path& path, size_t chunk)
      : file(open_rows(path)), chunk_size(std::max<size_t>(chunk, 1)), end(file->size()) {}

  // Existing columns are used again, so that a pass over a long log allocates only once.
  void prepare(BeamLog& chunk, size_t n) const {
    const BeamLog& empty = file->empty();
    if (!std::equal(empty.extra.begin(), empty.extra.end(), chunk.extra.begin(), chunk.extra.end(),
                    [](const auto& a, const auto& b) {
                      return a.first == b.first && a.second.index() == b.second.index();
                    })) {
      chunk.extra = empty.extra;
    }
    chunk.info = file->comments.info;
    chunk.resize(n);
  }

  void drop(const std::vector<uint8_t>& fault, BeamLog& chunk);
  /// Throws `FormatError` if a row from `row` on has a fault.
  void check(const std::vector<uint8_t>& fault, size_t row) const;

  std::unique_ptr<LogRows> file;
  size_t chunk_size, first = 0, end, at = 0;
  bool sought = false;
  std::map<std::string, size_t> skipped;
};

void LogReader::State::drop(const std::vector<uint8_t>& fault, BeamLog& chunk) {
  const size_t n = fault.size();
  const size_t not_finite = size_t(std::count(fault.begin(), fault.end(), kNotFinite));
  const size_t zero_length = size_t(std::count(fault.begin(), fault.end(), kZeroLength));
  const size_t too_large = size_t(std::count(fault.begin(), fault.end(), kTooLarge));
  if (not_finite) skipped["not finite"] += not_finite;
  if (zero_length) skipped["zero-length ray"] += zero_length;
  if (too_large) skipped["coordinates beyond 67 108 km"] += too_large;
  if (not_finite + zero_length + too_large == 0) return;
  BeamLog kept = chunk.like();
  for (size_t i = 0; i < n; ++i) {
    if (fault[i] == kNoFault) kept.append(chunk, i);
  }
  chunk = std::move(kept);
}

void LogReader::State::check(const std::vector<uint8_t>& fault, size_t row) const {
  const auto bad =
      std::find_if(fault.begin(), fault.end(), [](uint8_t f) { return f != kNoFault; });
  if (bad == fault.end()) return;
  row += size_t(bad - fault.begin());
  throw FormatError(file->file(), "row " + std::to_string(row), "no usable beam");
}

LogReader::LogReader(const std::filesystem::path& path, size_t chunk_size)
    : state_(std::make_unique<State>(path, chunk_size)) {}

LogReader::~LogReader() = default;

const LogInfo& LogReader::info() const { return state_->file->comments.info; }
size_t LogReader::size() const { return state_->file->size(); }
const std::string& LogReader::provenance() const { return state_->file->comments.provenance; }
const std::map<std::string, size_t>& LogReader::skipped() const { return state_->skipped; }

void LogReader::rewind() {
  state_->at = state_->first;
  state_->sought = false;
  state_->skipped.clear();
}

size_t LogReader::seek(size_t row) {
  State& s = *state_;
  rewind();
  s.sought = s.file->comments.ours;
  if (s.sought) s.at += std::min(row, s.end - s.first) / s.chunk_size * s.chunk_size;
  return s.at - s.first;
}

void LogReader::keep_rows(size_t first, size_t end) {
  state_->end = std::min(end, state_->file->size());
  state_->first = std::min(first, state_->end);
  rewind();
}

bool LogReader::next(BeamLog& chunk) {
  State& s = *state_;
  do {
    const size_t n = std::min(s.chunk_size, s.end - s.at);
    s.prepare(chunk, n);
    if (n == 0) return false;
    std::vector<uint8_t> fault(n);
    s.file->read(s.at, chunk, fault);
    if (s.sought) s.check(fault, s.at);
    s.at += n;
    s.drop(fault, chunk);
  } while (chunk.empty());
  return true;
}

BeamLog LogReader::rows(size_t first, size_t n) const {
  require(first <= size() && n <= size() - first, "rows: beyond the end of the log");
  BeamLog out;
  state_->prepare(out, n);
  std::vector<uint8_t> fault(n);
  state_->file->read(first, out, fault);
  state_->check(fault, first);
  return out;
}

BeamLog LogReader::within(const LogWindow& window) const {
  const State& s = *state_;
  BeamLog out, part;
  s.prepare(out, 0);
  for (auto [first, end] : s.file->ranges(window)) {
    for (; first < end; first += part.size()) {
      s.prepare(part, std::min(s.chunk_size, end - first));
      std::vector<uint8_t> fault(part.size());
      s.file->read(first, part, fault);
      for (size_t i = 0; i < part.size(); ++i) {
        if (fault[i] == kNoFault && window.has(part, i)) out.append(part, i);
      }
    }
  }
  return out;
}

BeamLog read_log(const std::filesystem::path& path) {
  LogReader reader(path, std::numeric_limits<size_t>::max());
  BeamLog log;
  if (!reader.next(log)) throw FormatError(path.string(), "", "no usable beams");
  return log;
}

}  // namespace underbrush::io
