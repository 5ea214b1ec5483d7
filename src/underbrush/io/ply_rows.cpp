#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/log_rows.hpp"

namespace underbrush::io {
namespace {

constexpr size_t kDecodedRows = 4096;  // rows decoded at a time by one thread

/// Place and type of a value in a row.
struct Field {
  size_t offset = 0;
  ValueType type = ValueType::kF32;
};

double real(const char* row, const Field& field) {
  return field.type == ValueType::kF64 ? load<double>(row + field.offset)
                                       : double(load<float>(row + field.offset));
}

template <class T>
void read_column(const char* rows, size_t row_size, size_t n, const Field& field, T* out) {
  with_type(field.type, [&](auto zero) {
    const char* at = rows + field.offset;
    for (size_t i = 0; i < n; ++i, at += row_size) {
      out[i] = T(load<decltype(zero)>(at));  // NOLINT(bugprone-signed-char-misuse): signed is meant
    }
  });
}

class PlyRows : public LogRows {
 public:
  explicit PlyRows(const std::filesystem::path& path)
      : input_(path), header_(read_ply_header(input_)) {
    comments = comments_from_header(input_.name(), header_);
    check_shape();
    find_columns();
    if (!comments.ours) look_through();
  }

  const std::string& file() const override { return input_.name(); }
  size_t size() const override { return rows_; }
  const BeamLog& empty() const override { return none_; }
  void read(size_t first, BeamLog& out, std::vector<uint8_t>& fault) const override;

 private:
  void check_shape();
  void find_columns();
  void look_through();
  std::optional<Field> take(const std::string& name, bool (*fits)(ValueType));
  void decode(const char* rows, size_t first, size_t n, BeamLog& out, uint8_t* fault) const;
  uint8_t decode_ray(const char* row, BeamLog& out, size_t i) const;

  InputFile input_;
  PlyHeader header_;
  BeamLog none_;
  size_t rows_ = 0, row_size_ = 0;
  std::map<std::string, Field> unclaimed_;
  std::array<Field, 3> end_, ray_;
  Field time_;
  std::optional<Field> alpha_, ring_, scan_, packet_, flags_, remission_;
  std::vector<Field> extra_;  // in the order of the log's columns
};

void PlyRows::check_shape() {
  const auto fail = [&](const std::string& place, const std::string& reason) {
    throw FormatError(input_.name(), place, reason);
  };
  if (header_.format != PlyHeader::Format::kLittle) {
    fail("header", "a ray cloud must be binary_little_endian");
  }
  if (header_.elements.size() != 1 || header_.elements[0].name != "vertex" ||
      header_.elements[0].has_list()) {
    fail("header", "a ray cloud must have the element 'vertex' only, without lists");
  }
  rows_ = size_t(header_.elements[0].count);
  row_size_ = header_.elements[0].row_size();
  if (rows_ == 0) fail("element vertex", "an empty log: no beams");
  const uint64_t expected = header_.body + uint64_t(rows_) * row_size_;
  if (input_.size() != expected) {
    fail("byte " + std::to_string(expected), "bytes after the last row");
  }
}

std::optional<Field> PlyRows::take(const std::string& name, bool (*fits)(ValueType)) {
  const auto found = unclaimed_.find(name);
  if (found == unclaimed_.end() || !fits(found->second.type)) return std::nullopt;
  const Field field = found->second;
  unclaimed_.erase(found);
  return field;
}

void PlyRows::find_columns() {
  size_t offset = 0;
  for (const PlyProperty& p : header_.elements[0].properties) {
    unclaimed_[p.name] = {offset, p.type};
    offset += size_of(p.type);
  }
  const auto is_real = [](ValueType t) { return t >= ValueType::kF32; };
  const auto is_u8 = [](ValueType t) { return t == ValueType::kU8; };
  const auto to_u16 = [](ValueType t) { return t <= ValueType::kU16; };
  const auto to_u32 = [](ValueType t) { return t <= ValueType::kU32; };
  const auto needed = [&](const std::string& name) {
    const auto field = take(name, is_real);
    if (!field) {
      throw FormatError(input_.name(), "header",
                        "no float or double '" + name + "': not a ray cloud");
    }
    return *field;
  };
  const std::string prefix = unclaimed_.count("rayx") ? "ray" : "n";
  for (int c = 0; c < 3; ++c) {
    const char axis = char('x' + c);
    end_[size_t(c)] = needed(std::string(1, axis));
    ray_[size_t(c)] = needed(prefix + axis);
  }
  time_ = needed("time");
  alpha_ = take("alpha", is_u8);
  ring_ = take("ring", to_u16);
  scan_ = take("scan", to_u32);
  packet_ = take("packet", to_u32);
  if (comments.ours) {
    flags_ = take("flags", is_u8);
    remission_ = take("remission", is_real);
    if (!comments.colours) {
      for (const char* colour : {"red", "green", "blue"}) take(colour, is_u8);
    }
  }
  std::map<std::string, Field> places;
  for (const auto& [stored, field] : unclaimed_) {
    const auto narrow = comments.narrow.find(stored);
    const ValueType type = narrow == comments.narrow.end() ? field.type : narrow->second;
    const std::string name = comments.ours ? name_from_stored(stored) : stored;
    none_.extra[name] = column_of(type);
    places[name] = field;
  }
  for (const auto& entry : places) extra_.push_back(entry.second);
  if (!none_.extra.contains("class")) comments.info.classes.clear();
}

// Finds the maximum range and whether there are misses, which the ray clouds of other programs do
// not say.
void PlyRows::look_through() {
  // Normals are rounded to as few as 8 bits, and shorter where some were averaged.
  constexpr double kLongestNormal = 1.01, kAveraged = 0.7, kMost = 0.9;
  const size_t pieces = (rows_ + kDecodedRows - 1) / kDecodedRows;
  std::vector<double> longest(pieces, 0);
  std::vector<uint8_t> misses(pieces, 0);
  std::vector<size_t> unit(pieces, 0), none(pieces, 0);  // rays of about 1 m; without a length
  parallel_for(rows_, kDecodedRows, [&](size_t begin, size_t finish) {
    std::vector<char> bytes((finish - begin) * row_size_);
    input_.read(header_.body + uint64_t(begin) * row_size_, bytes.data(), bytes.size());
    for (const char* row = bytes.data(); row != bytes.data() + bytes.size(); row += row_size_) {
      const double length = Vec3(real(row, ray_[0]), real(row, ray_[1]), real(row, ray_[2])).norm();
      if (!(length < kMaxCoordinate)) continue;
      longest[begin / kDecodedRows] = std::max(longest[begin / kDecodedRows], length);
      unit[begin / kDecodedRows] += length > kAveraged;
      none[begin / kDecodedRows] += length < kMinRange;
      if (alpha_ && row[alpha_->offset] == 0) misses[begin / kDecodedRows] = 1;
    }
  });
  comments.info.max_range_m = *std::max_element(longest.begin(), longest.end());
  comments.info.has_misses = *std::max_element(misses.begin(), misses.end()) != 0;
  comments.info.deskewed = true;  // every ray has its own origin
  if (!(comments.info.max_range_m > 0)) {
    throw FormatError(input_.name(), "element vertex", "no ray has a length");
  }
  constexpr size_t kEnough = 20;
  const size_t unit_rays = std::accumulate(unit.begin(), unit.end(), size_t(0));
  const size_t rays = rows_ - std::accumulate(none.begin(), none.end(), size_t(0));
  if (rays >= kEnough && double(unit_rays) > kMost * double(rays) &&
      comments.info.max_range_m < kLongestNormal) {
    throw FormatError(input_.name(), "element vertex",
                      "nx ny nz are all about 1 m long: they are normals, not rays to the sensor; "
                      "--format scan reads the points, with --poses");
  }
}

uint8_t PlyRows::decode_ray(const char* row, BeamLog& out, size_t i) const {
  const Vec3 point(real(row, end_[0]), real(row, end_[1]), real(row, end_[2]));
  const Vec3 back(real(row, ray_[0]), real(row, ray_[1]), real(row, ray_[2]));
  const double length = back.norm(), t = real(row, time_);
  out.time_s[i] = t;
  out.origin[i] = point + back;
  const bool hit = !alpha_ || row[alpha_->offset] != 0;
  out.range_m[i] = hit ? float(length) : kMiss;
  out.intensity[i] = remission_ ? float(real(row, *remission_))
                     : alpha_   ? float(uint8_t(row[alpha_->offset]))
                                : 0;
  if (!std::isfinite(length) || !std::isfinite(t) || !point.allFinite() ||
      !std::isfinite(out.intensity[i])) {
    return kNotFinite;
  }
  if (length < kMinRange) return kZeroLength;
  // What a log cannot hold must not come out of one either.
  if (!(length < kMaxCoordinate && is_within(out.origin[i], kMaxCoordinate))) {
    return kTooLarge;
  }
  // A miss in a log of ours is exactly as long as the maximum range; its stored length differs only
  // by rounding.
  const double max = comments.info.max_range_m;
  const bool exact = comments.ours && !hit && std::abs(length - max) < 1e-6 * max;
  out.direction[i] = (back * (-1 / (exact ? max : length))).cast<float>();
  return kNoFault;
}

void PlyRows::decode(const char* rows_at, size_t first, size_t n, BeamLog& out,
                     uint8_t* fault) const {
  for (size_t i = 0; i < n; ++i) {
    fault[first + i] = decode_ray(rows_at + i * row_size_, out, first + i);
  }
  const auto column = [&](const std::optional<Field>& field, auto& to) {
    if (field) read_column(rows_at, row_size_, n, *field, to.data() + first);
  };
  column(ring_, out.ring);
  column(scan_, out.scan);
  column(packet_, out.packet);
  column(flags_, out.flags);
  auto to = out.extra.begin();
  for (const Field& field : extra_) {
    std::visit([&](auto& c) { read_column(rows_at, row_size_, n, field, c.data() + first); },
               to++->second);
  }
}

void PlyRows::read(size_t begin, BeamLog& out, std::vector<uint8_t>& fault) const {
  if (!ring_) std::fill(out.ring.begin(), out.ring.end(), 0);
  if (!scan_) std::fill(out.scan.begin(), out.scan.end(), 0);
  if (!packet_) std::fill(out.packet.begin(), out.packet.end(), 0);
  if (!flags_) std::fill(out.flags.begin(), out.flags.end(), 0);
  parallel_for(out.size(), kDecodedRows, [&](size_t first, size_t last) {
    const size_t size = (last - first) * row_size_;
    const auto bytes = std::make_unique_for_overwrite<char[]>(size);
    input_.read(header_.body + uint64_t(begin + first) * row_size_, bytes.get(), size);
    decode(bytes.get(), first, last - first, out, fault.data());
  });
}

}  // namespace

std::unique_ptr<LogRows> open_ply_rows(const std::filesystem::path& path) {
  return std::make_unique<PlyRows>(path);
}

}  // namespace underbrush::io
