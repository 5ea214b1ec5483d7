// Whatever bytes a reader gets, it must give a result or a FormatError. CMake chooses the reader by
// FUZZ_….
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

#include "io/formats.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {
namespace {

using Path = std::filesystem::path;

#if defined(FUZZ_log)
void read(const Path& path) {
  LogReader reader(path, 1000);
  for (BeamLog chunk; reader.next(chunk);) chunk.check();
}
std::string seed(const Path& folder) {
  BeamLog log;
  log.extra["small"] = std::vector<int8_t>{};
  log.resize(5);
  for (uint32_t i = 0; i < 5; ++i) log.range_m[i] = i % 2 ? kMiss : float(i + 1);
  log.info.scans = {{3, 4, {}}};
  write_log(folder / "seed", log, R"({"a":"time"})");
  return bytes_of(folder / "seed");
}
#elif defined(FUZZ_ply)
void read(const Path& path) { read_ply(path); }
std::string seed(const Path&) {
  return "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty uchar k\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2\n3 4\n5 6\n"
         "3 0 1 2\n";
}
#elif defined(FUZZ_poses)
void read(const Path& path) { read_poses(path); }
std::string seed(const Path&) { return "# t\n1 2 3 4 0 0 0 1\n2 2 3 4 0 0 1 0\n"; }
#else
void read(const Path& path) {
#if defined(FUZZ_pcd)
  Table table = read_pcd(path);
#elif defined(FUZZ_numpy)
  Table table = read_numpy(path);
#elif defined(FUZZ_csv)
  Table table = read_csv(path);
#else
  Table table = read_bin(path);
#endif
  std::map<std::string, size_t> skipped;
  scan_from_table("input", std::move(table), {}, skipped);
}
std::string seed([[maybe_unused]] const Path& folder) {
#if defined(FUZZ_pcd)
  put_bytes(folder / "ascii", sample_pcd_ascii());
  put_bytes(folder / "packed", sample_pcd_packed());
  return sample_pcd();
#elif defined(FUZZ_numpy)
  put_bytes(folder / "npz", sample_npz());
  return sample_npy();
#elif defined(FUZZ_csv)
  return "x,y,z,intensity,ring,t\n" + sample_text(',');
#else
  return sample_bin();
#endif
}
#endif

}  // namespace
}  // namespace underbrush::io

// Fills the folder of the corpus, which is the last argument, with a first file.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::filesystem::path folder = (*argv)[*argc - 1];
  underbrush::io::put_bytes(folder / "seed", underbrush::io::seed(folder));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const int file = memfd_create("fuzz", 0);
  if (file < 0 || write(file, data, size) != ssize_t(size)) abort();
  try {
    underbrush::io::read("/proc/self/fd/" + std::to_string(file));
  } catch (const underbrush::FormatError&) {
  }
  close(file);
  return 0;
}
