/// \file
/// The labels of a file as a person edits them: classes, instances and the selection of a log's
/// rows, and boxes in space, with undo and redo without limit.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/serve/label_change.hpp"
#include "underbrush/serve/label_journal.hpp"

namespace underbrush::serve {

/// The file that a document belongs to, as the header of its journal has it.
struct LabelFacts {
  std::string file;      ///< Name of the log or model.
  std::string set;       ///< The label set of `elements::labels_of`.
  uint64_t rows = 0;     ///< Rows of the log; 0 for a model, which has boxes only.
  std::string contents;  ///< Distinguishes logs of the same number of rows.
};

/// Labels with their journal. A document is used by one thread at a time.
class LabelDocument {
 public:
  /// Opens the document, or creates it with the labels `base` (empty, or one value for each row).
  /// `nodes` is the number of nodes of the log's octree. Throws `FormatError` where the journal is
  /// damaged in its header, belongs to another file or is open elsewhere.
  LabelDocument(const std::filesystem::path& journal, const LabelFacts& facts,
                const std::vector<uint32_t>& base, size_t nodes);

  const LabelFacts& facts() const { return facts_; }
  const LabelJournal& journal() const { return journal_; }
  /// Number of records so far: it grows with every change, undo and redo, also over restarts.
  uint64_t revision() const { return revision_; }
  size_t undos() const { return done_.size(); }
  size_t redos() const { return undone_.size(); }
  /// The name of the change that `undo` takes back; empty without one.
  std::string last_name() const;
  /// The name of the change that `redo` applies again; empty without one.
  std::string next_name() const;

  const std::vector<uint32_t>& values() const { return values_; }
  /// Number of rows of each class; rows without a return count as class 0.
  const std::array<uint64_t, kMostClasses>& counts() const { return counts_; }
  uint64_t selected() const { return selected_; }
  uint32_t next_instance() const { return next_instance_; }
  /// The nodes whose rows changed after a revision.
  std::vector<uint32_t> nodes_since(uint64_t revision) const;
  /// The boxes by number; each is the text of a JSON object.
  const std::map<uint32_t, std::string>& boxes() const { return boxes_; }
  uint32_t next_box() const { return next_box_; }

  /// Applies a change and appends it to the journal. A change without rows is none.
  void change(const LabelChange& change);
  /// Puts, replaces or (without `value`) removes a box.
  void put_box(uint32_t number, const std::optional<std::string>& value, uint32_t stroke = 0);
  /// Takes back the last change, with all others of its stroke. Returns false where there is none.
  bool undo();
  /// Applies again the change that `undo` took back last.
  bool redo();

 private:
  struct Entry {
    uint64_t at = 0;
    uint32_t stroke = 0;
  };
  std::string name_of(const std::vector<Entry>& entries) const;
  void take(uint64_t at, std::string_view record);
  uint32_t apply(std::string_view record, bool back);
  uint32_t apply_box(std::string_view text, bool back);
  uint32_t apply_rows(std::string_view bytes, bool back);
  void add_counts(const StoredChange& change, bool back);
  void append(const std::string& record);
  bool step(bool back);
  void step(bool back, uint64_t count);

  LabelFacts facts_;
  std::vector<uint32_t> values_;
  std::array<uint64_t, kMostClasses> counts_{};
  uint64_t selected_ = 0, revision_ = 0, everywhere_ = 0;
  uint32_t next_instance_ = 1, next_box_ = 1;
  std::vector<uint64_t> node_revision_;
  std::map<uint32_t, std::string> boxes_;
  std::vector<Entry> done_, undone_;
  LabelJournal journal_;
};

}  // namespace underbrush::serve
