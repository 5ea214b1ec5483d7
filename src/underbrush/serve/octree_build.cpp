#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/serve/octree_division.hpp"

namespace underbrush::serve {
namespace {

using Use = std::function<void(const OctreePoint&)>;
using Feed = std::function<void(const Use&)>;

constexpr size_t kSpillBytes = size_t(64) << 20;  // buffers of all chunks

// Points of chunks on disk, each chunk in a place of its own.
class Spill {
 public:
  Spill(const std::filesystem::path& folder, const std::vector<Chunk>& chunks)
      : place_(folder, "points"), file_(place_.path(), place_.path().string()) {
    for (const Chunk& c : chunks) {
      start_.push_back(end_);
      end_ += c.capacity;
    }
    count_.resize(chunks.size());
    buffer_.resize(chunks.size());
    most_ = std::clamp<size_t>(
        kSpillBytes / sizeof(OctreePoint) / std::max<size_t>(1, chunks.size()), 64, 8192);
  }
  void add(size_t chunk, const OctreePoint& p) {
    buffer_[chunk].push_back(p);
    if (buffer_[chunk].size() >= most_) flush(chunk);
  }
  void finish() {
    for (size_t k = 0; k < buffer_.size(); ++k) flush(k);
    buffer_.clear();
    buffer_.shrink_to_fit();
    file_.close();
    if (end_ > 0) reader_ = std::make_unique<InputFile>(place_.path());
  }
  uint64_t points(size_t chunk) const { return count_[chunk]; }
  std::vector<OctreePoint> read(size_t chunk, uint64_t first, size_t n) const {
    std::vector<OctreePoint> out(n);
    reader_->read((start_[chunk] + first) * sizeof(OctreePoint), out.data(),
                  n * sizeof(OctreePoint));
    return out;
  }

 private:
  void flush(size_t chunk) {
    std::vector<OctreePoint>& points = buffer_[chunk];
    file_.overwrite((start_[chunk] + count_[chunk]) * sizeof(OctreePoint), points.data(),
                    points.size() * sizeof(OctreePoint));
    count_[chunk] += points.size();
    points.clear();
  }

  TemporaryPath place_;
  OutputFile file_;
  std::unique_ptr<InputFile> reader_;
  std::vector<uint64_t> start_, count_;
  std::vector<std::vector<OctreePoint>> buffer_;
  uint64_t end_ = 0;
  size_t most_ = 0;
};

class Builder {
 public:
  Builder(const std::filesystem::path& path, const OctreeOptions& options)
      : folder_(path.parent_path()), options_(options), file_(path, path.string()) {
    const OctreeHeader blank;
    file_.append(&blank, sizeof(blank));
    end_ = sizeof(blank);
  }

  // Builds all below the root of a division from its points. Returns the number of that root among
  // the nodes.
  uint32_t build(Division division, const OctreeRoot& root, uint32_t cell_bits, const Feed& feed) {
    Spill spill(folder_, division.chunks());
    feed([&](const OctreePoint& p) {
      OctreePoint moved = p;
      const uint32_t chunk = division.put(moved);
      if (chunk != Division::kTaken) spill.add(chunk, moved);
    });
    spill.finish();
    const uint32_t base = uint32_t(nodes_.size());
    add_upper(division, root, base);
    const bool alone = division.upper_nodes() == 0;
    add_chunks(division.chunks(), spill, root, base, alone);
    for (size_t k = 0; k < division.chunks().size(); ++k) {
      const Chunk& c = division.chunks()[k];
      if (!c.too_large || spill.points(k) == 0) continue;
      nodes_[base + c.parent].child[c.octant] = divide_again(c, k, spill, root, cell_bits);
    }
    return base;
  }

  void finish(const std::vector<OctreeRun>& runs, const std::string& json, uint64_t points) {
    if (nodes_.empty()) nodes_.emplace_back().at = end_;
    write_tables(nodes_, runs, json, points, end_, file_);
    file_.close();
  }
  void set_progress(size_t done, size_t total) {
    done_ = done;
    total_ = total;
  }
  void tell(size_t points) {
    done_ += points;
    if (options_.progress) options_.progress(std::min(done_, total_), total_);
  }

 private:
  void add_upper(Division& division, const OctreeRoot& root, uint32_t base) {
    for (size_t k = 0; k < division.upper_nodes(); ++k) {
      std::string bytes;
      TreeNode node;
      node.level = uint8_t(division.level(k));
      node.points = uint32_t(division.points(k).size());
      node.at = end_;
      append_points(division.points(k), root, division.level(k), bytes);
      std::vector<OctreePoint>().swap(division.points(k));
      for (size_t c = 0; c < 8; ++c) {
        if (division.children(k)[c] != 0) node.child[c] = base + division.children(k)[c];
      }
      nodes_.push_back(node);
      append(bytes);
      tell(node.points);
    }
  }

  void add_chunks(const std::vector<Chunk>& chunks, const Spill& spill, const OctreeRoot& root,
                  uint32_t base, bool alone) {
    const size_t part_bytes = options_.chunk_points * (sizeof(OctreePoint) + kPointBytes + 8);
    const size_t ahead =
        std::clamp<size_t>(options_.memory_bytes / part_bytes, 1, size_t(threads()));
    std::vector<SubTree> built(chunks.size());
    parallel_in_order(
        chunks.size(), ahead,
        [&](size_t k) {
          if (chunks[k].too_large || spill.points(k) == 0) return;
          built[k] = sub_tree(spill.read(k, 0, spill.points(k)), root, chunks[k].level);
        },
        [&](size_t k) {
          // Taken out, because an assignment would keep the memory of its bytes.
          const SubTree part = std::exchange(built[k], SubTree());
          if (part.nodes.empty()) return;
          const uint32_t first = uint32_t(nodes_.size());
          for (TreeNode n : part.nodes) {
            n.at += end_;
            for (uint32_t& c : n.child) c = c == 0 ? 0 : c + first;
            nodes_.push_back(n);
          }
          if (!alone) nodes_[base + chunks[k].parent].child[chunks[k].octant] = first;
          append(part.bytes);
          tell(spill.points(k));
        });
  }

  uint32_t divide_again(const Chunk& chunk, size_t k, const Spill& spill, const OctreeRoot& root,
                        uint32_t cell_bits) {
    require_data(cell_bits > kCellBits, "too many points at one place for the memory allowed");
    const uint32_t bits = std::max(cell_bits, kCellBits + 7) - 7;
    CellCounts counts(size_t(1) << 21, bits);
    const Feed feed = [&](const Use& use) {
      for (uint64_t at = 0; at < spill.points(k); at += 65536) {
        for (const OctreePoint& p :
             spill.read(k, at, std::min<uint64_t>(65536, spill.points(k) - at))) {
          use(p);
        }
      }
    };
    feed([&](const OctreePoint& p) { counts.add(p.at); });
    return build(Division(root, chunk.level, counts.cells(), counts.bits(), options_.chunk_points),
                 root, counts.bits(), feed);
  }

  void append(const std::string& bytes) {
    file_.append(bytes.data(), bytes.size());
    end_ += bytes.size();
  }

  std::filesystem::path folder_;
  const OctreeOptions& options_;
  OutputFile file_;
  uint64_t end_ = 0;
  size_t done_ = 0, total_ = 0;
  std::vector<TreeNode> nodes_;
};

std::string description(const OctreeSurvey& s, const LogInfo& info, const OctreeRoot& root,
                        const std::string& source) {
  nlohmann::ordered_json j;
  const auto corner = [&](const std::array<int64_t, 3>& at) {
    return std::array<double, 3>{double(at[0]) * kUnitM, double(at[1]) * kUnitM,
                                 double(at[2]) * kUnitM};
  };
  j["format"] = "underbrush octree";
  j["version"] = kOctreeVersion;
  j["source"] = source;
  j["rows"] = s.rows;
  j["beams"] = s.beams;
  j["points"] = s.points;
  j["origin_m"] = {s.origin.x(), s.origin.y(), s.origin.z()};
  j["root_low_m"] = corner(root.low);
  j["root_side_m"] = root.side_m(0);
  j["low_m"] = corner(s.low);
  j["high_m"] = corner(s.high);
  j["first_time_s"] = s.first_s;
  j["last_time_s"] = s.last_s;
  j["intensity"] = {s.least_intensity, s.most_intensity};
  j["most_ring"] = s.most_ring;
  j["most_echo"] = s.most_echo;
  j["sensor"] = info.sensor;
  j["max_range_m"] = info.max_range_m;
  j["has_misses"] = info.has_misses;
  j["label_set"] = info.classes;
  j["labels"] = nlohmann::ordered_json::array();
  for (size_t k = 0; s.has_labels && k < s.labels.size(); ++k) {
    if (s.labels[k] == 0) continue;
    j["labels"].push_back({{"number", k},
                           {"name", elements::label_name(info.classes, uint32_t(k))},
                           {"points", s.labels[k]}});
  }
  return j.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

void build_octree(BeamSource& log, const std::filesystem::path& path,
                  const OctreeOptions& options) {
  require(options.chunk_points >= 65536, "build_octree: chunks of at least 65 536 points");
  const size_t rows = log.size();
  const auto tell = [&](size_t done) {
    if (options.progress) options.progress(std::min(done, rows), 3 * rows);
  };
  OctreeSurvey survey = survey_log(log, tell);
  const OctreeRoot root = survey.root();
  std::vector<CellCounts::Cell> cells = survey.counts.cells();
  const uint32_t cell_bits = survey.counts.bits();
  survey.counts = CellCounts(8);
  for (CellCounts::Cell& c : cells) {
    for (size_t k = 0; k < 3; ++k) c.at[k] -= root.low[k] >> cell_bits;
  }
  Builder builder(path, options);
  builder.set_progress(rows, 2 * rows + survey.points);
  if (survey.points > 0) {
    builder.build(Division(root, 0, std::move(cells), cell_bits, options.chunk_points), root,
                  cell_bits, [&](const Use& use) {
                    log.rewind();
                    size_t row = 0;
                    for (BeamLog chunk; log.next(chunk); row += chunk.size()) {
                      for_each_return(chunk, row, survey, [&](const OctreePoint& p) {
                        OctreePoint q = p;
                        for (size_t c = 0; c < 3; ++c) q.at[c] -= root.low[c];
                        use(q);
                      });
                      builder.tell(chunk.size());
                    }
                  });
  }
  builder.finish(survey.runs, description(survey, log.info(), root, options.source), survey.points);
}

}  // namespace underbrush::serve
