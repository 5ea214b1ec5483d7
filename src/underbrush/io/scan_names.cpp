#include "underbrush/io/scan_names.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/io/gzip.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr double kEarliest = 1e8, kLatest = 4.2e9;  // s since 1970

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The digits of a name, run by run.
std::vector<std::string_view> runs_of(std::string_view name) {
  std::vector<std::string_view> runs;
  for (size_t at = 0; at < name.size();) {
    size_t end = at;
    while (end < name.size() && is_digit(name[end])) ++end;
    if (end > at) runs.push_back(name.substr(at, end - at));
    at = std::max(end, at + 1);
  }
  return runs;
}

std::string_view without_zeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

std::optional<uint32_t> number_of_frame(std::string_view digits) {
  const std::string_view value = without_zeros(digits);
  if (digits.empty() || value.size() > 9) return std::nullopt;
  return value.empty() ? 0 : uint32_t(std::stoul(std::string(value)));
}

bool is_frame_number(const std::string& stem) {
  return std::ranges::all_of(stem, is_digit) && number_of_frame(stem);
}

/// The time in a name: seconds, and behind "_" or "-" digits of a unit that is to be found.
struct NamedTime {
  double seconds = 0;
  std::string_view fraction;
  const char* unit = "";  ///< Named where the time is one number that is not in ns.
};

std::optional<NamedTime> time_in(const std::string& stem) {
  const std::vector<std::string_view> runs = runs_of(stem);
  const auto value = [](std::string_view digits) { return std::stod(std::string(digits)); };
  for (size_t k = runs.size(); k-- > 0;) {
    const std::string_view digits = runs[k];
    const size_t n = digits.size(), end = size_t(digits.data() - stem.data()) + n;
    const double number = n < 20 ? value(digits) : 0;
    const auto is_date = [](double s) { return s >= kEarliest && s < kLatest; };
    if ((n == 18 || n == 19) && is_date(number * 1e-9)) return NamedTime{number * 1e-9, {}, ""};
    if (n == 16 && is_date(number * 1e-6)) return NamedTime{number * 1e-6, {}, "µs"};
    if (n == 13 && is_date(number * 1e-3)) return NamedTime{number * 1e-3, {}, "ms"};
    if (n == 10 && is_date(number) && end == stem.size()) return NamedTime{number, {}, "s"};
    const bool joined = k + 1 < runs.size() && runs[k + 1].data() == digits.data() + n + 1;
    if ((n != 9 && n != 10) || !joined || !(is_date(number) || runs.size() == 2)) continue;
    if (stem[end] == '.') {
      return NamedTime{value(std::string(digits) + "." + std::string(runs[k + 1])), {}, ""};
    }
    if ((stem[end] == '_' || stem[end] == '-') && runs[k + 1].size() <= 9) {
      return NamedTime{number, runs[k + 1], ""};
    }
  }
  return std::nullopt;
}

std::vector<std::string> stems_of(const std::vector<ScanFile>& files) {
  std::vector<std::string> stems(files.size());
  for (size_t i = 0; i < files.size(); ++i) stems[i] = scan_stem(files[i].path);
  return stems;
}

/// Gives the files the times in their names. Returns the unit that was taken, if it is not ns.
std::string give_times(std::vector<ScanFile>& files) {
  const std::vector<std::string> stems = stems_of(files);
  size_t longest = 0;
  std::vector<std::optional<NamedTime>> times;
  times.reserve(stems.size());
  std::string unit;
  for (const std::string& stem : stems) {
    times.push_back(is_frame_number(stem) ? std::nullopt : time_in(stem));
    if (!times.back()) continue;
    longest = std::max(longest, times.back()->fraction.size());
    unit = times.back()->unit;
  }
  // Fewer than three digits do not determine the unit.
  const double scale = longest > 6 ? 1e-9 : longest > 3 ? 1e-6 : longest == 3 ? 1e-3 : NAN;
  if (longest >= 3 && longest <= 6) unit = longest == 3 ? "s and ms" : "s and µs";
  for (size_t i = 0; i < files.size(); ++i) {
    if (!times[i]) continue;
    const std::string_view digits = without_zeros(times[i]->fraction);
    const double fraction = digits.empty() ? 0 : std::stod(std::string(digits)) * scale;
    if (std::isfinite(fraction)) files[i].time_s = times[i]->seconds + fraction;
  }
  return unit;
}

/// Whether a name stands before another in the order of the numbers in them. Digits behind a
/// decimal point are those of a fraction.
bool is_before(const std::string& a, const std::string& b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    std::string_view x = runs_of(std::string_view(a).substr(i))[0],
                     y = runs_of(std::string_view(b).substr(j))[0];
    const bool fraction = i > 1 && a[i - 1] == '.' && is_digit(a[i - 2]);
    i += x.size(), j += y.size();
    if (!fraction) {
      x = without_zeros(x), y = without_zeros(y);
      if (x.size() != y.size()) return x.size() < y.size();
    }
    if (x != y) return x < y;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;
}

/// Which names are alike: those with the same characters but for digits.
std::string kind_of(const ScanFile& file) {
  const std::string stem = scan_stem(file.path);
  if (is_frame_number(stem)) return "";
  std::string kind;
  for (const char c : stem) {
    if (!is_digit(c)) kind += c;
    if (is_digit(c) && !kind.ends_with('0')) kind += '0';
  }
  return kind;
}

std::string name_of(const ScanFile& file) { return file.path.filename().string(); }

/// Leaves out the files whose names are unlike those of most: a map, a copy, a calibration.
void leave_out_others(const fs::path& folder, std::vector<ScanFile>& files,
                      std::vector<std::string>& notes) {
  constexpr size_t kFew = 2;  // files that may be left out of scans whose names are no numbers
  std::map<std::string, size_t> kinds;
  for (const ScanFile& file : files) ++kinds[kind_of(file)];
  const auto most = std::ranges::max_element(kinds, {}, [](const auto& k) { return k.second; });
  const size_t others = files.size() - most->second;
  if (others == 0) return;
  const auto is_other = [&](const ScanFile& file) { return kind_of(file) != most->first; };
  const bool numbered = kinds.contains(""), mostly = most->second > others;
  if (numbered && !(mostly && most->first.empty())) {
    const auto number = std::ranges::find(files, std::string(), kind_of);
    const auto name = std::ranges::find_if(files, [](const auto& f) { return kind_of(f) != ""; });
    throw FormatError(folder.string(), "",
                      "the names of some scans are numbers (" + name_of(*number) +
                          "), those of others are not (" + name_of(*name) +
                          "): leave in the folder what belongs together");
  }
  const auto scan = std::ranges::find_if_not(files, is_other);
  const bool told = numbered || scan->time_s;
  if (!mostly || (!told && (most->second <= kFew || others > kFew))) return;
  std::string names;
  size_t named = 0;
  for (const ScanFile& file : files) {
    if (is_other(file) && named++ < 3) names += (named > 1 ? ", " : "") + name_of(file);
  }
  if (named > 3) names += " and " + std::to_string(named - 3) + " more";
  notes.push_back("left out of the folder, with names unlike those of the " +
                  std::to_string(most->second) + " scans (" + name_of(*scan) + "): " + names);
  std::erase_if(files, is_other);
}

/// Sets `number` where one number alone differs from name to name.
void find_numbers(std::vector<ScanFile>& files) {
  const std::vector<std::string> stems = stems_of(files);
  const size_t runs = runs_of(stems[0]).size();
  std::optional<size_t> differs;
  if (files.size() == 1 && runs == 1) differs = 0;
  for (const std::string& stem : stems) {
    const auto own = runs_of(stem), first = runs_of(stems[0]);
    if (own.size() != runs) return;
    for (size_t k = 0; k < runs; ++k) {
      if (own[k] == first[k]) continue;
      if (differs && *differs != k) return;
      differs = k;
    }
  }
  if (!differs) return;
  for (size_t i = 0; i < files.size(); ++i) {
    files[i].number = number_of_frame(runs_of(stems[i])[*differs]);
  }
}

}  // namespace

std::string scan_stem(const fs::path& path) {
  return (is_gzip(path) ? path.stem() : path).stem().string();
}

ScanFile scan_file(const fs::path& path) {
  const std::string stem = scan_stem(path);
  std::vector<ScanFile> file(1);
  file[0].path = path;
  if (is_frame_number(stem)) file[0].frame = *number_of_frame(stem);
  give_times(file);
  if (!is_frame_number(stem) && !file[0].time_s) find_numbers(file);
  return file[0];
}

std::vector<ScanFile> list_scans(const fs::path& folder, std::vector<std::string>& notes) {
  std::vector<ScanFile> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    if (path.filename().string().starts_with('.')) continue;
    const std::string ext = lower((is_gzip(path) ? path.stem() : path).extension().string());
    if (ext == ".ply" || ext == ".pcd" || ext == ".bin" || ext == ".npy" || ext == ".npz") {
      files.push_back(scan_file(path));
    }
  }
  if (error) throw FormatError(folder.string(), "", error.message());
  if (files.empty()) {
    const bool recording = fs::exists(folder / "metadata.yaml", error);
    throw FormatError(folder.string(), "",
                      recording ? kRecording : "no scans in it (.ply .pcd .bin .npy .npz)");
  }
  std::ranges::sort(files, [](const auto& a, const auto& b) {
    return is_before(a.path.filename().string(), b.path.filename().string());
  });
  leave_out_others(folder, files, notes);
  const std::string unit = give_times(files);
  if (!unit.empty()) notes.push_back("the times in the scans' names are taken to be in " + unit);
  if (kind_of(files[0]).empty()) {
    std::ranges::stable_sort(files, {}, &ScanFile::frame);
    for (size_t i = 1; i < files.size(); ++i) {
      if (files[i].frame != files[i - 1].frame) continue;
      throw FormatError(files[i].path.string(), "",
                        "the number of another scan, " + name_of(files[i - 1]));
    }
    return files;
  }
  for (size_t i = 0; i < files.size(); ++i) files[i].frame = uint32_t(i);
  if (!files[0].time_s) find_numbers(files);
  return files;
}

}  // namespace underbrush::io
