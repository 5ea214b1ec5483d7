#include "underbrush/io/tiff_piece.hpp"

#include <zlib.h>

#include <vector>

namespace underbrush::io {
namespace {

enum Compression { kNone = 1, kLzw = 5, kDeflate = 8, kOldDeflate = 32946, kPackBits = 32773 };
enum Predictor { kPlain = 1, kDifference = 2, kFloating = 3 };

std::optional<std::string> inflate_piece(std::string_view stored, size_t size) {
  std::string out(size, '\0');
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(stored.data()));
  stream.avail_in = uInt(stored.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = uInt(size);
  const int end = inflate(&stream, Z_FINISH);  // What follows the samples is not looked at.
  const bool whole = stream.avail_out == 0 && (end == Z_STREAM_END || end == Z_BUF_ERROR);
  inflateEnd(&stream);
  return whole ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<std::string> unpack_bits(std::string_view stored, size_t size) {
  std::string out;
  out.reserve(size);
  for (size_t at = 0; at < stored.size() && out.size() < size;) {
    const int n = static_cast<signed char>(stored[at++]);
    if (n >= 0) {  // n + 1 bytes as they are
      if (stored.size() - at < size_t(n) + 1) return std::nullopt;
      out.append(stored, at, size_t(n) + 1);
      at += size_t(n) + 1;
    } else if (n != -128) {  // a byte, 1 - n times
      if (at == stored.size()) return std::nullopt;
      out.append(size_t(1 - n), stored[at++]);
    }
  }
  if (out.size() < size) return std::nullopt;
  out.resize(size);
  return out;
}

/// Codes of 9 to 12 bits, the highest bit first, which become longer one code early.
class LzwReader {
 public:
  explicit LzwReader(std::string_view bytes) : bytes_(bytes) {}

  std::optional<std::string> read(size_t size) {
    std::string out;
    out.reserve(size);
    bool begun = false;    // Whether there is a code since the last clearing.
    size_t before_at = 0;  // Where the text of the code before this one begins.
    while (out.size() < size) {
      const int code = next();
      if (code == kEnd) break;
      if (code == kClear) {
        entries_.clear();
        begun = false;
        continue;
      }
      const int free = free_code();
      if (code > (begun ? free : kClear)) return std::nullopt;
      const size_t begin = out.size();
      if (code < kClear) {
        out.push_back(char(code));
      } else {
        // The entry of the free code is the text before this one and the first byte of this one,
        // which stand side by side in the output.
        const Entry e =
            code < free ? entries_[size_t(code - kFirst)] : Entry{before_at, begin - before_at + 1};
        for (size_t k = 0; k < e.length; ++k) out.push_back(out[e.at + k]);
      }
      if (begun && free < kMost) entries_.push_back({before_at, begin - before_at + 1});
      begun = true;
      before_at = begin;
    }
    if (out.size() < size) return std::nullopt;
    out.resize(size);
    return out;
  }

 private:
  static constexpr int kClear = 256, kEnd = 257, kFirst = 258, kMost = 4096;
  /// A piece of the output, which an entry of the table repeats.
  struct Entry {
    size_t at, length;
  };

  int free_code() const { return kFirst + int(entries_.size()); }

  /// The next code; the end where there are no bits left.
  int next() {
    int width = 9;
    while (width < 12 && free_code() >= (1 << width) - 1) ++width;
    if (bytes_.size() * 8 - bit_ < size_t(width)) return kEnd;
    int code = 0;
    for (int k = 0; k < width; ++k, ++bit_) {
      code = code << 1 | ((static_cast<unsigned char>(bytes_[bit_ / 8]) >> (7 - bit_ % 8)) & 1);
    }
    return code;
  }

  std::string_view bytes_;
  size_t bit_ = 0;
  std::vector<Entry> entries_;
};

template <class T>
T load_at(const char* bytes, bool big_endian) {
  T value = 0;
  for (size_t k = 0; k < sizeof(T); ++k) {
    const size_t at = big_endian ? sizeof(T) - 1 - k : k;
    value = T(value | T(T(static_cast<unsigned char>(bytes[at])) << (8 * k)));
  }
  return value;
}

/// Each sample is stored as its difference from the one before it in the row.
template <class T>
void add_differences(std::string& samples, const TiffCoding& coding) {
  const size_t n = samples.size() / sizeof(T);
  T sum = 0;
  for (size_t k = 0; k < n; ++k) {
    char* at = samples.data() + k * sizeof(T);
    const T value = load_at<T>(at, coding.big_endian);
    sum = k % coding.columns ? T(sum + value) : value;
    for (size_t b = 0; b < sizeof(T); ++b) {
      at[coding.big_endian ? sizeof(T) - 1 - b : b] = char(sum >> (8 * b));
    }
  }
}

/// A row is stored as the highest bytes of all its samples, then the next ones, as differences of
/// bytes.
void join_planes(std::string& samples, const TiffCoding& coding) {
  const size_t width = size_t(coding.bits) / 8, row = coding.columns * width;
  std::string planes;
  for (size_t begin = 0; begin + row <= samples.size(); begin += row) {
    planes.assign(samples, begin, row);
    for (size_t k = 1; k < row; ++k) planes[k] = char(planes[k] + planes[k - 1]);
    for (size_t c = 0; c < coding.columns; ++c) {
      for (size_t b = 0; b < width; ++b) {
        samples[begin + c * width + (coding.big_endian ? b : width - 1 - b)] =
            planes[b * coding.columns + c];
      }
    }
  }
}

bool undo_predictor(std::string& samples, const TiffCoding& coding) {
  if (coding.predictor == kPlain) return true;
  if (coding.predictor == kFloating && coding.bits >= 32) {
    join_planes(samples, coding);
    return true;
  }
  if (coding.predictor != kDifference) return false;
  switch (coding.bits) {
    case 8:
      add_differences<uint8_t>(samples, coding);
      return true;
    case 16:
      add_differences<uint16_t>(samples, coding);
      return true;
    case 32:
      add_differences<uint32_t>(samples, coding);
      return true;
    default:
      add_differences<uint64_t>(samples, coding);
      return true;
  }
}

}  // namespace

std::string unread_compression(int compression) {
  switch (compression) {
    case kNone:
    case kLzw:
    case kDeflate:
    case kOldDeflate:
    case kPackBits:
      return "";
    case 6:
    case 7:
      return "JPEG";
    case 34887:
      return "LERC";
    case 34925:
      return "LZMA";
    case 50000:
      return "Zstandard";
    case 50001:
      return "WebP";
    default:
      return "scheme " + std::to_string(compression);
  }
}

std::optional<std::string> decode_tiff_piece(std::string_view stored, const TiffCoding& coding,
                                             size_t size) {
  std::optional<std::string> out;
  switch (coding.compression) {
    case kLzw:
      out = LzwReader(stored).read(size);
      break;
    case kDeflate:
    case kOldDeflate:
      out = inflate_piece(stored, size);
      break;
    case kPackBits:
      return unpack_bits(stored, size);
    default:
      if (stored.size() >= size) out = std::string(stored.substr(0, size));
      return out;
  }
  if (out && !undo_predictor(*out, coding)) out.reset();
  return out;
}

}  // namespace underbrush::io
