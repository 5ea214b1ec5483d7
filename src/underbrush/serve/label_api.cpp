#include "underbrush/serve/label_api.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {
namespace {

Json json_of(const EditResult& r) {
  return {{"revision", r.revision}, {"rows", r.rows}, {"instance", r.instance}};
}

std::array<bool, kMostClasses> classes_of(const Query& query, const char* key) {
  std::array<bool, kMostClasses> out{};
  for (const uint32_t label : query.numbers(key)) {
    require(label < kMostClasses, "no such class");
    out[label] = true;
  }
  return out;
}

DrawnShape drawn_of(const Query& query) {
  DrawnShape shape;
  const std::vector<double> m = query.reals("matrix", 16), path = query.reals("path");
  for (Eigen::Index k = 0; k < 16; ++k) shape.clip_from_point(k % 4, k / 4) = m[size_t(k)];
  shape.width_px = query.real("width");
  shape.height_px = query.real("height");
  shape.radius_px = query.real("radius", 0);
  require(path.size() % 2 == 0, "a path has two numbers for each corner");
  for (size_t k = 0; k < path.size(); k += 2) shape.path_px.emplace_back(path[k], path[k + 1]);
  return shape;
}

// The conditions of a request; places are in world coordinates and become relative to `origin`.
Selection selection_of(const Query& query, const Vec3& origin) {
  Selection s;
  if (query.has("path")) s.drawn = drawn_of(query);
  s.depth_m = query.real("depth", 0);
  require(s.depth_m >= 0, "a depth below 0");
  if (query.has("box")) {
    const std::vector<double> b = query.reals("box", 7);
    s.box = TurnedBox{Vec3(b[0], b[1], b[2]) - origin, Vec3(b[3], b[4], b[5]), b[6]};
  }
  if (query.has("slab")) {
    const std::vector<double> b = query.reals("slab", 5);
    const Vec3 normal(b[0], b[1], b[2]);
    s.slab = Slab{normal, b[3] - normal.dot(origin), b[4] - normal.dot(origin)};
  }
  if (query.has("times")) {
    const std::vector<double> t = query.reals("times", 2);
    s.times_s = std::pair(t[0], t[1]);
  }
  s.scan = query.number32("scan");
  s.hidden = classes_of(query, "hidden");
  s.locked = classes_of(query, "locked");
  s.label = query.number32("of_class");
  s.instance = query.number32("of_instance");
  s.selected = query.number("of_selected", 0) != 0;
  return s;
}

LabelAction action_of(const Query& query) {
  LabelAction action;
  action.label = query.number32("class");
  if (query.text("instance") != "new") action.instance = query.number32("instance");
  const std::string select = query.text("select");
  require(select.empty() || select == "add" || select == "remove" || select == "only",
          "select is add, remove or only");
  if (!select.empty()) action.selected = select != "remove";
  action.only = select == "only";
  return action;
}

}  // namespace

LabelApi::LabelApi(ServedFiles files, std::filesystem::path folder)
    : files_(std::move(files)), folder_(std::move(folder)) {}

LabelsOfFile& LabelApi::labels(const Query& query, const char* key) {
  const size_t id = query.number(key);
  const OpenedFile file = files_.file(id);
  require(file.kind == FileKind::kLog || file.kind == FileKind::kModel,
          "this file is no log or model");
  LogData* log = files_.log(id);
  const std::lock_guard lock(mutex_);
  auto& found = labels_[id];
  if (!found) found = std::make_unique<LabelsOfFile>(file, log, folder_);
  return *found;
}

HttpReply LabelApi::answer(const HttpRequest& request) {
  const Query query(request);
  const std::string what =
      request.path.size() > 11 ? request.path.substr(11) : "";  // behind "api/labels/"
  if (what.empty()) return {200, "application/json", labels(query).state(query.number("since", 0))};
  if (what == "data") {
    return {200, "application/octet-stream", labels(query).values_of(query.numbers("nodes"))};
  }
  if (what == "instances") return {200, "application/json", labels(query).instances()};
  if (what == "files") return files();
  if (what == "count") {
    LabelsOfFile& of = labels(query);
    return {200, "application/json", of.count(selection_of(query, of.origin()))};
  }
  if (request.method != "POST") return error_reply(405, "only POST changes labels");
  try {
    return change(what, query);
  } catch (const LabelConflict& e) {
    return reply_of({{"error", e.what()}, {"revision", e.revision}}, 409);
  }
}

HttpReply LabelApi::change(const std::string& what, const Query& query) {
  if (what == "edit") return edit(query);
  if (what == "box") return box(query);
  if (what == "undo") return step(query, true);
  if (what == "redo") return step(query, false);
  if (what == "import") return take_over(query);
  if (what == "carry") return carry(query);
  if (what == "export") return write(query);
  return error_reply(404, "no such page");
}

// The files of the folder that `import` may read.
HttpReply LabelApi::files() const {
  constexpr size_t kMostNames = 1000;
  constexpr std::array<std::string_view, 5> kEndings{".label", ".csv", ".ply", ".ublog", ".pcd"};
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const std::string ending = entry.path().extension().string();
    const bool known = std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
    if (known && !entry.is_symlink() && entry.is_regular_file() && names.size() < kMostNames) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return reply_of({{"names", names}});
}

HttpReply LabelApi::edit(const Query& query) {
  LabelsOfFile& of = labels(query);
  const std::string name = printable(query.text("name"), 80);
  return reply_of(json_of(of.edit(query.number("revision"), selection_of(query, of.origin()),
                                  action_of(query), query.text("instance") == "new",
                                  query.number32("stroke").value_or(0), name)));
}

HttpReply LabelApi::box(const Query& query) {
  LabelsOfFile& of = labels(query);
  std::optional<std::string> value;
  if (query.has("value")) value = query.text("value");
  const uint32_t number = of.put_box(query.number("revision"), query.number32("number").value_or(0),
                                     value, query.number32("stroke").value_or(0));
  return reply_of({{"number", number}});
}

HttpReply LabelApi::step(const Query& query, bool back) {
  LabelsOfFile& of = labels(query);
  const uint64_t known = query.number("revision");
  return reply_of({{"revision", back ? of.undo(known) : of.redo(known)}});
}

HttpReply LabelApi::take_over(const Query& query) {
  LabelsOfFile& of = labels(query);
  const std::filesystem::path from = query.has("from") ? files_.file(query.number("from")).path
                                                       : folder_ / query.file_name("name");
  require(!std::filesystem::is_symlink(from), "no link");
  const std::string set = query.text("set");
  require(set.empty() || !elements::labels_of(set).empty(), "no such label set");
  return reply_of(
      json_of(of.import(query.number("revision"), from, set, query.number("unlabelled", 0) != 0,
                        selection_of(query, Vec3(0, 0, 0)))));
}

HttpReply LabelApi::carry(const Query& query) {
  LabelsOfFile& of = labels(query);
  LabelsOfFile& from = query.has("from") ? labels(query, "from") : of;
  const LabelSource source = from.source(query.number32("from_scan"));
  return reply_of(json_of(of.carry(query.number("revision"), source, query.number32("scan"),
                                   query.real("radius", 0.3))));
}

HttpReply LabelApi::write(const Query& query) {
  LabelsOfFile& of = labels(query);
  const std::filesystem::path path = folder_ / query.file_name("name");
  const std::string format = query.text("format");
  require(!std::filesystem::exists(std::filesystem::symlink_status(path)),
          "a file of this name is there already");
  Json j{{"path", printable(path.string())}};
  if (format == "log") {
    require(io::is_log_name(path), "the name of a log ends with .ply or .ublog");
    of.write_log(path);
    j["file"] = files_.add(path);
  } else if (format == "label") {
    require(path.extension() == ".label", "the name ends with .label");
    const std::string set = query.has("set") ? query.text("set") : "semantickitti";
    require(!elements::labels_of(set).empty(), "no such label set");
    j["without_number"] = of.write_label_file(path, set);
  } else if (format == "annotation") {
    require(path.extension() == ".json", "the name of an annotation ends with .json");
    const OpenedFile ground = query.has("ground") ? files_.file(query.number("ground")) : of.file();
    require(ground.kind == FileKind::kModel, "an annotation needs a model for its ground");
    j["boxes"] = of.write_boxes(path, ground.path);
  } else if (format == "tracks") {
    require(path.extension() == ".csv", "the name of lists of objects ends with .csv");
    j["boxes"] = of.write_tracks(path);
  } else {
    throw std::invalid_argument("format is log, label, annotation or tracks");
  }
  return reply_of(j);
}

}  // namespace underbrush::serve
