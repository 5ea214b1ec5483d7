#include "underbrush/serve/label_document.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {
namespace {

constexpr int kVersion = 1;

// The first byte of a record.
constexpr char kBase = '0', kRows = 'c', kBox = 'b', kUndo = 'u', kRedo = 'r';

std::string header_of(const LabelFacts& f) {
  return text_of({{"version", kVersion},
                  {"file", f.file},
                  {"set", f.set},
                  {"rows", f.rows},
                  {"contents", f.contents}});
}

// The facts of an existing journal, which must be those of the file at hand.
LabelFacts checked_facts(const std::filesystem::path& path, const std::string& header,
                         const LabelFacts& facts) {
  const Json j = Json::parse(header, nullptr, false);
  const auto refuse = [&](const char* why) { throw FormatError(path.string(), "header", why); };
  try {
    if (!j.is_object() || j.at("version") != kVersion) refuse("labels of another version");
    if (j.at("rows") != facts.rows || j.at("contents") != facts.contents) {
      refuse("labels of another file, or of another state of it");
    }
    LabelFacts out = facts;
    out.set = j.at("set").get<std::string>();
    return out;
  } catch (const Json::exception&) {
    refuse("damaged");
  }
  return facts;
}

}  // namespace

LabelDocument::LabelDocument(const std::filesystem::path& journal, const LabelFacts& facts,
                             const std::vector<uint32_t>& base, size_t nodes)
    : values_(facts.rows), node_revision_(nodes), journal_(journal, header_of(facts)) {
  facts_ = checked_facts(journal, journal_.header(), facts);
  counts_[0] = facts.rows;
  journal_.replay([this](uint64_t at, std::string_view record) {
    ++revision_;
    take(at, record);
  });
  if (revision_ > 0 || base.empty()) return;
  require(base.size() == values_.size(), "labels for another number of rows");
  LabelChange first;
  first.everywhere = true;
  for (uint32_t i = 0; i < base.size(); ++i) first.add(i, 0, base[i]);
  if (!first.rows.empty()) append(kBase + first.bytes());
}

std::string LabelDocument::last_name() const { return name_of(done_); }
std::string LabelDocument::next_name() const { return name_of(undone_); }

std::string LabelDocument::name_of(const std::vector<Entry>& entries) const {
  if (entries.empty()) return "";
  const std::string record = journal_.read(entries.back().at);
  if (record[0] == kBox) return "box";
  return StoredChange::read(std::string_view(record).substr(1)).name;
}

std::vector<uint32_t> LabelDocument::nodes_since(uint64_t revision) const {
  std::vector<uint32_t> out;
  for (uint32_t k = 0; k < node_revision_.size(); ++k) {
    if (std::max(node_revision_[k], everywhere_) > revision) out.push_back(k);
  }
  return out;
}

void LabelDocument::append(const std::string& record) {
  const uint64_t at = journal_.append(record);
  ++revision_;
  take(at, record);
}

void LabelDocument::take(uint64_t at, std::string_view record) {
  require(!record.empty(), "an empty record");
  const char kind = record.front();
  if (kind == kUndo || kind == kRedo) {
    const Json count = Json::parse(record.substr(1), nullptr, false);
    require(count.is_number_unsigned(), "a damaged number");
    return step(kind == kUndo, count.get<uint64_t>());
  }
  const uint32_t stroke = apply(record, false);
  if (kind == kBase) return;
  undone_.clear();
  done_.push_back({at, stroke});
}

uint32_t LabelDocument::apply(std::string_view record, bool back) {
  const char kind = record.front();
  if (kind == kRows || kind == kBase) return apply_rows(record.substr(1), back);
  require(kind == kBox, "a record of an unknown kind");
  return apply_box(record.substr(1), back);
}

uint32_t LabelDocument::apply_rows(std::string_view bytes, bool back) {
  const StoredChange change = StoredChange::read(bytes);
  change.apply(values_, back);
  add_counts(change, back);
  if (change.everywhere) everywhere_ = revision_;
  for (const uint32_t node : change.nodes) {
    if (node < node_revision_.size())
      node_revision_[node] = revision_;
    else
      everywhere_ = revision_;  // another octree than the one at the time of the change
  }
  return change.stroke;
}

void LabelDocument::add_counts(const StoredChange& change, bool back) {
  for (const StoredChange::Group& g : change.groups) {
    uint64_t n = 0;
    RowRuns::read(g.runs, values_.size(), [&](uint64_t begin, uint64_t end) { n += end - begin; });
    const LabelValue from = LabelValue::of(back ? g.to : g.from);
    const LabelValue to = LabelValue::of(back ? g.from : g.to);
    counts_[from.label] -= n;
    counts_[to.label] += n;
    selected_ += (to.selected ? n : 0) - (from.selected ? n : 0);
    next_instance_ = std::max({next_instance_, from.instance + 1, to.instance + 1});
  }
}

uint32_t LabelDocument::apply_box(std::string_view text, bool back) {
  const Json j = Json::parse(text, nullptr, false);
  try {
    const uint32_t number = j.at("box").get<uint32_t>();
    const Json& value = j.at(back ? "from" : "to");
    if (value.is_null()) {
      boxes_.erase(number);
    } else {
      boxes_[number] = value.dump();
    }
    next_box_ = std::max(next_box_, number + 1);
    return j.at("stroke").get<uint32_t>();
  } catch (const Json::exception&) {
    throw std::invalid_argument("a damaged box");
  }
}

void LabelDocument::change(const LabelChange& change) {
  if (!change.rows.empty()) append(kRows + change.bytes());
}

void LabelDocument::put_box(uint32_t number, const std::optional<std::string>& value,
                            uint32_t stroke) {
  const auto old = boxes_.find(number);
  const Json from = old == boxes_.end() ? Json(nullptr) : Json::parse(old->second);
  const Json to = value ? Json::parse(*value, nullptr, false) : Json(nullptr);
  require(!to.is_discarded(), "a box is a JSON object");
  if (from == to) return;
  append(kBox + Json{{"box", number}, {"stroke", stroke}, {"from", from}, {"to", to}}.dump());
}

bool LabelDocument::step(bool back) {
  const std::vector<Entry>& from = back ? done_ : undone_;
  if (from.empty()) return false;
  const uint32_t stroke = from.back().stroke;
  uint64_t count = 1;
  while (stroke != 0 && count < from.size() && from[from.size() - 1 - count].stroke == stroke) {
    ++count;
  }
  append((back ? kUndo : kRedo) + std::to_string(count));
  return true;
}

void LabelDocument::step(bool back, uint64_t count) {
  std::vector<Entry>& from = back ? done_ : undone_;
  std::vector<Entry>& to = back ? undone_ : done_;
  require(count <= from.size(), "more is taken back than there is");
  for (; count > 0; --count) {
    apply(journal_.read(from.back().at), back);
    to.push_back(from.back());
    from.pop_back();
  }
}

bool LabelDocument::undo() { return step(true); }
bool LabelDocument::redo() { return step(false); }

}  // namespace underbrush::serve
