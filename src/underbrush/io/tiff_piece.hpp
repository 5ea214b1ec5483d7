/// \file
/// Compression of the strips and tiles of TIFF files.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace underbrush::io {

/// The coding of the pieces of a file, which are strips or tiles, with one sample per cell.
struct TiffCoding {
  int compression = 1;      ///< Tag 259.
  int predictor = 1;        ///< Tag 317.
  int bits = 8;             ///< Bits of a sample: 8, 16, 32 or 64.
  size_t columns = 0;       ///< Samples in a row of a piece.
  bool big_endian = false;  ///< Order of the file's bytes.
};

/// The name of a compression that is not read, such as "JPEG"; empty for those that are.
std::string unread_compression(int compression);

/// Returns the `size` bytes of samples of a piece in the file's order of bytes: none, LZW, deflate
/// and PackBits are undone, then the predictor of LZW and deflate (TIFF 6.0 sections 9, 13 and 14;
/// floating point as in Adobe's technical note 3). `size` must be a whole number of rows. Returns
/// nothing where the piece is damaged, or holds less.
std::optional<std::string> decode_tiff_piece(std::string_view stored, const TiffCoding& coding,
                                             size_t size);

}  // namespace underbrush::io
