// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/read_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "simulator/geometry/mesh_file/mesh_soup.h"
#include "simulator/geometry/mesh_file/text_cursor.h"

namespace glint::mesh_file {
namespace {

enum class Format { kText, kLittleEndian, kBigEndian };
enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

constexpr std::array<std::size_t, 8> kScalarBytes = {1, 1, 2, 2, 4, 4, 4, 8};

std::size_t bytes_of(Scalar type) {
  return kScalarBytes[static_cast<std::size_t>(type)];
}

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat;
  std::optional<Scalar> count_type;  ///< of a list
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

struct Head {
  Format format = Format::kText;
  std::vector<Element> elements;
};

Scalar to_scalar(const TextCursor& cursor, std::string_view word) {
  constexpr std::array<std::string_view, 8> kOld = {
      "char", "uchar", "short", "ushort", "int", "uint", "float", "double"};
  constexpr std::array<std::string_view, 8> kNew = {
      "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  for (std::size_t i = 0; i < kOld.size(); ++i) {
    if (word == kOld[i] || word == kNew[i]) {
      return static_cast<Scalar>(i);
    }
  }
  cursor.fail(
      "unknown type in the header; allowed: char, uchar, short, ushort, int, uint, float, "
      "double");
}

Format to_format(const TextCursor& cursor, std::string_view word) {
  if (word == "ascii") {
    return Format::kText;
  }
  if (word == "binary_little_endian") {
    return Format::kLittleEndian;
  }
  if (word != "binary_big_endian") {
    cursor.fail("unknown format; allowed: ascii, binary_little_endian, binary_big_endian");
  }
  return Format::kBigEndian;
}

Property read_property(TextCursor& cursor) {
  Property property;
  std::string_view word = cursor.word_on_line();
  if (word == "list") {
    property.count_type = to_scalar(cursor, cursor.word_on_line());
    word = cursor.word_on_line();
  }
  property.type = to_scalar(cursor, word);
  property.name = cursor.word_on_line();
  return property;
}

Element read_element(TextCursor& cursor) {
  Element element = {.name = std::string(cursor.word_on_line()), .count = 0, .properties = {}};
  element.count = cursor.to_integer(cursor.word_on_line(), "an element's count");
  return element;
}

Head read_head(TextCursor& cursor) {
  Head head;
  bool has_format = false;
  cursor.skip_line();  // "ply"
  for (;;) {
    const std::string_view word = cursor.next_word();
    if (word == "end_header") {
      break;
    }
    if (word == "format") {
      head.format = to_format(cursor, cursor.word_on_line());
      has_format = true;
    } else if (word == "element") {
      head.elements.push_back(read_element(cursor));
    } else if (word == "property" && !head.elements.empty()) {
      head.elements.back().properties.push_back(read_property(cursor));
    } else if (word != "comment" && word != "obj_info") {
      cursor.fail(word.empty() ? "\"end_header\" is missing" : "unknown line in the header");
    }
    cursor.skip_line();
  }
  if (!has_format) {
    cursor.fail("the header names no format");
  }
  cursor.skip_line();
  return head;
}

/// The values after the header, one by one, whatever the format.
class Body {
 public:
  Body(std::string_view bytes, TextCursor& cursor, Format format)
      : bytes_(bytes), cursor_(cursor), format_(format), position_(cursor.position()) {
    binary_place_.file = cursor.place().file;
  }

  double next(Scalar type, std::string_view what) {
    if (format_ == Format::kText) {
      return cursor_.number(what);
    }
    const std::size_t size = bytes_of(type);
    if (bytes_.size() - position_ < size) {
      throw ConfigError(
          fmt::format("{}the file ends in the middle of {}", binary_place_.prefix(), what));
    }
    std::array<char, 8> raw = {};
    std::memcpy(raw.data(), bytes_.data() + position_, size);
    position_ += size;
    if (format_ == Format::kBigEndian) {
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return decode(raw, type);
  }

  /// A value that must be a whole number.
  std::int64_t next_integer(Scalar type, std::string_view what) {
    const double value = next(type, what);
    if (value != std::floor(value) || std::abs(value) > 4294967296.0) {
      throw ConfigError(fmt::format("{}{} is no whole number", place().prefix(), what));
    }
    return static_cast<std::int64_t>(value);
  }

  std::size_t remaining() const {
    return format_ == Format::kText ? cursor_.remaining() + 1 : bytes_.size() - position_;
  }

  /// The least a value takes in the file.
  std::size_t min_bytes(Scalar type) const { return format_ == Format::kText ? 2 : bytes_of(type); }

  const Place& place() const { return format_ == Format::kText ? cursor_.place() : binary_place_; }

 private:
  template <class T>
  static double value_of(const std::array<char, 8>& raw) {
    T value = {};
    std::memcpy(&value, raw.data(), sizeof value);
    return static_cast<double>(value);
  }

  static double decode(const std::array<char, 8>& raw, Scalar type) {
    switch (type) {
      case Scalar::kInt8:
        return value_of<std::int8_t>(raw);
      case Scalar::kUint8:
        return value_of<std::uint8_t>(raw);
      case Scalar::kInt16:
        return value_of<std::int16_t>(raw);
      case Scalar::kUint16:
        return value_of<std::uint16_t>(raw);
      case Scalar::kInt32:
        return value_of<std::int32_t>(raw);
      case Scalar::kUint32:
        return value_of<std::uint32_t>(raw);
      case Scalar::kFloat:
        return value_of<float>(raw);
      case Scalar::kDouble:
        return value_of<double>(raw);
    }
    return 0.0;
  }

  std::string_view bytes_;
  TextCursor& cursor_;
  Format format_;
  std::size_t position_;
  Place binary_place_;
};

void check_element(const Element& element, const Body& body) {
  std::size_t minimum = 0;
  for (const Property& property : element.properties) {
    minimum += body.min_bytes(property.count_type.value_or(property.type));
  }
  check_count(element.count, minimum, body.remaining(), element.name, body.place());
}

/// The numbers of a list; a count beyond the end of the file runs into its end.
void read_values(Body& body,
                 const Property& property,
                 std::string_view what,
                 std::vector<std::int64_t>& values) {
  const std::int64_t count = body.next_integer(*property.count_type, what);
  values.clear();
  for (std::int64_t i = 0; i < count; ++i) {
    values.push_back(body.next_integer(property.type, what));
  }
}

void skip_list(Body& body, const Property& property) {
  const std::int64_t count = body.next_integer(*property.count_type, property.name);
  for (std::int64_t i = 0; i < count; ++i) {
    body.next(property.type, property.name);
  }
}

void read_vertices(Body& body, const Element& element, Soup& soup) {
  for (std::int64_t i = 0; i < element.count; ++i) {
    const std::string what = fmt::format("vertex {}", i);
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
    for (const Property& property : element.properties) {
      if (property.count_type) {
        skip_list(body, property);
        continue;
      }
      const double value = body.next(property.type, what);
      if (property.name == "x" || property.name == "y" || property.name == "z") {
        vertex[property.name[0] - 'x'] = value;
      }
    }
    soup.add_vertex(vertex, body.place());
  }
}

bool is_corner_list(const Property& property) {
  return property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

using Colour = std::array<std::uint8_t, 3>;

/// 0 red, 1 green, 2 blue, 3 none of them.
std::size_t channel_of(const Property& property) {
  constexpr std::array<std::string_view, 3> kChannels = {"red", "green", "blue"};
  return property.count_type ? kChannels.size()
                             : static_cast<std::size_t>(
                                   std::ranges::find(kChannels, property.name) - kChannels.begin());
}

std::uint8_t to_channel(double value, Scalar type) {
  const bool is_share = type == Scalar::kFloat || type == Scalar::kDouble;
  const double level = std::round(is_share ? 255.0 * value : value);
  return static_cast<std::uint8_t>(level >= 0.0 ? std::min(level, 255.0) : 0.0);  // also for NaN
}

/// What is wanted of the faces besides their corners; each list grows by one per triangle.
struct Wanted {
  std::vector<Colour>* colours = nullptr;  ///< null: not wanted
  std::string_view name = {};
  std::vector<std::int32_t>* values = nullptr;  ///< of the property of that name; null: not wanted

  bool is_that(const Property& property) const {
    return values != nullptr && property.name == name && !property.count_type;
  }
};

std::int32_t read_wanted(Body& body, const Property& property, std::string_view what) {
  const std::int64_t value = body.next_integer(property.type, what);
  if (value < std::numeric_limits<std::int32_t>::min() ||
      value > std::numeric_limits<std::int32_t>::max()) {
    throw ConfigError(fmt::format("{}{}: {} = {} needs more than 32 bits",
                                  body.place().prefix(),
                                  what,
                                  property.name,
                                  value));
  }
  return static_cast<std::int32_t>(value);
}

void read_faces(Body& body, const Element& element, Soup& soup, const Wanted& wanted) {
  std::vector<std::int64_t> corners;
  for (std::int64_t i = 0; i < element.count; ++i) {
    const std::string what = fmt::format("face {}", i);
    std::array<std::uint8_t, 4> channels = {};
    std::int32_t value = 0;
    for (const Property& property : element.properties) {
      if (is_corner_list(property)) {
        read_values(body, property, what, corners);
        soup.add_polygon(corners, body.place());
      } else if (wanted.is_that(property)) {
        value = read_wanted(body, property, what);
      } else if (property.count_type) {
        skip_list(body, property);
      } else {
        channels[channel_of(property)] = to_channel(body.next(property.type, what), property.type);
      }
    }
    if (wanted.colours != nullptr) {
      wanted.colours->resize(soup.num_triangles(), {channels[0], channels[1], channels[2]});
    }
    if (wanted.values != nullptr) {
      wanted.values->resize(soup.num_triangles(), value);
    }
  }
}

void skip_element(Body& body, const Element& element) {
  for (std::int64_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) {
      if (property.count_type) {
        skip_list(body, property);
      } else {
        body.next(property.type, property.name);
      }
    }
  }
}

bool has_coordinates(const Element& element) {
  return std::ranges::all_of(std::array<std::string_view, 3>{"x", "y", "z"}, [&](auto name) {
    return std::ranges::any_of(element.properties, [&](const Property& property) {
      return property.name == name && !property.count_type;
    });
  });
}

bool has_colours(const Element& element) {
  std::array<bool, 4> has = {};
  for (const Property& property : element.properties) {
    has[channel_of(property)] = true;
  }
  return has[0] && has[1] && has[2];
}

/// @throws ConfigError when the faces have not what is wanted of them
void check_wanted(const Element& element, const Wanted& wanted, const std::string& file) {
  if (wanted.colours != nullptr && !has_colours(element)) {
    throw ConfigError(Place{.file = file}.prefix() +
                      "the faces have no colours (properties red, green and blue)");
  }
  const bool has_values = std::ranges::any_of(
      element.properties, [&](const Property& property) { return wanted.is_that(property); });
  if (wanted.values != nullptr && !has_values) {
    throw ConfigError(
        fmt::format("{}the faces have no {}", Place{.file = file}.prefix(), wanted.name));
  }
}

TriangleMesh read_body(std::string_view bytes, const std::string& file, const Wanted& wanted) {
  TextCursor cursor(bytes, file);
  const Head head = read_head(cursor);
  Body body(bytes, cursor, head.format);
  Soup soup;
  for (const Element& element : head.elements) {
    if (element.properties.empty()) {
      continue;  // nothing of it is in the file, whatever its count
    }
    check_element(element, body);
    if (element.name == "vertex") {
      if (!has_coordinates(element)) {
        throw ConfigError(Place{.file = file}.prefix() + "the vertices have no x, y and z");
      }
      read_vertices(body, element, soup);
    } else if (element.name == "face") {
      check_wanted(element, wanted, file);
      read_faces(body, element, soup, wanted);
    } else {
      skip_element(body, element);
    }
  }
  return soup.take();
}

}  // namespace

TriangleMesh read_ply(std::string_view bytes, const std::string& file) {
  return read_body(bytes, file, {});
}

TriangleMesh read_ply(std::string_view bytes,
                      const std::string& file,
                      std::vector<Colour>& colours) {
  return read_body(bytes, file, {.colours = &colours});
}

TriangleMesh read_ply(std::string_view bytes,
                      const std::string& file,
                      std::string_view property,
                      std::vector<std::int32_t>& values) {
  return read_body(bytes, file, {.name = property, .values = &values});
}

}  // namespace glint::mesh_file
