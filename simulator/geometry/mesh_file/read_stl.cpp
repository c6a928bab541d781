// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/read_stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "simulator/geometry/mesh_file/mesh_soup.h"
#include "simulator/geometry/mesh_file/text_cursor.h"

namespace glint::mesh_file {
namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written as they lie");

constexpr std::size_t kHeaderBytes = 84;  // 80 of text, 4 of count
constexpr std::size_t kFacetBytes = 50;   // normal, three vertices, two bytes

std::uint32_t facet_count(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

bool has_binary_size(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes &&
         bytes.size() == kHeaderBytes + kFacetBytes * std::size_t{facet_count(bytes)};
}

bool equals_ignoring_case(std::string_view word, std::string_view lower_case) {
  return std::ranges::equal(word, lower_case, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

/// A text that begins with "solid" and whose next line begins with "facet" or "endsolid".
bool looks_like_text(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 2000);
  TextCursor cursor(head, "");
  if (!equals_ignoring_case(cursor.next_word(), "solid")) {
    return false;
  }
  cursor.skip_line();
  const std::string_view word = cursor.next_word();
  return word.empty() || equals_ignoring_case(word, "facet") ||
         equals_ignoring_case(word, "endsolid");
}

TriangleMesh read_binary(std::string_view bytes, const std::string& file) {
  const Place place = {.file = file};
  if (bytes.size() < kHeaderBytes) {
    throw ConfigError(
        fmt::format("{}{} bytes are too few for an STL file", place.prefix(), bytes.size()));
  }
  const std::size_t count = facet_count(bytes);
  if (!has_binary_size(bytes)) {
    throw ConfigError(
        fmt::format("{}the file is {} or no STL: its {} triangles need {} bytes, it has {}",
                    place.prefix(),
                    bytes.size() < kHeaderBytes + kFacetBytes * count ? "truncated" : "damaged",
                    count,
                    kHeaderBytes + kFacetBytes * count,
                    bytes.size()));
  }
  Soup soup;
  soup.reserve(3 * count, count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 9> values = {};
    std::memcpy(values.data(), bytes.data() + kHeaderBytes + kFacetBytes * i + 12, 36);
    for (std::size_t k = 0; k < 9; k += 3) {
      const Eigen::Vector3f vertex(values[k], values[k + 1], values[k + 2]);
      soup.add_vertex(vertex.cast<double>(), place);
    }
    const auto first = static_cast<std::int64_t>(3 * i);
    soup.add_polygon(std::array<std::int64_t, 3>{first, first + 1, first + 2}, place);
  }
  return soup.take();
}

void expect(TextCursor& cursor, std::string_view lower_case) {
  if (!equals_ignoring_case(cursor.next_word(), lower_case)) {
    cursor.fail(fmt::format("\"{}\" expected", lower_case));
  }
}

/// What follows the word "facet". The written normal is not used: it is often wrong or zero.
void read_facet(TextCursor& cursor, Soup& soup) {
  const Place place = cursor.place();
  cursor.skip_line();
  expect(cursor, "outer");
  expect(cursor, "loop");
  const std::int64_t first = soup.num_vertices();
  for (int i = 0; i < 3; ++i) {
    expect(cursor, "vertex");
    const double x = cursor.number("x");
    const double y = cursor.number("y");
    const double z = cursor.number("z");
    soup.add_vertex({x, y, z}, cursor.place());
  }
  soup.add_polygon(std::array<std::int64_t, 3>{first, first + 1, first + 2}, place);
  expect(cursor, "endloop");
  expect(cursor, "endfacet");
}

TriangleMesh read_text(std::string_view bytes, const std::string& file) {
  TextCursor cursor(bytes, file);
  Soup soup;
  bool is_inside = false;
  for (std::string_view word = cursor.next_word(); !word.empty(); word = cursor.next_word()) {
    if (is_inside && equals_ignoring_case(word, "facet")) {
      read_facet(cursor, soup);
    } else if (equals_ignoring_case(word, is_inside ? "endsolid" : "solid")) {
      is_inside = !is_inside;
      cursor.skip_line();
    } else {
      cursor.fail(is_inside ? R"("facet" or "endsolid" expected)" : "\"solid\" expected");
    }
  }
  if (is_inside) {
    cursor.fail("\"endsolid\" is missing: is the file truncated?");
  }
  return soup.take();
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
  return has_binary_size(bytes) || looks_like_text(bytes);
}

TriangleMesh read_stl(std::string_view bytes, const std::string& file) {
  // The size decides first: many binary files begin with "solid".
  return !has_binary_size(bytes) && looks_like_text(bytes) ? read_text(bytes, file)
                                                           : read_binary(bytes, file);
}

}  // namespace glint::mesh_file
