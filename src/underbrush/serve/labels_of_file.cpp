#include "underbrush/serve/labels_of_file.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/perception/objects.hpp"
#include "underbrush/primitives/measure.hpp"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/serve/label_sets.hpp"

namespace underbrush::serve {
namespace {

constexpr uint64_t kHashed = 65536;  // bytes at each end of a file

// Size of a file and a hash of its first and last bytes, which stay equal when it is copied.
std::string contents_of(const std::filesystem::path& path) {
  const InputFile file(path);
  uint64_t hash = file.size();
  std::string bytes(size_t(std::min(kHashed, file.size())), '\0');
  for (const uint64_t at : {uint64_t(0), file.size() - bytes.size()}) {
    file.read(at, bytes.data(), bytes.size());
    for (const char c : bytes) hash = mix64(hash ^ (uint64_t(uint8_t(c)) + 0x9e3779b97f4a7c15ull));
  }
  return std::to_string(file.size()) + "-" + std::to_string(hash);
}

std::string journal_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name + ".labels";
}

}  // namespace

LabelsOfFile::LabelsOfFile(OpenedFile file, LogData* log, std::filesystem::path folder)
    : file_(std::move(file)), log_(log), folder_(std::move(folder)) {}

LabelDocument& LabelsOfFile::document() {
  if (document_) return *document_;
  LabelFacts facts{file_.name, "underbrush", 0, ""};
  std::vector<uint32_t> first;
  size_t nodes = 0;
  const std::filesystem::path journal = folder_ / journal_name(file_.name);
  if (log_) {
    octree_ = log_->octree();
    require(octree_ != nullptr, "the octree is not ready");
    cubes_ = std::make_unique<NodeCubes>(*octree_);
    const std::string set = io::open_input(file_.path).beams->info().classes;
    if (!elements::labels_of(set).empty()) facts.set = set;
    facts.rows = cubes_->rows;
    facts.contents = contents_of(file_.path);
    nodes = octree_->nodes().size();
    if (!std::filesystem::exists(journal)) first = base(facts.set, facts.rows);
  }
  document_ = std::make_unique<LabelDocument>(journal, facts, first, nodes);
  return *document_;
}

std::vector<uint32_t> LabelsOfFile::base(const std::string& set, uint64_t rows) const {
  const io::Input input = io::open_input(file_.path);
  std::vector<uint32_t> out;
  for (BeamLog chunk; input.beams->next(chunk);) {
    const auto label = chunk.extra.find("class"), instance = chunk.extra.find("instance");
    const bool none = label == chunk.extra.end() && instance == chunk.extra.end();
    if (none) return {};
    for (size_t i = 0; i < chunk.size(); ++i) {
      LabelValue value;
      if (chunk.is_hit(i) && label != chunk.extra.end()) {
        value.label = place_in_set(set, whole_number(label->second, i)).value_or(0);
      }
      if (chunk.is_hit(i) && instance != chunk.extra.end()) {
        const uint32_t number = whole_number(instance->second, i);
        if (number <= kMostInstance) value.instance = number;
      }
      out.push_back(value.bits());
    }
  }
  require(out.size() == rows, "the log has changed since its octree was built");
  return out;
}

void LabelsOfFile::know(uint64_t revision) {
  const uint64_t now = document().revision();
  if (revision != now) throw LabelConflict(now);
}

std::string LabelsOfFile::state(uint64_t since) {
  const std::lock_guard lock(mutex_);
  const LabelDocument& d = document();
  Json j{{"revision", d.revision()},
         {"undos", d.undos()},
         {"redos", d.redos()},
         {"last", printable(d.last_name())},
         {"next", printable(d.next_name())},
         {"set", d.facts().set},
         {"journal", printable((folder_ / journal_name(file_.name)).string())},
         {"journal_bytes", d.journal().bytes()},
         {"lost_bytes", d.journal().lost_bytes()},
         {"selected", d.selected()},
         {"next_instance", d.next_instance()}};
  const uint64_t misses = octree_ ? cubes_->rows - octree_->header().points : 0;
  j["classes"] = Json::array();
  uint32_t place = 0;
  for (const elements::Label& label : elements::labels_of(d.facts().set)) {
    const uint64_t n = d.counts()[place] - (place == 0 ? std::min(misses, d.counts()[0]) : 0);
    j["classes"].push_back({{"number", label.number}, {"name", label.name}, {"points", n}});
    ++place;
  }
  j["nodes"] = d.nodes_since(since);
  j["boxes"] = Json::array();
  for (const auto& [number, text] : d.boxes()) {
    Json box{{"number", number}};
    box.update(Json::parse(text));
    j["boxes"].push_back(box);
  }
  return text_of(j);
}

std::string LabelsOfFile::values_of(const std::vector<uint32_t>& nodes) {
  const std::lock_guard lock(mutex_);
  const std::vector<uint32_t>& values = document().values();
  require(octree_ != nullptr, "this file has no points");
  std::string bytes;
  std::vector<uint32_t> rows;
  for (const uint32_t k : nodes) {
    require(k < octree_->nodes().size(), "no such node");
    const OctreeNode& node = octree_->nodes()[k];
    require(bytes.size() + 4ull * node.points <= size_t(16) << 20, "more than 16 MiB of labels");
    rows.resize(node.points);
    octree_->read(node.at + 20ull * node.points, rows.data(), 4 * rows.size());
    for (uint32_t& row : rows) row = row < values.size() ? values[row] : 0;
    bytes.append(reinterpret_cast<const char*>(rows.data()), 4 * rows.size());
  }
  return bytes;
}

std::string LabelsOfFile::instances() {
  const std::lock_guard lock(mutex_);
  std::map<uint32_t, std::map<uint32_t, uint64_t>> found;
  std::pair<uint32_t, uint64_t*> last{0, nullptr};  // rows of an instance often follow each other
  for (const uint32_t bits : document().values()) {
    const uint32_t value = bits & ~128u;
    if (value < 256) continue;
    if (!last.second || last.first != value) last = {value, &found[value >> 8][value & 127]};
    ++*last.second;
  }
  Json j = Json::array();
  for (const auto& [instance, classes] : found) {
    uint64_t points = 0;
    for (const auto& [label, n] : classes) points += n;
    const auto most = std::max_element(classes.begin(), classes.end(),
                                       [](auto& a, auto& b) { return a.second < b.second; });
    j.push_back({{"instance", instance},
                 {"class", most->first},
                 {"classes", classes.size()},
                 {"points", points}});
  }
  return text_of(j);
}

std::string LabelsOfFile::count(const Selection& selection) {
  const std::lock_guard lock(mutex_);
  const std::vector<uint32_t>& values = document().values();
  require(octree_ != nullptr, "this file has no points");
  const FoundRows found = find_rows(*octree_, *cubes_, selection, values);
  std::array<uint64_t, kMostClasses> classes{};
  uint64_t points = 0;
  for (uint32_t row = 0; row < values.size(); ++row) {
    if (!found.rows.has(row) || !selection.admits(LabelValue::of(values[row]))) continue;
    ++classes[LabelValue::of(values[row]).label];
    ++points;
  }
  Json j{{"revision", document().revision()}, {"points", points}};
  j["classes"] = Json::array();
  for (uint32_t k = 0; k < kMostClasses; ++k) {
    if (classes[k] > 0) j["classes"].push_back({{"class", k}, {"points", classes[k]}});
  }
  j["histogram"] = Json::parse(histogram_of(*octree_, *cubes_, found, selection, values));
  return text_of(j);
}

EditResult LabelsOfFile::apply(const LabelChange& change) {
  EditResult out;
  out.rows = change.size();
  document_->change(change);
  out.revision = document_->revision();
  return out;
}

EditResult LabelsOfFile::edit(uint64_t revision, const Selection& selection, LabelAction action,
                              bool new_instance, uint32_t stroke, const std::string& name) {
  const std::lock_guard lock(mutex_);
  know(revision);
  require(octree_ != nullptr, "this file has no points");
  const size_t classes = elements::labels_of(document_->facts().set).size();
  require(!action.label || *action.label < classes, "no such class");
  require(!action.instance || *action.instance <= kMostInstance, "no such instance");
  if (new_instance) {
    require(document_->next_instance() <= kMostInstance, "no more instances");
    action.instance = document_->next_instance();
  }
  const std::vector<uint32_t>& values = document_->values();
  LabelChange change =
      change_of(find_rows(*octree_, *cubes_, selection, values), selection, action, values);
  change.stroke = stroke;
  change.name = name;
  EditResult out = apply(change);
  out.instance = action.instance.value_or(0);
  return out;
}

uint64_t LabelsOfFile::undo(uint64_t revision) {
  const std::lock_guard lock(mutex_);
  know(revision);
  document_->undo();
  return document_->revision();
}

uint64_t LabelsOfFile::redo(uint64_t revision) {
  const std::lock_guard lock(mutex_);
  know(revision);
  document_->redo();
  return document_->revision();
}

uint32_t LabelsOfFile::put_box(uint64_t revision, uint32_t number,
                               const std::optional<std::string>& value, uint32_t stroke) {
  const std::lock_guard lock(mutex_);
  know(revision);
  constexpr size_t kMostBoxes = 10000;
  if (value) check_box(*value);
  if (number == 0) {
    require(value && document_->boxes().size() < kMostBoxes, "more than 10 000 boxes");
    number = document_->next_box();
  } else {
    require(number < document_->next_box(), "no such box");
  }
  document_->put_box(number, value, stroke);
  return number;
}

Vec3 LabelsOfFile::origin() {
  const std::lock_guard lock(mutex_);
  document();
  return cubes_ ? cubes_->origin : Vec3(0, 0, 0);
}

void check_box(const std::string& text) {
  constexpr uint64_t kNoScan = uint64_t(1) << 32;
  const Json j = Json::parse(text, nullptr, false);
  const auto vector = [&](const char* key) {
    Vec3 out;
    const Json& list = j.at(key);
    require(list.is_array() && list.size() == 3, "a box needs position_m, min_m and max_m");
    for (size_t c = 0; c < 3; ++c) out[Eigen::Index(c)] = list[c].get<double>();
    require(out.allFinite() && out.cwiseAbs().maxCoeff() < 1e9, "a box at no place");
    return out;
  };
  try {
    require(j.is_object(), "a box is a JSON object");
    const auto name = j.at("class").get<std::string>();
    if (j.contains("track")) {
      require(j["track"].is_number_unsigned() && j.at("scan").is_number_unsigned(),
              "a box of a track needs the numbers of the track and of a scan");
      require(j["track"].get<uint64_t>() > 0 && j["scan"].get<uint64_t>() < kNoScan,
              "no such track or scan");
      require(perception::class_of_name(name).has_value(),
              "a box of a track needs the class of what moves, such as car");
    } else {
      const auto label = elements::class_from_name(name);
      require(label && elements::kind_of(*label) != elements::ClassKind::kOther,
              "a box needs the class of an object, such as small_tree");
    }
    vector("position_m");
    const Vec3 size = vector("max_m") - vector("min_m");
    require(size.minCoeff() > 0, "a box without size");
    require(std::isfinite(j.at("yaw_rad").get<double>()), "a box without a heading");
  } catch (const Json::exception&) {
    throw std::invalid_argument("a box needs class, position_m, yaw_rad, min_m and max_m");
  }
}

}  // namespace underbrush::serve
