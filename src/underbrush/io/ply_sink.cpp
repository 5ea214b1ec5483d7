#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/log_rows.hpp"

namespace underbrush::io {
namespace {

constexpr size_t kEncodedRows = 4096;               // rows encoded at a time by one thread
constexpr size_t kWrittenRows = 64 * kEncodedRows;  // rows written at a time
constexpr std::array<const char*, 3> kColours = {"red", "green", "blue"};

bool has_colours(const BeamLog& log) {
  return std::all_of(kColours.begin(), kColours.end(), [&](const char* name) {
    const auto found = log.extra.find(name);
    return found != log.extra.end() && type_of(found->second) == ValueType::kU8;
  });
}

template <class T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof(T));
}

// CSIRO's reader does not know char and short, so they are written as int.
ValueType stored_type(ValueType type) {
  return type == ValueType::kI8 || type == ValueType::kI16 ? ValueType::kI32 : type;
}

class PlySink : public LogSink {
 public:
  PlySink(OutputFile& o, const LogComments& c, const LogWriterOptions& options)
      : out_(o), double_coordinates_(options.double_coordinates), comments_(c) {
    comments_.pad_range = options.limits_from_data;
  }
  void write(const BeamLog& chunk) override;
  void finish(const LogComments& completed) override;

 private:
  struct Extra {
    std::string name;
    ValueType type;
  };

  void begin(const BeamLog& first);
  void check(const BeamLog& chunk) const;
  std::string header() const;
  void encode(const BeamLog& log, size_t i, size_t n, char* rows);
  void encode_beam(const BeamLog& log, size_t i, char* row);

  OutputFile& out_;
  bool double_coordinates_;
  LogComments comments_;
  std::vector<Extra> extra_;
  size_t row_size_ = 0, rows_ = 0, header_size_ = 0;
  float alpha_scale_ = 1;
  std::unique_ptr<char[]> buffer_;
  size_t room_ = 0;  // rows that fit into the buffer
};

std::string PlySink::header() const {
  char count[32];
  std::snprintf(count, sizeof count, "%020zu", rows_);
  std::string text = "ply\nformat binary_little_endian 1.0\n" + text_from_comments(comments_) +
                     "element vertex " + count + "\n";
  const char* real = double_coordinates_ ? "double " : "float ";
  for (const char* axis : {"x", "y", "z"}) text += std::string("property ") + real + axis + "\n";
  text +=
      "property double time\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
      "property ushort ring\nproperty uint scan\nproperty uint packet\nproperty uchar flags\n"
      "property float remission\n";
  for (const Extra& e : extra_) {
    text +=
        std::string("property ") + ply_name(stored_type(e.type)) + " " + stored_name(e.name) + "\n";
  }
  return text + "end_header\n";
}

void PlySink::begin(const BeamLog& first) {
  comments_.colours = has_colours(first);
  row_size_ = (double_coordinates_ ? 24 : 12) + 8 + 12 + 4 + 2 + 4 + 4 + 1 + 4;
  for (const auto& [name, column] : first.extra) {
    if (comments_.colours && std::find(kColours.begin(), kColours.end(), name) != kColours.end()) {
      continue;
    }
    require_data(!name.empty(), "log: an extra column without a name");
    const ValueType type = type_of(column);
    extra_.push_back({name, type});
    row_size_ += size_of(stored_type(type));
    if (stored_type(type) != type) comments_.narrow[stored_name(name)] = type;
  }
  // Sensors give intensities from 0 to 1 or from 0 to 255; alpha holds 1 to 255.
  const auto brightest = std::max_element(first.intensity.begin(), first.intensity.end());
  alpha_scale_ = brightest != first.intensity.end() && *brightest <= 1 ? 255 : 1;
  const std::string text = header();
  header_size_ = text.size();
  out_.append(text.data(), text.size());
}

void PlySink::check(const BeamLog& chunk) const {
  chunk.check();
  const size_t colours = comments_.colours ? kColours.size() : 0;
  bool same =
      chunk.extra.size() == extra_.size() + colours && has_colours(chunk) == comments_.colours;
  for (const Extra& e : extra_) {
    const auto found = chunk.extra.find(e.name);
    same = same && found != chunk.extra.end() && type_of(found->second) == e.type;
  }
  require(same, "log: the chunks' extra columns differ");
}

// Encodes the columns that every log has; extra columns follow elsewhere.
void PlySink::encode_beam(const BeamLog& log, size_t i, char* row) {
  const bool hit = log.is_hit(i);
  const double range = hit ? double(log.range_m[i]) : comments_.info.max_range_m;
  const Vec3& o = log.origin[i];
  require_data(range >= kMinRange && range < kMaxCoordinate,
               "log: a range is not above 0 and finite");
  require_data(is_within(o, kMaxCoordinate) && std::isfinite(log.time_s[i]) &&
                   std::isfinite(log.intensity[i]),
               "log: an origin, time or intensity is not finite or too large");
  const Vec3 ray = stored_ray(log.direction[i], range);
  require(std::abs(ray.norm() - range) <= 1e-4 * range + 1e-6,
          "log: a direction is not of length 1");
  for (int c = 0; c < 3; ++c) {
    const double end = rounded(o[c], kOriginScale) - ray[c];
    if (double_coordinates_) {
      store(row, end);
      row += 8;
    } else {
      store(row, float(end));
      row += 4;
    }
  }
  store(row, log.time_s[i]);
  for (int c = 0; c < 3; ++c) store(row + 8 + 4 * c, float(ray[c]));
  const float shade = std::clamp(std::round(log.intensity[i] * alpha_scale_), 1.0f, 255.0f);
  const uint8_t alpha = hit ? uint8_t(shade) : uint8_t(0);
  std::memset(row + 20, alpha, 4);
  store(row + 24, log.ring[i]);
  store(row + 26, log.scan[i]);
  store(row + 30, log.packet[i]);
  store(row + 34, log.flags[i]);
  store(row + 35, log.intensity[i]);
}

void PlySink::encode(const BeamLog& log, size_t begin, size_t n, char* rows_at) {
  for (size_t i = 0; i < n; ++i) encode_beam(log, begin + i, rows_at + i * row_size_);
  const size_t time_at = double_coordinates_ ? 24 : 12;
  const auto put = [&](const auto& column, size_t offset, auto as) {
    for (size_t i = 0; i < n; ++i) {
      store(rows_at + i * row_size_ + offset, decltype(as)(column[begin + i]));
    }
  };
  if (comments_.colours) {
    for (size_t c = 0; c < kColours.size(); ++c) {
      put(std::get<std::vector<uint8_t>>(log.extra.at(kColours[c])), time_at + 20 + c, uint8_t{});
    }
  }
  size_t offset = time_at + 39;
  for (const Extra& e : extra_) {
    std::visit(
        [&](const auto& column) {
          with_type(stored_type(e.type), [&](auto zero) { put(column, offset, zero); });
        },
        log.extra.at(e.name));
    offset += size_of(stored_type(e.type));
  }
}

void PlySink::write(const BeamLog& chunk) {
  if (header_size_ == 0) begin(chunk);
  check(chunk);
  for (size_t first = 0; first < chunk.size(); first += kWrittenRows) {
    const size_t n = std::min(kWrittenRows, chunk.size() - first);
    if (n > room_) buffer_ = std::make_unique_for_overwrite<char[]>((room_ = n) * row_size_);
    parallel_for(n, kEncodedRows, [&](size_t from, size_t to) {
      encode(chunk, first + from, to - from, buffer_.get() + from * row_size_);
    });
    out_.append(buffer_.get(), n * row_size_);
  }
  rows_ += chunk.size();
}

void PlySink::finish(const LogComments& completed) {
  comments_.info = completed.info;
  const std::string text = header();
  out_.overwrite(0, text.data(), text.size());
}

}  // namespace

std::unique_ptr<LogSink> begin_ply(OutputFile& out, const LogComments& comments,
                                   const LogWriterOptions& options) {
  return std::make_unique<PlySink>(out, comments, options);
}

}  // namespace underbrush::io
