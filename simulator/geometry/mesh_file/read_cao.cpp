// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/read_cao.h"

#include <cstdint>
#include <vector>

#include "simulator/geometry/mesh_file/mesh_soup.h"
#include "simulator/geometry/mesh_file/text_cursor.h"

namespace glint::mesh_file {
namespace {

/// A section's count. @param bytes_each  that each of its entries takes at least
std::int64_t count_of(TextCursor& cursor, std::string_view what, std::size_t bytes_each) {
  const std::int64_t count = cursor.integer("the number of " + std::string(what));
  check_count(count, bytes_each, cursor.remaining() + 1, what, cursor.place());
  return count;
}

void read_points(TextCursor& cursor, Soup& soup) {
  const std::int64_t count = count_of(cursor, "3D points", 6);
  for (std::int64_t i = 0; i < count; ++i) {
    const double x = cursor.number("x");
    const double y = cursor.number("y");
    const double z = cursor.number("z");
    soup.add_vertex({x, y, z}, cursor.place());
    cursor.skip_line();
  }
}

/// Each line of the file holds two points, or a face by lines and then names and levels of detail.
void read_over_lines(TextCursor& cursor) {
  const std::int64_t lines = count_of(cursor, "3D lines", 4);
  for (std::int64_t i = 0; i < lines; ++i) {
    cursor.integer("a line's first point");
    cursor.integer("a line's last point");
    cursor.skip_line();
  }
  if (count_of(cursor, "faces from 3D lines", 2) > 0) {
    cursor.fail("faces given by lines are not read; give them by points");
  }
}

void read_faces(TextCursor& cursor, Soup& soup) {
  const std::int64_t count = count_of(cursor, "faces from 3D points", 2);
  std::vector<std::int64_t> corners;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t size = count_of(cursor, "corners", 2);
    const Place place = cursor.place();
    corners.clear();
    for (std::int64_t k = 0; k < size; ++k) {
      corners.push_back(cursor.integer("a face's point"));
    }
    soup.add_polygon(corners, place);
    cursor.skip_line();
  }
}

void refuse_round(TextCursor& cursor, std::string_view what) {
  const std::string_view word = cursor.next_word();
  if (!word.empty() && cursor.to_integer(word, what) != 0) {
    cursor.fail(std::string(what) + " are not read; convert the model to triangles");
  }
}

}  // namespace

bool looks_like_cao(std::string_view bytes) {
  TextCursor cursor(bytes.substr(0, 4000), "");
  return cursor.next_word() == "V1";
}

TriangleMesh read_cao(std::string_view bytes, const std::string& file) {
  TextCursor cursor(bytes, file);
  cursor.next_word();  // V1
  Soup soup;
  read_points(cursor, soup);
  read_over_lines(cursor);
  read_faces(cursor, soup);
  refuse_round(cursor, "cylinders");
  refuse_round(cursor, "circles");
  return soup.take();
}

}  // namespace glint::mesh_file
