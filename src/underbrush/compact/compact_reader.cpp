#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "underbrush/compact/chunk.hpp"
#include "underbrush/compact/compact_file.hpp"
#include "underbrush/compact/file_layout.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::compact {
namespace {

const std::string kIndex = "index";

void copy_rows(const BeamLog& from, size_t first, size_t n, BeamLog& to, size_t at) {
  const auto copy = [&](const auto& source, auto& target) {
    std::copy_n(source.begin() + std::ptrdiff_t(first), n, target.begin() + std::ptrdiff_t(at));
  };
  copy(from.origin, to.origin);
  copy(from.direction, to.direction);
  copy(from.range_m, to.range_m);
  copy(from.intensity, to.intensity);
  copy(from.time_s, to.time_s);
  copy(from.ring, to.ring);
  copy(from.scan, to.scan);
  copy(from.packet, to.packet);
  copy(from.flags, to.flags);
  for (const auto& [name, column] : from.extra) {
    std::visit(
        [&, key = name](const auto& c) {
          copy(c, std::get<std::decay_t<decltype(c)>>(to.extra.at(key)));
        },
        column);
  }
}

ExtraColumn column_of(uint8_t type, const Cursor& in) {
  static const ExtraColumn kColumns[] = {std::vector<uint8_t>(),  std::vector<uint16_t>(),
                                         std::vector<uint32_t>(), std::vector<int8_t>(),
                                         std::vector<int16_t>(),  std::vector<int32_t>(),
                                         std::vector<float>(),    std::vector<double>()};
  if (type >= std::size(kColumns)) in.fail("an extra column has an unknown type");
  return kColumns[type];
}

}  // namespace

struct Reader::State {
  explicit State(const InputFile& f) : file(f) {}

  void read_index();
  void take_chunks(Cursor& in, uint64_t end);
  void decode_chunk(size_t k, BeamLog& out, size_t at) const;
  std::shared_ptr<const BeamLog> cached(size_t k) const;
  std::unique_ptr<Scratch> borrow() const;
  void give_back(std::unique_ptr<Scratch> memory) const;
  size_t rows_of(size_t k) const { return std::min(chunk_rows, rows - k * chunk_rows); }

  const InputFile& file;
  std::string text;
  size_t rows = 0, chunk_rows = 0;
  std::vector<ChunkFacts> chunks;
  BeamLog empty;
  // The last chunk of which a part was read, as the next part is often in it, too.
  mutable std::mutex mutex;
  mutable size_t last = SIZE_MAX;
  mutable std::shared_ptr<const BeamLog> last_chunk;
  mutable std::vector<std::unique_ptr<Scratch>> scratch;  // of threads that read no chunk now
};

std::unique_ptr<Scratch> Reader::State::borrow() const {
  const std::lock_guard lock(mutex);
  if (scratch.empty()) return std::make_unique<Scratch>();
  std::unique_ptr<Scratch> out = std::move(scratch.back());
  scratch.pop_back();
  return out;
}

void Reader::State::give_back(std::unique_ptr<Scratch> memory) const {
  const std::lock_guard lock(mutex);
  scratch.push_back(std::move(memory));
}

bool is_compact(const InputFile& file) {
  char start[kMagic.size()];
  if (file.size() < sizeof start) return false;
  file.read(0, start, sizeof start);
  constexpr size_t kVersion = 1;
  return std::string_view(start, sizeof start - kVersion) ==
         kMagic.substr(0, sizeof start - kVersion);
}

Reader::Reader(const InputFile& file) : state_(std::make_unique<State>(file)) {
  state_->read_index();
}

Reader::~Reader() = default;

const std::string& Reader::text() const { return state_->text; }
size_t Reader::rows() const { return state_->rows; }
const std::vector<ChunkFacts>& Reader::chunks() const { return state_->chunks; }
const BeamLog& Reader::empty() const { return state_->empty; }

void Reader::State::read_index() {
  const auto fail = [&](const char* place, const char* reason) {
    throw FormatError(file.name(), place, reason);
  };
  std::string start(kMagic.size(), '\0'), trailer(kTrailerBytes, '\0');
  if (file.size() < start.size() + trailer.size()) fail("", "the file is truncated");
  file.read(0, start.data(), start.size());
  if (start != kMagic) fail("byte 7", "a compact log of an unknown version");
  const uint64_t trailer_at = file.size() - kTrailerBytes;
  file.read(trailer_at, trailer.data(), trailer.size());
  if (!std::string_view(trailer).ends_with(kEndMagic)) {
    fail("its end", "the index of the chunks is not there: the file is truncated");
  }
  const std::string trailer_name = "its end";
  Cursor ends(trailer, file.name(), trailer_name);
  const auto index_at = ends.get<uint64_t>(), index_bytes = ends.get<uint64_t>(),
             index_hash = ends.get<uint64_t>(), trailer_hash = ends.get<uint64_t>();
  if (trailer_hash != XXH3_64bits(trailer.data(), 3 * sizeof(uint64_t))) ends.fail("damaged");
  if (index_at > trailer_at || index_bytes > kMostIndexBytes) ends.fail("damaged");
  std::string block(size_t(trailer_at - index_at), '\0');
  file.read(index_at, block.data(), block.size());
  Cursor damaged({}, file.name(), kIndex);
  if (index_hash != XXH3_64bits(block.data(), block.size())) damaged.fail("damaged");
  std::string index(size_t(index_bytes), '\0');
  Codec().inflate(block, index, damaged);
  Cursor in(index, file.name(), kIndex);
  take_chunks(in, index_at);
}

void Reader::State::take_chunks(Cursor& in, uint64_t end) {
  rows = size_t(in.get<uint64_t>());
  chunk_rows = in.get<uint32_t>();
  const size_t n = in.get<uint32_t>(), text_bytes = in.get<uint32_t>(),
               columns = in.get<uint32_t>();
  if (rows == 0) in.fail("an empty log: no beams");
  if (chunk_rows == 0 || chunk_rows > kChunkRows || columns > kMostColumns ||
      n != (rows - 1) / chunk_rows + 1) {
    in.fail("its counts make no sense");
  }
  for (size_t k = 0; k < columns; ++k) {
    const auto type = in.get<uint8_t>();
    const std::string name(in.take(in.get<uint16_t>()));
    if (!empty.extra.emplace(name, column_of(type, in)).second) in.fail("a column stands twice");
  }
  text = in.take(text_bytes);
  in.require(n * kFactsBytes);
  chunks.resize(n);
  uint64_t at = kMagic.size();
  for (size_t k = 0; k < n; ++k) {
    ChunkFacts& c = chunks[k];
    c.offset = at;
    c.size = in.get<uint64_t>();
    c.hash = in.get<uint64_t>();
    c.returns = in.get<uint64_t>();
    c.first_s = in.get<double>();
    c.last_s = in.get<double>();
    for (Box* box : {&c.ends, &c.origins}) {
      for (Vec3* corner : {&box->least, &box->most}) {
        for (double& x : *corner) x = in.get<double>();
      }
    }
    if (c.size > end - at || c.size * kMostExpansion < rows_of(k) * row_bytes(empty)) {
      in.fail("the chunks' sizes make no sense");
    }
    at += c.size;
  }
  if (at != end) in.fail("the chunks' sizes make no sense");
}

void Reader::State::decode_chunk(size_t k, BeamLog& out, size_t at) const {
  const ChunkFacts& c = chunks[k];
  const std::string place = "chunk " + std::to_string(k) + " of " + std::to_string(chunks.size());
  std::string bytes(size_t(c.size), '\0');
  file.read(c.offset, bytes.data(), bytes.size());
  Cursor in(bytes, file.name(), place);
  if (XXH3_64bits(bytes.data(), bytes.size()) != c.hash) in.fail("damaged");
  const size_t n = rows_of(k);
  std::unique_ptr<Scratch> memory = borrow();
  decode(in, n, *memory, out, at);
  give_back(std::move(memory));
  for (size_t i = at; i < at + n; ++i) {
    if (beam_fault(out, i) || fault_of(out, i)) in.fail("a row of it is no usable beam");
  }
}

std::shared_ptr<const BeamLog> Reader::State::cached(size_t k) const {
  {
    const std::lock_guard lock(mutex);
    if (last == k) return last_chunk;
  }
  auto chunk = std::make_shared<BeamLog>(empty);
  chunk->resize(rows_of(k));
  decode_chunk(k, *chunk, 0);
  const std::lock_guard lock(mutex);
  last = k;
  last_chunk = chunk;
  return chunk;
}

void Reader::read(size_t first, BeamLog& out) const {
  const State& s = *state_;
  if (out.empty()) return;
  const size_t end = first + out.size();
  require(end <= s.rows && first <= end, "compact log: no such rows");
  const size_t begin_chunk = first / s.chunk_rows;
  parallel_for((end - 1) / s.chunk_rows + 1 - begin_chunk, 1, [&](size_t i, size_t) {
    const size_t k = begin_chunk + i, chunk_begin = k * s.chunk_rows, n = s.rows_of(k);
    const size_t from = std::max(first, chunk_begin), to = std::min(end, chunk_begin + n);
    if (to - from == n) return s.decode_chunk(k, out, chunk_begin - first);
    copy_rows(*s.cached(k), from - chunk_begin, to - from, out, from - first);
  });
}

}  // namespace underbrush::compact
