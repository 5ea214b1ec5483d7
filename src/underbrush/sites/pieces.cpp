#include "underbrush/sites/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::sites {
namespace {

using primitives::PlacedObject;

constexpr int32_t kCellsOfPiece = 6;  // Along a side.
constexpr double kSameSideM = 2e-3;

bool is_cell(const PlacedObject& o, double cell_m) {
  const Vec3 size = o.box.size();
  return elements::kind_of(o.label) == elements::ClassKind::kPatch &&
         std::abs(size.x() - cell_m) < kSameSideM && std::abs(size.y() - cell_m) < kSameSideM;
}

/// Moves the piece to the mean of its parts and measures it.
void finish(Piece& piece, double cell_m) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  std::map<elements::Class, size_t> votes;
  for (const PlacedObject& o : piece.parts) {
    sum += o.position.head<2>();
    ++votes[o.label];
  }
  piece.at = sum / double(piece.parts.size());
  for (PlacedObject& o : piece.parts) o.position.head<2>() -= piece.at;
  piece.label = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                  return a.second < b.second;
                })->first;
  const Vec3 size = piece.parts[0].box.size();
  piece.radius_m = piece.is_cells ? std::sqrt(double(piece.parts.size()) * cell_m * cell_m / M_PI)
                                  : 0.25 * (size.x() + size.y());
}

}  // namespace

std::vector<Piece> pieces_of(std::span<const PlacedObject> objects, double cell_m) {
  require(cell_m > 0, "cells must have a positive side");
  std::vector<Piece> out;
  std::map<std::tuple<uint32_t, int32_t, int32_t>, size_t> pieces;
  for (const PlacedObject& o : objects) {
    size_t at = out.size();
    const bool cell = is_cell(o, cell_m);
    if (cell) {
      const Cell2 square = cell_of(o.position.x(), o.position.y(), kCellsOfPiece * cell_m);
      at = pieces.try_emplace({o.instance, square.x, square.y}, at).first->second;
    }
    if (at == out.size()) out.emplace_back().is_cells = cell;
    out[at].parts.push_back(o);
  }
  for (Piece& piece : out) finish(piece, cell_m);
  return out;
}

std::vector<PlacedObject> objects_of(const Piece& piece, const Eigen::Vector2d& at, double turn_rad,
                                     double cell_m) {
  const double turn = piece.is_cells ? M_PI_2 * std::round(turn_rad / M_PI_2) : turn_rad;
  const Eigen::Rotation2Dd rotation(turn);
  std::vector<PlacedObject> out = piece.parts;
  for (PlacedObject& o : out) {
    Eigen::Vector2d place = at + rotation * o.position.head<2>();
    if (piece.is_cells) {
      place = cell_m * ((place / cell_m).array().floor() + 0.5);
    }
    o.position = Vec3(place.x(), place.y(), 0);
    o.yaw_rad = std::remainder(o.yaw_rad + turn, 2 * M_PI);
    o.instance = 0;
    o.points = 0;
    o.trajectory.clear();
  }
  return out;
}

}  // namespace underbrush::sites
