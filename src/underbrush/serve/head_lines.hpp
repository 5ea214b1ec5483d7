/// \file
/// The lines of a request's head.
#pragma once

namespace underbrush::serve {

/// Follows the bytes of a request's head and refuses lines that another program might divide or
/// read otherwise: ends of lines without CR, lines that go on in the next one, names of headers
/// with a space, and control characters. The content of such a line cannot become a second request.
class HeadLines {
 public:
  /// Takes the next byte. Returns false where it makes the head wrong.
  bool take(char byte);

 private:
  enum class Place { kRequest, kReturn, kStart, kName, kValue, kEnd };
  Place place_ = Place::kRequest;
  bool empty_ = false;  ///< Whether the line that ends is the empty one behind the head.
};

}  // namespace underbrush::serve
