/// \file
/// The labels of an opened file: its document, which is opened when it is first needed, and the
/// operations on it.
#pragma once
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/serve/label_document.hpp"
#include "underbrush/serve/log_data.hpp"
#include "underbrush/serve/opened_files.hpp"
#include "underbrush/serve/selection.hpp"

namespace underbrush::serve {

/// A request was made for an older state than the present one.
class LabelConflict : public std::runtime_error {
 public:
  explicit LabelConflict(uint64_t now)
      : std::runtime_error("the labels were changed elsewhere"), revision(now) {}
  uint64_t revision;  ///< The revision of the present state.
};

/// The result of an edit.
struct EditResult {
  uint64_t revision = 0, rows = 0;
  uint32_t instance = 0;  ///< The instance that the rows have now, if the edit gave one.
};

/// The points and labels from which labels are copied.
struct LabelSource {
  std::vector<Vec3> points;  ///< World, m.
  std::vector<uint32_t> values;
};

/// Labels of one file, shared by all pages that show it. Every function that changes something
/// takes the revision that the caller knows, and throws `LabelConflict` where there is a newer one.
class LabelsOfFile {
 public:
  /// `log` is null for a model. The journal is `folder`/NAME.labels.
  LabelsOfFile(OpenedFile file, LogData* log, std::filesystem::path folder);

  /// The state as JSON: docs/reference/serve-api.md. `since` is the revision for `nodes`.
  std::string state(uint64_t since);
  /// The labels (uint32) of the points of some nodes, in their order, one node after the other.
  std::string values_of(const std::vector<uint32_t>& nodes);
  /// Instances with the class and the number of points of each, as JSON.
  std::string instances();
  /// The number of points of a selection, and of their classes, as JSON, with a histogram of
  /// heights.
  std::string count(const Selection& selection);

  EditResult edit(uint64_t revision, const Selection& selection, LabelAction action,
                  bool new_instance, uint32_t stroke, const std::string& name);
  uint64_t undo(uint64_t revision);
  uint64_t redo(uint64_t revision);
  /// Puts a box, or removes it without `value`; number 0 makes a new one. Returns its number.
  uint32_t put_box(uint64_t revision, uint32_t number, const std::optional<std::string>& value,
                   uint32_t stroke);
  /// Takes labels over that `primitives::read_given_labels` reads, for all hits or only for those
  /// without a class. `set` may be empty.
  EditResult import(uint64_t revision, const std::filesystem::path& from, const std::string& set,
                    bool only_unlabelled, const Selection& selection);
  /// Gives hits without a class the label of the nearest point of `source` within `radius_m`.
  EditResult carry(uint64_t revision, const LabelSource& source, std::optional<uint32_t> scan,
                   double radius_m);
  /// The labelled hits, of one scan or all; at most five million.
  LabelSource source(std::optional<uint32_t> scan);

  /// Writes the log with the columns class and instance.
  void write_log(const std::filesystem::path& path);
  /// Writes labels for each row, as SemanticKITTI does, in the numbers of a set. Returns the number
  /// of labelled rows that have no number there.
  uint64_t write_label_file(const std::filesystem::path& path, const std::string& set);
  /// Writes the boxes of tracks as lists of objects, each at the mean time of its returns or, where
  /// it has none, of its scan's beams. Returns their number.
  size_t write_tracks(const std::filesystem::path& path);
  /// Writes the boxes that are of no track as an annotation. Returns their number.
  size_t write_boxes(const std::filesystem::path& path, const std::filesystem::path& ground);

  const OpenedFile& file() const { return file_; }
  /// World coordinates of the origin of the log's octree; zero for a model.
  Vec3 origin();

 private:
  LabelDocument& document();
  void know(uint64_t revision);
  EditResult apply(const LabelChange& change);
  std::vector<uint32_t> base(const std::string& set, uint64_t rows) const;

  OpenedFile file_;
  LogData* log_;
  std::filesystem::path folder_;
  std::mutex mutex_;  ///< Guards all below.
  std::shared_ptr<const OctreeFile> octree_;
  std::unique_ptr<NodeCubes> cubes_;
  std::unique_ptr<LabelDocument> document_;
};

/// Checks the text of a box: a JSON object with the class of an object, `position_m`, `yaw_rad`,
/// and `min_m` and `max_m` in its own frame; for a moving object also its `track` and `scan`.
/// Throws `std::invalid_argument`.
void check_box(const std::string& text);

}  // namespace underbrush::serve
