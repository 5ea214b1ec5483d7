#include "underbrush/keyframes/pixel_look_up.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "underbrush/core/clones.hpp"
#include "underbrush/core/eight_lanes.inl"

namespace underbrush::keyframes {
namespace {

using elements::KeyframePixel;

constexpr size_t kPixels = 9;
static_assert(PixelLookUp::kBeams == kLanes);
constexpr float kFarM = 100;  // range at which the pixel of a miss is assumed
constexpr int kSteps = 6;
constexpr float kSlotsARow = 8;  // slots of the table of rows, for each row

/// Half a pixel: x and y, or z and the intensity.
typedef int32_t Word __attribute__((may_alias));

UNDERBRUSH_INLINE F size_of(F a) { return (F)((I)a & 0x7fffffff); }
UNDERBRUSH_INLINE F at(const float* table, I index) {
  F r;
  for (size_t l = 0; l < kLanes; ++l) r[l] = table[index[l]];
  return r;
}
UNDERBRUSH_INLINE I at(const Word* table, I index) {
  I r;
  for (size_t l = 0; l < kLanes; ++l) r[l] = table[index[l]];
  return r;
}
UNDERBRUSH_INLINE F to_float(I a) { return __builtin_convertvector(a, F); }
UNDERBRUSH_INLINE I to_int(F a) { return __builtin_convertvector(a, I); }

struct Vectors {
  F x, y, z;
};

UNDERBRUSH_INLINE Vectors vectors_of(const PixelLookUp::Vectors& v) {
  return {load(v.x.data()), load(v.y.data()), load(v.z.data())};
}

/// The beams of a call and the keyframe.
struct View {
  const LookUpGrid& grid;
  const LookUpFrame& frame;
  Vectors from, direction;

  UNDERBRUSH_INLINE Vectors point(F t) const {
    return {from.x + t * direction.x, from.y + t * direction.y, from.z + t * direction.z};
  }
  UNDERBRUSH_INLINE Vectors origin(I column) const {
    const float* x = frame.column_origin->data();
    return {at(x, 3 * column), at(x + 1, 3 * column), at(x + 2, 3 * column)};
  }
  UNDERBRUSH_INLINE const Word* words() const {
    return reinterpret_cast<const Word*>(frame.pixels);
  }
};

/// The x of pixels, and their end points relative to some points, m.
struct EndPoints {
  I x;
  Vectors to;

  UNDERBRUSH_INLINE EndPoints(const View& v, I pixel, const Vectors& from) {
    const I first = at(v.words(), 2 * pixel), second = at(v.words() + 1, 2 * pixel);
    const float unit = v.grid.unit_m;
    x = (first << 16) >> 16;
    to = {unit * to_float(x) - from.x, unit * to_float(first >> 16) - from.y,
          unit * to_float((second << 16) >> 16) - from.z};
  }
};

/// The nine pixels about the direction of a point. The order of one is the squared angle (below 2²)
/// between it and the point, as bits of a float, whose order is that of the numbers; the last four
/// bits are its place in the window. A pixel that is taken or unknown comes last.
struct Window {
  static constexpr int32_t kPlace = 15, kTaken = 0x7fffffff;
  I column;
  I order[kPixels], pixel[kPixels];
};

/// Where directions lie in the image.
struct Places {
  F column, elevation;  // pixel k has its middle at k + ½; rad
  I row;
};

/// Computes the angles of points in (−π, π] with an error below 10⁻⁶ rad.
UNDERBRUSH_INLINE F angles_of(F x, F y) {
  const F a = size_of(x), b = size_of(y);
  const F q = lesser(a, b) / greater(greater(a, b), all(FLT_MIN)), s = q * q;
  // Abramowitz and Stegun 4.4.49.
  F series = s * 0.0028662257f;
  for (const float term : {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f,
                           -0.1420889944f, 0.1999355085f, -0.3333314528f}) {
    series = s * (term + series);
  }
  F r = q * (1 + series);
  r = pick(b > a, float(M_PI / 2) - r, r);
  r = pick(x < 0, float(M_PI) - r, r);
  return pick(y < 0, -r, r);
}

/// Finds the places of points (relative to the keyframe's origin, m), seen from the origins of some
/// columns.
UNDERBRUSH_INLINE Places places_of(const View& v, const Vectors& point, I column) {
  const LookUpGrid& g = v.grid;
  const auto& m = v.frame.sensor_from_world;
  const Vectors from = v.origin(column);
  const F dx = point.x - from.x, dy = point.y - from.y, dz = point.z - from.z;
  const F x = m[0] * dx + m[1] * dy + m[2] * dz;
  const F y = m[3] * dx + m[4] * dy + m[5] * dz;
  const F z = m[6] * dx + m[7] * dy + m[8] * dz;
  Places out;
  out.elevation = angles_of(root(x * x + y * y), z);
  const auto columns = float(g.columns);
  F c = angles_of(x, y) * g.columns_a_rad;
  c = pick(c < 0, c + columns, c);
  out.column = pick(c < columns, c, F{});
  const F slot = (out.elevation - g.first) * g.slots_a_rad;
  const auto last_slot = float(g.row_below.size() - 1);
  out.row = at(g.row_below.data(), to_int(lesser(greater(slot, F{}), all(last_slot))));
  const float* elevation = g.elevation.data();
  const I last = I{} + (g.rows - 1);
  for (int32_t step = 0; step < g.steps; ++step) {
    const I next = pick(out.row < last, out.row + 1, last);
    out.row = pick(at(elevation, next) <= out.elevation, next, out.row);
  }
  const I next = pick(out.row < last, out.row + 1, last);
  const F below = out.elevation - at(elevation, out.row);
  const F above = at(elevation, next) - out.elevation;
  out.row = pick(above < below, next, out.row);
  return out;
}

/// Finds the pixels about the directions of points, as seen from the origin of `column`, which is
/// near the origins of the pixels that are found. The direction of a pixel is that of its end
/// point, or that of its middle if it has no return.
UNDERBRUSH_INLINE void pixels_about(const View& v, F t, I column, Window& out) {
  const LookUpGrid& g = v.grid;
  const Vectors point = v.point(t);
  const Places place = places_of(v, point, column);
  out.column = to_int(place.column);
  const Vectors from = v.origin(out.column);
  Vectors to{point.x - from.x, point.y - from.y, point.z - from.z};
  const F norm = root(to.x * to.x + to.y * to.y + to.z * to.z);
  to = {to.x / norm, to.y / norm, to.z / norm};
  const I is_inside = (place.elevation >= g.lowest) & (place.elevation <= g.highest);
  const F elevation =
      lesser(greater(place.elevation, all(g.elevation.front())), all(g.elevation.back()));
  I columns[3];
  F wide2[3];
  for (int32_t j = 0; j < 3; ++j) {
    const I c = out.column + (j - 1);
    const F wide = (place.column - 0.5f - to_float(c)) * g.column_rad;
    wide2[j] = wide * wide;
    columns[j] = pick(c < 0, c + g.columns, pick(c >= g.columns, c - g.columns, c));
  }
  const I last = I{} + (g.rows - 1);
  I is_there[3], rows[3];
  F high2[3];
  for (int32_t j = 0; j < 3; ++j) {
    const I row = place.row + (j - 1), is_row = (row >= 0) & (row <= last);
    const I inside = pick(is_row, row, place.row);
    const F high = elevation - at(g.elevation.data(), inside);
    is_there[j] = is_inside & is_row;
    high2[j] = high * high;
    rows[j] = inside * g.columns;
  }
  for (int32_t k = 0; k < int32_t(kPixels); ++k) {
    const I pixel = rows[k / 3] + columns[k % 3];
    const EndPoints end(v, pixel, from);
    const Vectors& e = end.to;
    const F a = e.y * to.z - e.z * to.y, b = e.z * to.x - e.x * to.z;
    const F c = e.x * to.y - e.y * to.x;
    const F norm2 = e.x * e.x + e.y * e.y + e.z * e.z;
    const F hit = (a * a + b * b + c * c) / greater(norm2, all(1e-12f));
    const F angle2 = pick(end.x == KeyframePixel::kNoReturn, high2[k / 3] + wide2[k % 3], hit);
    const I order = ((I)angle2 & ~Window::kPlace) | k;
    const I is_known = is_there[k / 3] & (end.x != KeyframePixel::kUnknown);
    out.order[k] = pick(is_known, order, I{} + Window::kTaken);
    out.pixel[k] = pixel;
  }
}

/// Finds the nearest pixels of a window, −1 where there is none, and takes them out.
UNDERBRUSH_INLINE I take_nearest(Window& w) {
  I nearest = w.order[0], pixel = I{} - 1;
  for (size_t k = 1; k < kPixels; ++k) nearest = pick(w.order[k] < nearest, w.order[k], nearest);
  for (size_t k = 0; k < kPixels; ++k) {
    const I is_it = (w.order[k] == nearest) & (nearest != Window::kTaken);
    pixel = pick(is_it, w.pixel[k], pixel);
    w.order[k] = pick(is_it, I{} + Window::kTaken, w.order[k]);
  }
  return pixel;
}

/// Finds where beams are nearest to the points of pixels, m.
UNDERBRUSH_INLINE F ranges_of(const View& v, I pixel) {
  const EndPoints end(v, pick(pixel < 0, I{}, pixel), v.from);
  const F along = end.to.x * v.direction.x + end.to.y * v.direction.y + end.to.z * v.direction.z;
  return pick(end.x > KeyframePixel::kNoReturn, greater(along, all(PixelLookUp::kLeastRangeM)),
              all(kFarM));
}

}  // namespace

UNDERBRUSH_CLONES void look_up_pixels(const LookUpGrid& grid, const LookUpFrame& frame,
                                      PixelLookUp& beams) {
  const View view{grid, frame, vectors_of(beams.from), vectors_of(beams.direction)};
  F t = all(kFarM);
  Window found, window;
  pixels_about(view, t, to_int(places_of(view, view.point(t), I{}).column), found);
  I pixel = take_nearest(found), is_moving = pixel >= 0;
  for (int step = 0; step < kSteps; ++step) {
    const F next_t = ranges_of(view, pixel);
    is_moving &= next_t != t;
    int32_t any = 0;
    for (size_t l = 0; l < kLanes; ++l) any |= is_moving[l];
    if (any == 0) break;
    t = pick(is_moving, next_t, t);
    pixels_about(view, t, found.column, window);
    const I next = take_nearest(window);
    for (size_t k = 0; k < kPixels; ++k) {
      found.order[k] = pick(is_moving, window.order[k], found.order[k]);
      found.pixel[k] = pick(is_moving, window.pixel[k], found.pixel[k]);
    }
    found.column = pick(is_moving, window.column, found.column);
    const I is_other = (next != pixel) & (next >= 0);
    pixel = pick(is_moving, next, pixel);
    is_moving &= is_other;
  }
  for (auto& rank : beams.pixel) {
    __builtin_memcpy(rank.data(), &pixel, sizeof pixel);
    pixel = take_nearest(found);
  }
}

LookUpGrid::LookUpGrid(const elements::Keyframes& k)
    : rows(int32_t(k.rows())),
      columns(int32_t(k.columns)),
      unit_m(float(k.unit_m)),
      columns_a_rad(float(double(k.columns) / (2 * M_PI))),
      column_rad(float(2 * M_PI / double(k.columns))),
      elevation(k.elevation.begin(), k.elevation.end()),
      first(elevation.front()) {
  const float last = elevation.back();
  const float low_step = rows > 1 ? elevation[1] - first : 0.02f;
  const float high_step = rows > 1 ? last - elevation[size_t(rows) - 2] : 0.02f;
  lowest = first - low_step;
  highest = last + high_step;
  const float slots = kSlotsARow * float(rows) + 1;
  slots_a_rad = slots / std::max(last - first, 1e-6f);
  // An angle that rounding puts into the slot above its own must not find too high a row.
  const float slack = 1e-5f;
  for (int32_t s = 0; s <= int32_t(slots); ++s) {
    const auto row_at = [&](float angle) {
      const auto above = std::upper_bound(elevation.begin(), elevation.end(), angle);
      return std::max(int32_t(above - elevation.begin()), 1) - 1;
    };
    row_below.push_back(row_at(first + float(s) / slots_a_rad - slack));
    steps = std::max(steps, row_at(first + float(s + 1) / slots_a_rad + slack) - row_below.back());
  }
  for (const elements::Keyframe& f : k.frames) {
    LookUpFrame frame;
    const Mat3 axes = f.sensor_from_world.toRotationMatrix();
    for (int i = 0; i < 9; ++i) frame.sensor_from_world[size_t(i)] = float(axes(i / 3, i % 3));
    frame.column_origin = f.column_origin.data();
    frame.pixels = f.pixels.data();
    frames.push_back(frame);
  }
}

}  // namespace underbrush::keyframes
