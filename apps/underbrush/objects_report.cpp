#include "objects_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace underbrush::app {
namespace {

constexpr size_t kPoor = 3;  // elements

/// Returns a line for each count that is not zero.
std::string left_out(const std::vector<std::pair<std::string, size_t>>& counts) {
  std::string text;
  for (const auto& [what, n] : counts) {
    if (n) text += fmt::format("  left out    {} {}\n", n, what);
  }
  return text;
}

std::map<elements::Class, size_t> classes_of(const primitives::MeasuredObjects& measured) {
  std::map<elements::Class, size_t> classes;
  for (const auto& o : measured.objects) ++classes[o.label];
  return classes;
}

/// Returns the number of primitives and of elements of each class.
std::map<elements::Class, std::pair<size_t, size_t>> classes_of(
    const primitives::ExtractResult& result) {
  std::map<elements::Class, std::pair<size_t, size_t>> classes;
  for (const auto& p : result.primitives) {
    ++classes[p.label].first;
    classes[p.label].second += p.model.size();
  }
  return classes;
}

}  // namespace

Json json_of(const primitives::MeasuredObjects& measured) {
  Json j;
  j["objects"] = measured.objects.size();
  for (const auto& [label, n] : classes_of(measured)) j["classes"][std::string(name(label))] = n;
  j["few_points"] = measured.few_points;
  j["off_ground"] = measured.off_ground;
  j["hits_without_instance"] = measured.without_instance;
  return j;
}

std::string text_of(const primitives::MeasuredObjects& measured) {
  std::string text = fmt::format("{} objects\n", measured.objects.size());
  for (const auto& [label, n] : classes_of(measured)) {
    text += fmt::format("  {:<19}{:>8}\n", name(label), n);
  }
  if (measured.objects.empty()) text += "  warning     nothing stands on this ground\n";
  return text +
         left_out({{"objects or cells of few points", measured.few_points},
                   {"objects off the ground", measured.off_ground},
                   {"hits of an object's class without instance", measured.without_instance}});
}

Json json_of(const primitives::ExtractResult& r) {
  Json j;
  j["primitives"] = r.primitives.size();
  j["elements"] = r.elements;
  j["elements_taken"] = r.taken;
  j["free_space"] = r.free_space;
  j["empty"] = r.empty;
  j["few_elements"] = r.few_elements;
  j["few_points"] = r.measured.few_points;
  j["off_ground"] = r.measured.off_ground;
  j["hits_without_instance"] = r.measured.without_instance;
  for (const auto& [label, n] : classes_of(r)) {
    j["classes"][std::string(name(label))] = {{"primitives", n.first}, {"elements", n.second}};
  }
  return j;
}

std::string text_of(const primitives::ExtractResult& r) {
  std::string text =
      fmt::format("{} primitives hold {} of {} elements ({:.1f} %)\n", r.primitives.size(), r.taken,
                  r.elements, 100.0 * double(r.taken) / double(std::max<size_t>(1, r.elements)));
  for (const auto& [label, n] : classes_of(r)) {
    text += fmt::format("  {:<19}{:>8}, {:.0f} elements each\n", name(label), n.first,
                        double(n.second) / double(n.first));
  }
  const auto poor = std::count_if(r.primitives.begin(), r.primitives.end(),
                                  [](const auto& p) { return p.model.size() < kPoor; });
  if (poor > 0) {
    text += fmt::format(
        "  note: {} of them have fewer than {} elements and hardly look like a plant; "
        "--min-elements leaves such out\n",
        poor, kPoor);
  }
  return text +
         left_out({{"ellipsoids of free space", r.free_space},
                   {"objects without an element", r.empty},
                   {"objects or cells of few elements", r.few_elements},
                   {"objects or cells of few points", r.measured.few_points},
                   {"objects off the ground", r.measured.off_ground},
                   {"hits of an object's class without instance", r.measured.without_instance}});
}

}  // namespace underbrush::app
