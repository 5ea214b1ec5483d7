#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "underbrush/compact/chunk.hpp"
#include "underbrush/compact/compact_file.hpp"
#include "underbrush/compact/file_layout.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::compact {
namespace {

constexpr size_t kTogether = 8;  // chunks coded at a time

void check_values(const BeamLog& log) {
  log.check();
  for (size_t i = 0; i < log.size(); ++i) {
    const char* wrong = fault_of(log, i);
    if (wrong) throw DataError(std::string("log: ") + wrong);
  }
}

bool have_same_columns(const BeamLog& a, const BeamLog& b) {
  return std::equal(a.extra.begin(), a.extra.end(), b.extra.begin(), b.extra.end(),
                    [](const auto& x, const auto& y) {
                      return x.first == y.first && x.second.index() == y.second.index();
                    });
}

ChunkFacts facts_of(const BeamLog& log, size_t begin, size_t n) {
  ChunkFacts facts;
  facts.first_s = facts.last_s = log.time_s[begin];
  for (size_t i = begin; i < begin + n; ++i) {
    facts.first_s = std::min(facts.first_s, log.time_s[i]);
    facts.last_s = std::max(facts.last_s, log.time_s[i]);
    facts.origins.add(log.origin[i]);
    if (!log.is_hit(i)) continue;
    ++facts.returns;
    facts.ends.add(log.end_point(i));
  }
  return facts;
}

}  // namespace

struct Writer::State {
  State(OutputFile& o, const LogInfo& i) : out(o), info(i) {}

  void flush();
  void code(const BeamLog& log, size_t begin, size_t end);

  OutputFile& out;
  LogInfo info;
  BeamLog pending;
  bool begun = false;
  uint64_t at = kMagic.size(), rows = 0;
  std::vector<ChunkFacts> chunks;
  std::array<Scratch, kTogether> scratch;
};

Writer::Writer(OutputFile& out, const LogInfo& info) : state_(std::make_unique<State>(out, info)) {
  out.append(kMagic.data(), kMagic.size());
}

Writer::~Writer() = default;

// Codes the rows [begin, end), at most `kTogether` chunks.
void Writer::State::code(const BeamLog& log, size_t begin, size_t end) {
  const size_t n = (end - begin + kChunkRows - 1) / kChunkRows;
  std::array<std::string, kTogether> bytes;
  std::array<ChunkFacts, kTogether> facts;
  parallel_for(n, 1, [&](size_t k, size_t) {
    const size_t first = begin + k * kChunkRows, count = std::min(kChunkRows, end - first);
    facts[k] = facts_of(log, first, count);
    bytes[k] = encoded(log, info.scans, first, count, scratch[k]);
    const size_t least = count * row_bytes(log) / kMostExpansion + 1;
    if (bytes[k].size() < least) bytes[k].resize(least, '\0');
    facts[k].size = bytes[k].size();
    facts[k].hash = XXH3_64bits(bytes[k].data(), bytes[k].size());
  });
  for (size_t k = 0; k < n; ++k) {
    out.append(bytes[k].data(), bytes[k].size());
    facts[k].offset = at;
    at += facts[k].size;
    chunks.push_back(facts[k]);
  }
  rows += end - begin;
}

void Writer::State::flush() {
  if (pending.empty()) return;
  code(pending, 0, pending.size());
  pending = pending.like();
}

void Writer::write(const BeamLog& rows) {
  State& s = *state_;
  if (rows.empty()) return;
  check_values(rows);
  if (!s.begun) s.pending = rows.like();
  s.begun = true;
  require(have_same_columns(rows, s.pending), "log: the chunks' extra columns differ");
  require_data(rows.extra.size() <= kMostColumns, "log: too many extra columns");
  constexpr size_t kWhole = kTogether * kChunkRows;
  for (size_t at = 0; at < rows.size();) {
    const size_t rest = rows.size() - at;
    const size_t n = std::min(rest, kWhole - s.pending.size());
    if (n == kWhole) {
      s.code(rows, at, at + n);
    } else {
      s.pending.append(rows, at, at + n);
      if (s.pending.size() == kWhole) s.flush();
    }
    at += n;
  }
}

void Writer::finish(const std::string& text) {
  State& s = *state_;
  s.flush();
  std::string index;
  put(index, uint64_t(s.rows));
  put(index, uint32_t(kChunkRows));
  put(index, uint32_t(s.chunks.size()));
  put(index, uint32_t(text.size()));
  put(index, uint32_t(s.pending.extra.size()));
  for (const auto& [name, column] : s.pending.extra) {
    require_data(!name.empty() && name.size() <= kMostNameBytes,
                 "log: the name of an extra column is empty or too long");
    put(index, uint8_t(column.index()));
    put(index, uint16_t(name.size()));
    index += name;
  }
  index += text;
  for (const ChunkFacts& c : s.chunks) {
    put(index, c.size);
    put(index, c.hash);
    put(index, c.returns);
    put(index, c.first_s);
    put(index, c.last_s);
    for (const Box* box : {&c.ends, &c.origins}) {
      for (const Vec3* corner : {&box->least, &box->most}) {
        for (const double x : *corner) put(index, x);
      }
    }
  }
  require_data(index.size() <= kMostIndexBytes, "log: its scans and notes take too much room");
  const std::string block(s.scratch[0].codec.deflated(index));
  std::string trailer;
  put(trailer, s.at);
  put(trailer, uint64_t(index.size()));
  put(trailer, uint64_t(XXH3_64bits(block.data(), block.size())));
  put(trailer, uint64_t(XXH3_64bits(trailer.data(), trailer.size())));
  trailer += kEndMagic;
  s.out.append(block.data(), block.size());
  s.out.append(trailer.data(), trailer.size());
}

}  // namespace underbrush::compact
