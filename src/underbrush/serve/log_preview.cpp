#include "underbrush/serve/log_preview.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/serve/bytes.inl"
#include "underbrush/serve/octree_survey.hpp"

namespace underbrush::serve {
namespace {

constexpr size_t kPieceRows = 16;
constexpr size_t kMostPieces = 8192;

struct Piece {
  size_t first_row = 0;
  BeamLog rows;
};

std::vector<Piece> pieces_of(const io::LogReader& log) {
  const size_t whole = (log.size() + kPieceRows - 1) / kPieceRows;
  const size_t n = std::min(whole, kMostPieces);
  std::vector<Piece> out;
  out.reserve(n);
  for (size_t k = 0; k < n; ++k) {
    const size_t first = whole * k / n * kPieceRows;
    try {
      out.push_back({first, log.rows(first, std::min(kPieceRows, log.size() - first))});
    } catch (const FormatError&) {  // the octree has the other rows of this piece
    }
  }
  return out;
}

template <class T, class Get>
void append_column(std::string& bytes, const std::vector<OctreePoint>& points, Get get) {
  for (const OctreePoint& p : points) append(bytes, T(get(p)));
}

std::string bytes_of(const std::vector<OctreePoint>& points, const Vec3& origin) {
  std::string bytes;
  bytes.reserve(32 + points.size() * kPointBytes);
  append(bytes, uint32_t(points.size()));
  append(bytes, uint32_t(0));
  append(bytes, origin.data(), 3);
  for (const OctreePoint& p : points) {
    for (const int64_t v : p.at) append(bytes, float(double(v) * kUnitM));
  }
  append_column<float>(bytes, points, [](const OctreePoint& p) { return p.intensity; });
  append_column<float>(bytes, points, [](const OctreePoint& p) { return p.time_s; });
  append_column<uint32_t>(bytes, points, [](const OctreePoint& p) { return p.row; });
  append_column<uint16_t>(bytes, points, [](const OctreePoint& p) { return p.ring; });
  append_column<uint16_t>(bytes, points, [](const OctreePoint& p) { return p.label; });
  append_column<uint8_t>(bytes, points, [](const OctreePoint& p) { return p.echo; });
  return bytes;
}

}  // namespace

std::string log_preview(const std::filesystem::path& path) {
  require(io::open_input(path).is_log, "this log has no preview");
  io::LogReader log(path, 1024);
  const std::vector<Piece> pieces = pieces_of(log);
  OctreeSurvey facts;
  facts.origin = log_origin(log).value_or(Vec3::Zero());
  facts.first_s = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces) {
    for (const double t : piece.rows.time_s) facts.first_s = std::min(facts.first_s, t);
  }
  std::vector<OctreePoint> points;
  for (const Piece& piece : pieces) {
    for_each_return(piece.rows, piece.first_row, facts,
                    [&](const OctreePoint& p) { points.push_back(p); });
  }
  return bytes_of(points, facts.origin);
}

}  // namespace underbrush::serve
