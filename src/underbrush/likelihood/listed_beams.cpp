#include "underbrush/likelihood/listed_beams.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::likelihood {
namespace {

/// Elements beyond a return count if their closest approach lies up to this much farther, because
/// their Gaussians reach back to the return, m.
constexpr double kBeyondM = 4;
constexpr size_t kMostValidationBeams = size_t(1) << 16;  // about

/// A hash of a beam, whatever its place in the log.
uint64_t hash_of(const ListedBeam& b) {
  uint64_t hash = std::bit_cast<uint32_t>(b.range_m);
  for (const float x : b.direction) hash = mix64(hash << 32 ^ std::bit_cast<uint32_t>(x) ^ hash);
  return hash;
}

}  // namespace

ListedBeams::ListedBeams(BeamSource& source, const credit::HeldOut& held_out,
                         const elements::Model& model, size_t most_bytes)
    : source_(&source),
      info_(source.info()),
      rule_(held_out),
      origin_(model.origin),
      most_range_m_(std::min(source.info().max_range_m, model.max_range_m)) {
  size_t bytes = 0;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    const size_t before = held_out_.size();
    Block block = block_of(chunk, &held_out_);
    const size_t n = chunk.size() - (held_out_.size() - before);
    training_beams_ += n;
    bytes += n * (sizeof(ListedBeam) + 1);
    complete_ &= bytes <= most_bytes;
    if (complete_) kept_.push_back(std::move(block));
  }
  choose_validation();
}

ListedBeams::ListedBeams(const LogInfo& info, std::vector<ListedBeam> held_out,
                         size_t training_beams)
    : info_(info), held_out_(std::move(held_out)), training_beams_(training_beams) {
  choose_validation();
}

void ListedBeams::choose_validation() {
  const size_t one_in = 1 + held_out_.size() / kMostValidationBeams;
  if (one_in == 1) return;
  std::copy_if(held_out_.begin(), held_out_.end(), std::back_inserter(validation_),
               [&](const ListedBeam& b) { return hash_of(b) % one_in == 0; });
}

ListedBeams::Block ListedBeams::block_of(const BeamLog& chunk,
                                         std::vector<ListedBeam>* held_out) const {
  constexpr uint8_t kApart = credit::BeamShare::kParts;
  std::vector<ListedBeam> beams(chunk.size());
  std::vector<uint8_t> number(chunk.size());
  parallel_for(chunk.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      number[i] = rule_(chunk, i) ? kApart : uint8_t(credit::BeamShare::number_of(chunk, i));
      if (number[i] == kApart && !held_out) continue;
      const Vec3f origin = (chunk.origin[i] - origin_).cast<float>();
      const Vec3f direction = chunk.ray(i).direction.cast<float>();
      const double reach = std::min(double(chunk.range_m[i]) + kBeyondM, most_range_m_);
      beams[i] = {{origin[0], origin[1], origin[2]},
                  chunk.range_m[i],
                  {direction[0], direction[1], direction[2]},
                  float(reach)};
    }
  });
  size_t kept = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (number[i] == kApart) {
      if (held_out) held_out->push_back(beams[i]);
      continue;
    }
    number[kept] = number[i];
    beams[kept++] = beams[i];
  }
  beams.resize(kept);
  number.resize(kept);
  return {std::move(beams), std::move(number)};
}

void ListedBeams::for_each(credit::BeamShare share,
                           const std::function<void(std::span<const ListedBeam>)>& use) const {
  const auto use_share = [&](const Block& block) {
    if (share.is_all()) return use(block.beams);
    std::vector<ListedBeam> some;
    for (size_t i = 0; i < block.beams.size(); ++i) {
      if (share.has(block.number[i])) some.push_back(block.beams[i]);
    }
    use(some);
  };
  for (const Block& block : kept_) use_share(block);
  if (complete_) return;
  size_t number = 0;
  source_->rewind();
  for (BeamLog chunk; source_->next(chunk);) {
    if (number++ >= kept_.size()) use_share(block_of(chunk, nullptr));
  }
}

size_t ListedBeams::held_out_hits() const {
  return size_t(std::count_if(held_out_.begin(), held_out_.end(),
                              [](const ListedBeam& b) { return b.range_m != kMiss; }));
}

}  // namespace underbrush::likelihood
