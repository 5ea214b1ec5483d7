// Reading of encoded messages with the place of every fault.
#pragma once
#include <array>
#include <cmath>
#include <protozero/pbf_reader.hpp>
#include <string>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/common.hpp"

namespace underbrush::osi {

/// Keys of fields: their number and wire type.
constexpr uint32_t var(uint32_t tag) { return tag << 3; }
constexpr uint32_t f64(uint32_t tag) { return tag << 3 | 1; }
constexpr uint32_t len(uint32_t tag) { return tag << 3 | 2; }

/// Where in a message a reader is.
class Place {
 public:
  explicit Place(std::string_view source) : source_(source) {}
  void enter(const char* name, int64_t index = -1) { steps_[depth_++] = {name, index}; }
  void leave() { --depth_; }
  [[noreturn]] void fail(const char* field, const char* reason) const;

 private:
  struct Step {
    const char* name;
    int64_t index;
  };
  std::string_view source_;
  std::array<Step, 16> steps_{};  // Our readers are at most 8 deep.
  size_t depth_ = 0;
};

/// Calls `field(reader, key)` for each field. `field` returns false for one that it does not take.
template <class Field>
void read_fields(protozero::data_view bytes, const Place& place, Field&& field) {
  try {
    protozero::pbf_reader r(bytes);
    while (r.next()) {
      if (!field(r, r.tag_and_type())) r.skip();
    }
  } catch (const protozero::exception&) {
    place.fail("", "truncated or malformed");
  }
}

/// Reads a field that is a message with `read(view, place)`. This function and those below return
/// true, so that a field that was taken is one line.
template <class Read>
bool read_part(protozero::pbf_reader& r, Place& place, const char* name, int64_t index,
               Read&& read) {
  const protozero::data_view part = r.get_view();
  place.enter(name, index);
  read(part, place);
  place.leave();
  return true;
}

/// Reads a field that is a message with `value = read(view, place)`.
template <class Value, class Read>
bool into(protozero::pbf_reader& r, Place& place, const char* name, Value& value, Read&& read) {
  return read_part(r, place, name, -1,
                   [&](protozero::data_view part, Place& at) { value = read(part, at); });
}

/// Adds a field that is a message to a list.
template <class Value, class Read>
bool add_part(protozero::pbf_reader& r, Place& place, const char* name, std::vector<Value>& list,
              Read&& read) {
  return read_part(r, place, name, int64_t(list.size()),
                   [&](protozero::data_view part, Place& at) { list.push_back(read(part, at)); });
}

/// Reads a number, which may be optional.
template <class Number>
bool finite(protozero::pbf_reader& r, const Place& place, const char* name, Number& value) {
  const double v = r.get_double();
  if (!std::isfinite(v)) place.fail(name, "not a finite number");
  value = v;
  return true;
}

/// Reads a whole number or one of an enumeration.
template <class Number>
bool number(protozero::pbf_reader& r, Number& value) {
  value = Number(r.get_int64());  // Negative numbers of an enumeration have 64 bits, too.
  return true;
}
template <class Number>
bool number(protozero::pbf_reader& r, std::optional<Number>& value) {
  return number(r, value.emplace());
}

Timestamp read_timestamp(protozero::data_view bytes, Place& place);
Version read_version(protozero::data_view bytes, Place& place);
uint64_t read_id(protozero::data_view bytes, Place& place);
/// Three numbers with the tags 1 to 3; `before` holds those that are absent.
Vec3 read_vector(protozero::data_view bytes, Place& place, const Vec3& before = Vec3::Zero());
Mounting read_mounting(protozero::data_view bytes, Place& place);
BaseMoving read_base(protozero::data_view bytes, Place& place);
/// Reads a vector into a value that may hold an earlier part of the same field.
bool read_vector(protozero::pbf_reader& r, Place& place, const char* name,
                 std::optional<Vec3>& value);
bool read_extent(protozero::pbf_reader& r, Place& place, std::optional<Vec3>& value);

}  // namespace underbrush::osi
