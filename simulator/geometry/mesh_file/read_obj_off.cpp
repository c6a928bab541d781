// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/read_obj_off.h"

#include <fmt/format.h>

#include "simulator/geometry/mesh_file/mesh_soup.h"
#include "simulator/geometry/mesh_file/text_cursor.h"

namespace glint::mesh_file {
namespace {

/// A corner of an OBJ face, "7", "7/1", "7//3" or "-1" (the last vertex so far), counted from 0.
std::int64_t obj_corner(const TextCursor& cursor,
                        std::string_view word,
                        std::int64_t num_vertices) {
  const std::int64_t written = cursor.to_integer(word.substr(0, word.find('/')), "a face's vertex");
  if (written > 0) {
    return written - 1;
  }
  if (written == 0 || written < -num_vertices) {
    cursor.fail(
        fmt::format("a face names vertex {}; allowed: 1 to the number of vertices, or -1 "
                    "to -{} counted back",
                    written,
                    num_vertices));
  }
  return num_vertices + written;
}

void read_obj_face(TextCursor& cursor, Soup& soup, std::vector<std::int64_t>& corners) {
  corners.clear();
  const Place place = cursor.place();
  for (std::string_view word = cursor.word_on_line(); !word.empty(); word = cursor.word_on_line()) {
    if (word == "\\") {  // the face goes on in the next line
      cursor.skip_line();
      continue;
    }
    corners.push_back(obj_corner(cursor, word, soup.num_vertices()));
  }
  soup.add_polygon(corners, place);
}

/// The counts in the head of an OFF file.
struct OffHead {
  std::int64_t num_vertices = 0;
  std::int64_t num_faces = 0;
  bool has_extras = false;  ///< vertices carry normals, colours or texture coordinates
};

OffHead read_off_head(TextCursor& cursor) {
  const std::string_view magic = cursor.next_word();
  if (magic.find('4') != std::string_view::npos || magic.find('n') != std::string_view::npos) {
    cursor.fail(fmt::format("{} is not three-dimensional; allowed: OFF, COFF, NOFF", magic));
  }
  OffHead head;
  head.has_extras = magic != "OFF";
  const std::string_view word = cursor.word_on_line();
  if (word == "BINARY") {
    cursor.fail("binary OFF cannot be read; allowed: OFF as text");
  }
  head.num_vertices = word.empty() ? cursor.integer("the number of vertices")
                                   : cursor.to_integer(word, "the number of vertices");
  head.num_faces = cursor.integer("the number of faces");
  check_count(head.num_vertices, 6, cursor.remaining(), "vertices", cursor.place());
  check_count(head.num_faces, 2, cursor.remaining(), "faces", cursor.place());
  cursor.skip_line();  // the number of edges, which nobody needs
  return head;
}

void read_off_vertex(TextCursor& cursor, Soup& soup, bool has_extras) {
  const double x = cursor.number("x");
  const double y = cursor.number("y");
  const double z = cursor.number("z");
  soup.add_vertex({x, y, z}, cursor.place());
  if (has_extras) {
    cursor.skip_line();
  }
}

void read_off_face(TextCursor& cursor, Soup& soup, std::vector<std::int64_t>& corners) {
  const std::int64_t count = cursor.integer("a face's number of corners");
  const Place place = cursor.place();
  check_count(count, 2, cursor.remaining() + 1, "corners", place);
  corners.clear();
  for (std::int64_t i = 0; i < count; ++i) {
    corners.push_back(cursor.integer("a face's vertex"));
  }
  soup.add_polygon(corners, place);
  cursor.skip_line();  // the face's colour
}

}  // namespace

bool looks_like_off(std::string_view bytes) {
  TextCursor cursor(bytes.substr(0, 2000), "");
  const std::string_view word = cursor.next_word();
  return word.size() >= 3 && word.size() <= 8 && word.ends_with("OFF") &&
         word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

TriangleMesh read_obj(std::string_view bytes, const std::string& file) {
  TextCursor cursor(bytes, file);
  Soup soup;
  std::vector<std::int64_t> corners;
  while (!cursor.at_end()) {
    const std::string_view word = cursor.word_on_line();
    if (word == "v") {
      const double x = cursor.number_on_line("x");
      const double y = cursor.number_on_line("y");
      const double z = cursor.number_on_line("z");
      soup.add_vertex({x, y, z}, cursor.place());
    } else if (word == "f") {
      read_obj_face(cursor, soup, corners);
    }
    cursor.skip_line();
  }
  return soup.take();
}

TriangleMesh read_off(std::string_view bytes, const std::string& file) {
  TextCursor cursor(bytes, file);
  const OffHead head = read_off_head(cursor);
  Soup soup;
  for (std::int64_t i = 0; i < head.num_vertices; ++i) {
    read_off_vertex(cursor, soup, head.has_extras);
  }
  std::vector<std::int64_t> corners;
  for (std::int64_t i = 0; i < head.num_faces; ++i) {
    read_off_face(cursor, soup, corners);
  }
  return soup.take();
}

}  // namespace glint::mesh_file
