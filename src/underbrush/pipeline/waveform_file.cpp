#include "underbrush/pipeline/waveform_file.hpp"

#include <algorithm>
#include <bit>
#include <string>

namespace underbrush::pipeline {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void put(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

constexpr size_t kCountAt = 8;  // bytes

}  // namespace

WaveformFile::WaveformFile(const std::filesystem::path& path)
    : atomic_(path), file_(atomic_.temporary(), path.string()) {
  std::string header = "UBWAVES1";
  put(header, uint64_t(0));
  file_.append(header.data(), header.size());
}

void WaveformFile::append(const std::vector<simulate::BeamWaveform>& waveforms) {
  std::string bytes;
  for (const simulate::BeamWaveform& w : waveforms) {
    put(bytes, uint64_t(w.beam));
    put(bytes, w.time_s);
    put(bytes, w.scan);
    put(bytes, w.ring);
    put(bytes, uint16_t(std::min<size_t>(w.echo_m.size(), UINT16_MAX)));
    put(bytes, uint32_t(w.signal.size()));
    put(bytes, uint32_t(0));
    for (const auto& [range_m, signal] : w.signal) {
      put(bytes, float(range_m));
      put(bytes, float(signal));
    }
    for (const double range_m : w.echo_m) put(bytes, float(range_m));
  }
  file_.append(bytes.data(), bytes.size());
  beams_ += waveforms.size();
}

void WaveformFile::close() {
  file_.overwrite(kCountAt, &beams_, sizeof beams_);
  file_.close();
  atomic_.commit();
}

}  // namespace underbrush::pipeline
