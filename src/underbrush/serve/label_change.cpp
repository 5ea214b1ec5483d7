#include "underbrush/serve/label_change.hpp"

#include <algorithm>
#include <cstring>

#include "underbrush/core/check.hpp"

namespace underbrush::serve {
namespace {

constexpr const char* kDamaged = "damaged change of labels";

// Seven bits a byte, the lowest first; the highest bit says that more follow.
void put_number(std::string& bytes, uint64_t value) {
  while (value >= 128) {
    bytes += char(uint8_t(value) | 128u);
    value >>= 7;
  }
  bytes += char(uint8_t(value));
}

uint64_t take_number(std::string_view& bytes) {
  uint64_t value = 0;
  for (uint32_t shift = 0; shift < 63; shift += 7) {
    require(!bytes.empty(), kDamaged);
    const uint8_t byte = uint8_t(bytes.front());
    bytes.remove_prefix(1);
    value |= uint64_t(byte & 127u) << shift;
    if (byte < 128) return value;
  }
  throw std::invalid_argument(kDamaged);
}

std::string_view take_bytes(std::string_view& bytes) {
  const uint64_t n = take_number(bytes);
  require(n <= bytes.size(), kDamaged);
  const std::string_view out = bytes.substr(0, n);
  bytes.remove_prefix(n);
  return out;
}

void put_bytes(std::string& to, std::string_view bytes) {
  put_number(to, bytes.size());
  to += bytes;
}

}  // namespace

void RowRuns::close() {
  if (length_ == 0) return;
  put_number(bytes_, begin_ - end_);
  put_number(bytes_, length_);
  end_ = begin_ + length_;
  length_ = 0;
}

void RowRuns::add(uint32_t row) {
  if (length_ == 0 || row != begin_ + length_) {
    close();
    begin_ = row;
  }
  ++length_;
  ++rows_;
}

std::string RowRuns::bytes() const {
  RowRuns whole = *this;
  whole.close();
  return whole.bytes_;
}

void RowRuns::read(std::string_view bytes, uint64_t limit,
                   const std::function<void(uint64_t, uint64_t)>& visit) {
  for (uint64_t at = 0; !bytes.empty();) {
    const uint64_t gap = take_number(bytes), length = take_number(bytes);
    require(length > 0 && gap <= limit - at && length <= limit - at - gap, kDamaged);
    visit(at + gap, at + gap + length);
    at += gap + length;
  }
}

uint64_t LabelChange::size() const {
  uint64_t n = 0;
  for (const auto& [values, runs] : rows) n += runs.rows();
  return n;
}

std::string LabelChange::bytes() const {
  std::string out;
  put_number(out, stroke);
  put_number(out, everywhere ? 1 : 0);
  put_bytes(out, name);
  std::string list;
  uint64_t last = 0;
  std::vector<uint32_t> sorted = nodes;
  std::sort(sorted.begin(), sorted.end());
  for (const uint32_t node : sorted) {
    put_number(list, node - last);
    last = node;
  }
  put_bytes(out, list);
  put_number(out, rows.size());
  for (const auto& [values, runs] : rows) {
    put_number(out, values.first);
    put_number(out, values.second);
    put_bytes(out, runs.bytes());
  }
  return out;
}

StoredChange StoredChange::read(std::string_view bytes) {
  StoredChange out;
  out.stroke = uint32_t(take_number(bytes));
  out.everywhere = take_number(bytes) != 0;
  out.name = std::string(take_bytes(bytes));
  uint64_t node = 0;
  for (std::string_view list = take_bytes(bytes); !list.empty();) {
    node += take_number(list);
    out.nodes.push_back(uint32_t(node));
  }
  const uint64_t groups = take_number(bytes);
  for (uint64_t k = 0; k < groups; ++k) {
    Group group;
    group.from = uint32_t(take_number(bytes));
    group.to = uint32_t(take_number(bytes));
    group.runs = take_bytes(bytes);
    out.groups.push_back(group);
  }
  require(bytes.empty(), kDamaged);
  return out;
}

void StoredChange::apply(std::vector<uint32_t>& values, bool back) const {
  for (const Group& g : groups) {
    const uint32_t expected = back ? g.to : g.from;
    RowRuns::read(g.runs, values.size(), [&](uint64_t begin, uint64_t end) {
      for (uint64_t i = begin; i < end; ++i) {
        require(values[i] == expected, "a change of labels that does not fit the labels before it");
      }
    });
  }
  for (const Group& g : groups) {
    const uint32_t value = back ? g.from : g.to;
    RowRuns::read(g.runs, values.size(), [&](uint64_t begin, uint64_t end) {
      std::fill(values.begin() + std::ptrdiff_t(begin), values.begin() + std::ptrdiff_t(end),
                value);
    });
  }
}

}  // namespace underbrush::serve
