#include "underbrush/compact/compact_file.hpp"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <filesystem>
#include <functional>

#include "io/temporary.hpp"
#include "logs.hpp"
#include "underbrush/compact/cursor.hpp"
#include "underbrush/compact/file_layout.hpp"
#include "underbrush/compact/packed.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::compact {
namespace {

using io::TemporaryFolder;

void write(const std::filesystem::path& path, const BeamLog& log, size_t piece) {
  std::filesystem::remove(path);
  OutputFile out(path, path.string());
  Writer writer(out, log.info);
  if (piece >= log.size()) writer.write(log);
  for (size_t at = 0; piece < log.size() && at < log.size(); at += piece) {
    BeamLog part = log.like();
    part.append(log, at, std::min(log.size(), at + piece));
    writer.write(part);
  }
  writer.finish("what it is\n");
  out.close();
}

BeamLog rows_of(const Reader& reader, size_t first, size_t n) {
  BeamLog out = reader.empty();
  out.resize(n);
  reader.read(first, out);
  return out;
}

BeamLog read_all(const std::filesystem::path& path) {
  const InputFile file(path);
  const Reader reader(file);
  return rows_of(reader, 0, reader.rows());
}

TEST(CompactFile, RowsComeBackForAnyNumberOfChunks) {
  const TemporaryFolder folder;
  for (const size_t n : {size_t(1), kChunkRows - 1, kChunkRows, kChunkRows + 1, 3 * kChunkRows}) {
    const BeamLog log = random_log(n, n, n < kChunkRows);
    write(folder / "a", log, n);
    const InputFile file(folder / "a");
    EXPECT_TRUE(is_compact(file));
    const Reader reader(file);
    EXPECT_EQ(reader.rows(), n);
    EXPECT_EQ(reader.text(), "what it is\n");
    EXPECT_EQ(reader.chunks().size(), (n - 1) / kChunkRows + 1);
    expect_same_bits(log, rows_of(reader, 0, n));
  }
}

TEST(CompactFile, BytesDependOnTheRowsAlone) {
  const TemporaryFolder folder;
  const BeamLog log = scanned_log(10 * kChunkRows + 77);
  set_threads(1);
  write(folder / "whole", log, log.size());
  const std::string whole = io::bytes_of(folder / "whole");
  for (const size_t piece : {size_t(5000), kChunkRows, 9 * kChunkRows}) {
    set_threads(piece == kChunkRows ? 1 : 4);
    write(folder / "pieces", log, piece);
    EXPECT_TRUE(io::bytes_of(folder / "pieces") == whole) << piece;
    expect_same_bits(log, read_all(folder / "pieces"));
  }
  set_threads(0);
}

TEST(CompactFile, AnyRowsCanBeRead) {
  const TemporaryFolder folder;
  const BeamLog log = scanned_log(3 * kChunkRows + 100);
  write(folder / "a", log, log.size());
  const InputFile file(folder / "a");
  const Reader reader(file);
  Stream random(2);
  for (int k = 0; k < 30; ++k) {
    const size_t first = size_t(random.below(log.size()));
    const size_t n = size_t(random.below(log.size() - first + 1));
    BeamLog part = log.like();
    part.append(log, first, first + n);
    expect_same_bits(part, rows_of(reader, first, n));
  }
  EXPECT_THROW(rows_of(reader, log.size(), 1), std::invalid_argument);
}

TEST(CompactFile, TheIndexTellsTimesAndPlaces) {
  const TemporaryFolder folder;
  const BeamLog log = scanned_log(2 * kChunkRows + 9);
  write(folder / "a", log, log.size());
  const InputFile file(folder / "a");
  const Reader reader(file);
  size_t returns = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    const ChunkFacts& c = reader.chunks()[i / kChunkRows];
    ASSERT_LE(c.first_s, log.time_s[i]);
    ASSERT_GE(c.last_s, log.time_s[i]);
    ASSERT_TRUE(c.origins.contains(log.origin[i]));
    ASSERT_TRUE(!log.is_hit(i) || c.ends.contains(log.end_point(i)));
    returns += log.is_hit(i);
  }
  for (const ChunkFacts& c : reader.chunks()) returns -= c.returns;
  EXPECT_EQ(returns, 0u);
  // Boxes are as small as they can be: moved by a little, they do not contain all any more.
  Box box = reader.chunks()[0].ends;
  box.least.x() += 1e-6;
  bool all = true;
  for (size_t i = 0; i < kChunkRows; ++i) {
    all = all && (!log.is_hit(i) || box.contains(log.end_point(i)));
  }
  EXPECT_FALSE(all);
}

TEST(CompactFile, EveryDamagedByteIsRefused) {
  const TemporaryFolder folder;
  write(folder / "a", random_log(3, 4), 4);
  const std::string whole = io::bytes_of(folder / "a");
  for (size_t k = 0; k < whole.size(); ++k) {
    std::string bytes = whole;
    bytes[k] = char(bytes[k] ^ (1 << (k % 8)));
    io::put_bytes(folder / "b", bytes);
    EXPECT_THROW(read_all(folder / "b"), FormatError) << k;
  }
}

TEST(CompactFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  write(folder / "a", random_log(3, 4), 4);
  const std::string whole = io::bytes_of(folder / "a");
  for (size_t n = 0; n < whole.size(); ++n) {
    io::put_bytes(folder / "b", whole.substr(0, n));
    EXPECT_THROW(read_all(folder / "b"), FormatError) << n;
  }
}

TEST(CompactFile, TheErrorNamesTheChunk) {
  const TemporaryFolder folder;
  write(folder / "a", scanned_log(3 * kChunkRows), 3 * kChunkRows);
  std::string bytes = io::bytes_of(folder / "a");
  {
    const InputFile file(folder / "a");
    bytes[Reader(file).chunks()[1].offset + 5] ^= 1;
  }
  io::put_bytes(folder / "b", bytes);
  const InputFile file(folder / "b");
  const Reader reader(file);
  EXPECT_EQ(rows_of(reader, 0, kChunkRows).size(), kChunkRows);  // the others can be read
  try {
    rows_of(reader, 0, 3 * kChunkRows);
    FAIL();
  } catch (const FormatError& e) {
    EXPECT_EQ(e.place(), "chunk 1 of 3");
    EXPECT_EQ(e.reason(), "damaged");
  }
}

/// The same file with another index, and checksums that are right.
std::string with_index(const std::string& whole, const std::function<void(std::string&)>& change) {
  const std::string place = "index", name = "file";
  const size_t trailer_at = whole.size() - kTrailerBytes;
  Cursor trailer(std::string_view(whole).substr(trailer_at), name, place);
  const auto at = trailer.get<uint64_t>(), size = trailer.get<uint64_t>();
  std::string index(size_t(size), '\0');
  Codec codec;
  codec.inflate(std::string_view(whole).substr(size_t(at), trailer_at - size_t(at)), index,
                trailer);
  change(index);
  const std::string block(codec.deflated(index));
  std::string end;
  put(end, at);
  put(end, uint64_t(index.size()));
  put(end, uint64_t(XXH3_64bits(block.data(), block.size())));
  put(end, uint64_t(XXH3_64bits(end.data(), end.size())));
  return whole.substr(0, size_t(at)) + block + end + std::string(kEndMagic);
}

// Counts that no memory would do for are refused before any is taken.
TEST(CompactFile, AbsurdCountsAreRefused) {
  const TemporaryFolder folder;
  write(folder / "a", random_log(3, 40), 40);
  const std::string whole = io::bytes_of(folder / "a");
  io::put_bytes(folder / "b", with_index(whole, [](std::string&) {}));
  EXPECT_EQ(read_all(folder / "b").size(), 40u);
  struct Change {
    size_t at;
    uint64_t value;
    size_t bytes;
  };
  constexpr uint64_t kMany = 0xfffffff0;
  const size_t sizes_at = 24 + 8 * (1 + 2 + 1) + std::string("what it is\n").size();
  for (const Change& c :
       {Change{0, kMany << 20, 8}, Change{0, 0, 8}, Change{0, 1 << 16, 8}, Change{8, kMany, 4},
        Change{8, 0, 4}, Change{12, kMany, 4}, Change{12, 2, 4}, Change{16, kMany, 4},
        Change{20, kMany, 4}, Change{20, 9, 4}, Change{sizes_at, kMany << 30, 8},
        Change{sizes_at, 1, 8}}) {
    io::put_bytes(folder / "b", with_index(whole, [&](std::string& index) {
                    std::memcpy(index.data() + c.at, &c.value, c.bytes);
                  }));
    EXPECT_THROW(read_all(folder / "b"), FormatError) << c.at << " " << c.value;
  }
}

// A chunk of equal rows is no smaller than a 1024th of its rows in memory, or a small file could
// ask for all memory there is.
TEST(CompactFile, ExpansionIsBounded) {
  const TemporaryFolder folder;
  BeamLog log;
  log.resize(20 * kChunkRows);
  write(folder / "a", log, log.size());
  const size_t bytes = std::filesystem::file_size(folder / "a");
  EXPECT_GT(bytes * kMostExpansion, log.size() * row_bytes(log));
  EXPECT_LT(bytes, log.size() / 10);
  expect_same_bits(log, read_all(folder / "a"));
}

TEST(CompactFile, RefusesWhatALogCannotHold) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::function<void(BeamLog&)>& spoil) {
    BeamLog log = random_log(3, 40);
    spoil(log);
    EXPECT_THROW(write(folder / "a", log, 40), std::invalid_argument);
  };
  refused([](BeamLog& l) { l.range_m[7] = 0; });
  refused([](BeamLog& l) { l.range_m[7] = 1e9f; });
  refused([](BeamLog& l) { l.range_m[7] = NAN; });
  refused([](BeamLog& l) { l.intensity[7] = INFINITY; });
  refused([](BeamLog& l) { l.time_s[7] = NAN; });
  refused([](BeamLog& l) { l.direction[7] *= 2; });
  refused([](BeamLog& l) { l.origin[7].x() = 1e9; });
  refused([](BeamLog& l) { l.extra[""] = std::vector<uint8_t>(40); });
  refused([](BeamLog& l) { l.ring.pop_back(); });
}

}  // namespace
}  // namespace underbrush::compact
