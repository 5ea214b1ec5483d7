// The journal of labels: what was acknowledged is there whenever the program ends, undo and redo go
// back and forth without limit, and damage is kept and told.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/serve/label_document.hpp"
#include "underbrush/serve/label_sets.hpp"
#include "underbrush/serve/labels_of_file.hpp"

namespace underbrush::serve {
namespace {

using io::TemporaryFolder;

constexpr uint64_t kRows = 3000;
const LabelFacts kFacts{"log.ply", "underbrush", kRows, "1"};

/// What a document shows.
struct State {
  std::vector<uint32_t> values;
  std::map<uint32_t, std::string> boxes;
  bool operator==(const State&) const = default;
};

State state_of(const LabelDocument& d) { return {d.values(), d.boxes()}; }

LabelChange random_change(Stream& random, const std::vector<uint32_t>& values, uint32_t stroke) {
  LabelChange change;
  change.stroke = stroke;
  change.name = "brush";
  change.nodes = {uint32_t(random.below(9)), uint32_t(random.below(9))};
  const LabelValue to{uint32_t(random.below(14)), uint32_t(random.below(300)),
                      random.below(2) == 0};
  const double share = random.uniform(0, 0.4);
  for (uint32_t row = 0; row < values.size(); ++row) {
    if (random.uniform(0, 1) < share) change.add(row, values[row], to.bits());
  }
  return change;
}

/// Edits at random, and tells the length of the journal and the state after each record.
std::vector<std::pair<uint64_t, State>> edited(const std::filesystem::path& path, int edits,
                                               uint64_t seed) {
  Stream random(seed);
  LabelDocument d(path, kFacts, {}, 9);
  std::vector<std::pair<uint64_t, State>> out{{d.journal().bytes(), state_of(d)}};
  uint32_t stroke = 1;
  for (int k = 0; k < edits; ++k) {
    const uint64_t what = random.below(10);
    if (random.below(3) == 0) ++stroke;
    if (what == 0) {
      d.undo();
    } else if (what == 1) {
      d.redo();
    } else if (what == 2) {
      d.put_box(uint32_t(1 + random.below(4)), R"({"yaw_rad":)" + std::to_string(k) + "}", stroke);
    } else if (what == 3) {
      d.put_box(uint32_t(1 + random.below(4)), std::nullopt);
    } else {
      d.change(random_change(random, d.values(), stroke));
    }
    out.emplace_back(d.journal().bytes(), state_of(d));
  }
  return out;
}

std::string bytes_of(const std::filesystem::path& path) { return read_file(path); }

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST(Labels, AJournalThatEndsAtAnyByteHoldsAllWholeRecords) {
  const TemporaryFolder folder;
  const auto states = edited(folder / "whole", 25, 2101);  // seed 2101
  const std::string whole = bytes_of(folder / "whole");
  ASSERT_EQ(whole.size(), states.back().first);
  Stream random(2102);
  const size_t first = size_t(states[0].first);
  for (size_t n = first; n <= whole.size(); n += 1 + random.below(whole.size() / 50)) {
    write(folder / "cut", whole.substr(0, n));
    std::filesystem::remove(folder / "cut.lost");
    const LabelDocument d(folder / "cut", kFacts, {}, 9);
    const auto last =
        std::find_if(states.rbegin(), states.rend(), [&](const auto& s) { return s.first <= n; });
    ASSERT_EQ(state_of(d), last->second) << "cut at byte " << n;
    ASSERT_EQ(d.journal().lost_bytes(), n - last->first);
    ASSERT_EQ(bytes_of(folder / "cut").size(), last->first);
    if (n > last->first) {
      ASSERT_EQ(bytes_of(folder / "cut.lost"), whole.substr(last->first, n - last->first));
    }
  }
  for (size_t n = 0; n < first; ++n) {
    write(folder / "cut", whole.substr(0, n));
    EXPECT_THROW(LabelDocument(folder / "cut", kFacts, {}, 9), FormatError) << n;
    EXPECT_EQ(bytes_of(folder / "cut").size(), n);
  }
}

TEST(Labels, AJournalGoesOnAfterDamage) {
  const TemporaryFolder folder;
  const auto states = edited(folder / "j", 12, 2103);
  std::string bytes = bytes_of(folder / "j");
  const size_t at = size_t((states[6].first + states[12].first) / 2);
  bytes[at] = char(bytes[at] ^ 64);
  write(folder / "j", bytes);
  State now;
  {
    LabelDocument d(folder / "j", kFacts, {}, 9);
    EXPECT_GT(d.journal().lost_bytes(), 0u);
    d.put_box(d.next_box(), R"({"yaw_rad":7})");
    now = state_of(d);
  }
  const LabelDocument again(folder / "j", kFacts, {}, 9);
  EXPECT_EQ(state_of(again), now);
  EXPECT_EQ(again.journal().lost_bytes(), 0u);
}

TEST(Labels, UndoGoesBackToTheBeginningAndRedoForthAgain) {
  const TemporaryFolder folder;
  Stream random(2104);
  std::vector<uint32_t> base(kRows);
  for (uint32_t& v : base) v = LabelValue{uint32_t(random.below(14)), 7, false}.bits();
  std::vector<State> states;
  {
    LabelDocument d(folder / "j", kFacts, base, 9);
    states.push_back(state_of(d));
    for (uint32_t k = 1; k <= 15; ++k) {  // strokes of three changes
      for (int part = 0; part < 3; ++part) d.change(random_change(random, d.values(), k));
      states.push_back(state_of(d));
    }
  }
  LabelDocument d(folder / "j", kFacts, {}, 9);  // as after a restart
  EXPECT_EQ(d.undos(), 45u);
  for (size_t k = 15; k > 0; --k) {
    ASSERT_EQ(state_of(d), states[k]);
    ASSERT_TRUE(d.undo());
  }
  EXPECT_EQ(d.values(), base);
  EXPECT_FALSE(d.undo());
  for (size_t k = 1; k <= 15; ++k) {
    ASSERT_TRUE(d.redo());
    ASSERT_EQ(state_of(d), states[k]);
  }
  EXPECT_FALSE(d.redo());
  uint64_t rows = 0, selected = 0;
  for (const uint64_t n : d.counts()) rows += n;
  for (const uint32_t v : d.values()) selected += LabelValue::of(v).selected;
  EXPECT_EQ(rows, kRows);
  EXPECT_EQ(d.selected(), selected);
}

TEST(Labels, ADocumentBelongsToOneFileAndOneProgram) {
  const TemporaryFolder folder;
  LabelDocument d(folder / "j", kFacts, {}, 9);
  EXPECT_THROW(LabelDocument(folder / "j", kFacts, {}, 9), FormatError);
  { const LabelDocument made(folder / "other", kFacts, {}, 9); }
  LabelFacts other = kFacts;
  other.contents = "2";
  EXPECT_THROW(LabelDocument(folder / "other", other, {}, 9), FormatError);
  EXPECT_EQ(d.nodes_since(0).size(), 0u);
  LabelChange change;
  change.nodes = {3};
  change.add(5, 0, 1);
  d.change(change);
  EXPECT_EQ(d.nodes_since(0), std::vector<uint32_t>{3});
  EXPECT_TRUE(d.nodes_since(1).empty());
}

TEST(Labels, RefusesDamagedChanges) {
  LabelChange change;
  for (uint32_t row : {1u, 2u, 9u}) change.add(row, 0, 4);
  const std::string bytes = change.bytes();
  std::vector<uint32_t> values(10);
  StoredChange::read(bytes).apply(values, false);
  EXPECT_EQ(values, (std::vector<uint32_t>{0, 4, 4, 0, 0, 0, 0, 0, 0, 4}));
  EXPECT_THROW(StoredChange::read(bytes).apply(values, false), std::invalid_argument);
  std::vector<uint32_t> fewer(9);
  EXPECT_THROW(StoredChange::read(bytes).apply(fewer, false), std::invalid_argument);
  for (size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_THROW(StoredChange::read(bytes.substr(0, n)), std::invalid_argument) << n;
  }
}

TEST(Labels, SetsAreTranslated) {
  EXPECT_EQ(label_in_set("rellis", 4, "underbrush"), 8u);
  EXPECT_EQ(label_in_set("rellis", 3, "underbrush"), 2u);
  EXPECT_EQ(label_in_set("underbrush", 9, "semantickitti"), 70u);
  EXPECT_EQ(label_in_set("semantickitti", 72, "underbrush"), 1u);
  EXPECT_EQ(label_in_set("rellis", 12, "semantickitti"), 50u);  // both know buildings
  EXPECT_EQ(label_in_set("rellis", 17, "underbrush"), std::nullopt);
  EXPECT_EQ(label_in_set("rellis", 2, "rellis"), std::nullopt);
}

TEST(Labels, BoxesAreChecked) {
  const std::string good =
      R"({"class":"small_tree","position_m":[1,2,3],"yaw_rad":0.5,"min_m":[-1,-1,0],"max_m":[1,1,4]})";
  EXPECT_NO_THROW(check_box(good));
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"small_tree", "ground"},
                                                        {"[1,2,3]", "[1,2]"},
                                                        {"[1,2,3]", "[1,2,\"x\"]"},
                                                        {"[1,1,4]", "[1,1,0]"},
                                                        {"0.5", "null"},
                                                        {"[1,2,3]", "[1,2,1e300]"},
                                                        {"{", "["}}) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    EXPECT_THROW(check_box(bad), std::invalid_argument) << bad;
  }
  std::string moves = good;
  moves.replace(moves.find("small_tree"), 10, R"(car","scan":3,"track":1,"name":")");
  EXPECT_NO_THROW(check_box(moves));
}

}  // namespace
}  // namespace underbrush::serve
