#include "underbrush/io/gzip.hpp"

#include <zlib.h>

#include <fstream>
#include <memory>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {

bool is_gzip(const std::filesystem::path& path) {
  return lower(path.extension().string()) == ".gz";
}

Unpacked::Unpacked(const std::filesystem::path& packed)
    : temporary_(std::filesystem::temp_directory_path(), packed.stem().string()) {
  const std::filesystem::path folder = path().parent_path();
  const uint64_t most = std::filesystem::space(folder).available / 2;
  const InputFile opened(packed);  // Says what is wrong with a file that cannot be opened.
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(packed.c_str(), "rb"), gzclose_r);
  if (!in) throw FormatError(packed.string(), "", "cannot be opened");
  std::ofstream out(path(), std::ios::binary);
  std::vector<char> piece(size_t(1) << 20);
  uint64_t size = 0;
  for (int n = 0; (n = gzread(in.get(), piece.data(), unsigned(piece.size()))) > 0;) {
    if (gzdirect(in.get())) throw FormatError(packed.string(), "header", "is no file of gzip");
    size += uint64_t(n);
    if (size > most) {
      throw IoError(packed.string() +
                    ": its content would take more than half of the room that is free in " +
                    folder.parent_path().string() + "; TMPDIR names another folder");
    }
    if (!out.write(piece.data(), n)) break;
  }
  int error = Z_OK;
  gzerror(in.get(), &error);
  if (error != Z_OK)
    throw FormatError(packed.string(), "", "a damaged file of gzip, or one that is cut off");
  out.close();
  if (!out) throw IoError(path().string() + ": cannot be written");
}

}  // namespace underbrush::io
