// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_table.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/csv.h"

namespace glint {
namespace {

/// What the columns hold.
struct Columns {
  std::optional<std::size_t> name;
  std::optional<std::size_t> stamp;
  std::size_t count = 0;
  std::vector<std::size_t> numbers;  ///< columns in the order of a pose's numbers
  bool has_named_angles = false;     ///< yaw, pitch and roll
  bool has_angle_unit = false;
};

/// Names of columns in the order in which a pose has their numbers.
struct Layout {
  std::vector<std::string> names;
  PoseRotation rotation = PoseRotation::kAuto;
};

const std::vector<Layout>& layouts() {
  static const std::vector<Layout> all = {
      {.names = {"x", "y", "z", "rx", "ry", "rz"}},
      {.names = {"x", "y", "z", "a", "b", "c"}},
      {.names = {"x", "y", "z", "yaw", "pitch", "roll"}, .rotation = PoseRotation::kEuler},
      {.names = {"x", "y", "z", "r", "p", "w"}, .rotation = PoseRotation::kEuler},
      {.names = {"x", "y", "z", "qw", "qx", "qy", "qz"}, .rotation = PoseRotation::kQuaternionWxyz},
      {.names = {"x", "y", "z", "qx", "qy", "qz", "qw"}, .rotation = PoseRotation::kQuaternionXyzw},
      {.names = {"r11", "r12", "r13", "x", "r21", "r22", "r23", "y", "r31", "r32", "r33", "z"},
       .rotation = PoseRotation::kMatrix}};
  return all;
}

/// The head of one column of numbers.
struct Heading {
  std::size_t column = 0;
  std::string name;  ///< in small letters, without its unit
  std::string unit;  ///< "mm", "m", "rad", "deg"; empty: not told
  Place place;
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

Heading heading_of(const CsvField& field, std::size_t column) {
  Heading heading = {.column = column, .name = lower(field.text), .place = field.place};
  for (const std::string_view unit : {"mm", "m", "rad", "deg"}) {
    if (heading.name.ends_with(fmt::format("_{}", unit))) {
      heading.unit = unit;
      heading.name.resize(heading.name.size() - unit.size() - 1);
      break;
    }
  }
  for (const std::string_view axis : {"x", "y", "z"}) {
    if (heading.name == fmt::format("t{}", axis) || heading.name == fmt::format("p{}", axis)) {
      heading.name = axis;
    }
  }
  return heading;
}

bool is_position(const std::string& name) {
  return name == "x" || name == "y" || name == "z";
}

std::vector<std::string> names_of(std::span<const Heading> headings) {
  std::vector<std::string> names;
  for (const Heading& heading : headings) {
    names.push_back(heading.name);
  }
  return names;
}

/// The layout whose names the columns have in any order; qw before the others: with it first.
const Layout* layout_of(std::span<const Heading> headings) {
  const std::vector<std::string> names = names_of(headings);
  const bool is_w_first = std::ranges::find(names, "qw") < std::ranges::find(names, "qx");
  for (const Layout& layout : layouts()) {
    const bool is_other_quaternion =
        layout.rotation ==
        (is_w_first ? PoseRotation::kQuaternionXyzw : PoseRotation::kQuaternionWxyz);
    if (!is_other_quaternion && std::ranges::is_permutation(layout.names, names)) {
      return &layout;
    }
  }
  return nullptr;
}

/// r, p and y beside x, y and z are roll, pitch and yaw.
void spell_out(std::vector<Heading>& headings) {
  const std::vector<std::string> names = names_of(headings);
  const auto count = [&](const char* name) { return std::ranges::count(names, name); };
  if (count("r") != 1 || count("p") != 1 || count("y") != 2) {
    return;
  }
  bool is_yaw = std::ranges::find(names, "r") < std::ranges::find(names, "y");
  for (Heading& heading : headings) {
    if (heading.name == "r" || heading.name == "p") {
      heading.name = heading.name == "r" ? "roll" : "pitch";
    } else if (heading.name == "y") {
      heading.name = is_yaw ? "yaw" : "y";
      is_yaw = !is_yaw;
    }
  }
}

/// rx, ry and rz in another order may be a vector's components or Euler angles in that order.
void check_angles_in_order(std::span<const Heading> headings, const Layout& layout) {
  if (layout.rotation != PoseRotation::kAuto) {
    return;
  }
  std::vector<std::string> angles;
  for (const Heading& heading : headings) {
    if (!is_position(heading.name)) {
      angles.push_back(heading.name);
    }
  }
  if (!std::equal(angles.begin(), angles.end(), layout.names.begin() + 3, layout.names.end())) {
    refuse_key(
        headings.front().place,
        "rotation",
        fmt::format("\"{}\", \"{}\" and \"{}\" may be a rotation vector or Euler angles that "
                    "are applied in this order: name the columns {}, {}, {} in the order in "
                    "which their numbers are meant",
                    angles[0],
                    angles[1],
                    angles[2],
                    layout.names[3],
                    layout.names[4],
                    layout.names[5]));
  }
}

/// Some names are not known: then those that are must be where the numbers are read.
void check_positions(std::span<const Heading> headings) {
  for (std::size_t i = 0; i < headings.size(); ++i) {
    bool is_known = false;
    bool is_here = false;
    for (const Layout& layout : layouts()) {
      if (layout.names.size() == headings.size()) {
        is_known = is_known || std::ranges::count(layout.names, headings[i].name) > 0;
        is_here = is_here || layout.names[i] == headings[i].name;
      }
    }
    if (is_known && !is_here) {
      refuse_key(headings[i].place,
                 "pose",
                 fmt::format("\"{}\" is the name of number {}, where a pose has another one: name "
                             "all columns, like x, y, z, rx, ry, rz or x, y, z, qx, qy, qz, qw, "
                             "or none",
                             headings[i].name,
                             i + 1));
    }
  }
}

/// The unit that all columns of one kind have; empty where none tells.
std::string unit_of(std::span<const Heading> headings, bool of_position) {
  const Heading* first = nullptr;
  for (const Heading& heading : headings) {
    if (is_position(heading.name) != of_position) {
      continue;
    }
    if (first != nullptr && heading.unit != first->unit) {
      refuse_key(heading.place,
                 of_position ? "unit" : "angle",
                 fmt::format(R"("{}" and "{}" have different units)", first->name, heading.name));
    }
    first = &heading;
  }
  return first == nullptr ? std::string() : first->unit;
}

void take_units(std::span<const Heading> headings, PoseConvention& convention) {
  const std::string length = unit_of(headings, true);
  const std::string angle = unit_of(headings, false);
  if (length == "mm" || length == "m") {
    convention.unit = length == "m" ? PoseUnit::kMetre : PoseUnit::kMillimetre;
  }
  if (angle == "rad" || angle == "deg") {
    convention.angle = angle == "deg" ? PoseAngle::kDegree : PoseAngle::kRadian;
  }
}

/// The columns of numbers in the order of the layout, or as they stand.
std::vector<std::size_t> number_columns(std::span<const Heading> headings, const Layout* layout) {
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const auto at = layout == nullptr
                        ? headings.begin() + static_cast<std::ptrdiff_t>(i)
                        : std::ranges::find(headings, layout->names[i], &Heading::name);
    columns.push_back(at->column);
  }
  return columns;
}

template <std::size_t N>
bool is_among(const std::string& word, const std::array<std::string_view, N>& words) {
  return std::ranges::find(words, word) != words.end();
}

/// Whether it is a number but for the comma in place of the point.
bool has_decimal_comma(const CsvField& field) {
  CsvField other = field;
  std::ranges::replace(other.text, ',', '.');
  return !field.number() && other.number();
}

/// A line of nothing but words is a head.
bool is_head(const CsvRow& row) {
  return row.size() > 1 && std::ranges::none_of(row, [](const CsvField& field) {
           return field.number().has_value() || has_decimal_comma(field);
         });
}

/// What else than commas may stand between columns, by its name; nullptr: nothing.
const char* other_separator(const CsvRow& row) {
  constexpr std::ptrdiff_t kMinSeparators = 5;  // of six numbers
  const std::string& first = row.front().text;
  const auto is_list = [](const CsvField& field) {
    return field.text.find(';') != std::string::npos;
  };
  // With decimal commas its lines fall apart elsewhere.
  if (std::any_of(row.begin() + 1, row.end(), is_list) ||
      std::ranges::count(first, ';') >= kMinSeparators) {
    return "semicolons";
  }
  if (row.size() == 1 && std::ranges::count(first, '\t') >= kMinSeparators) {
    return "tabs";
  }
  return row.size() == 1 && std::ranges::count(first, ' ') >= kMinSeparators ? "blanks" : nullptr;
}

void check_dialect(std::string_view text, const CsvRow& first) {
  const std::size_t end = text.find('\r');
  if (text.find('\n') == text.npos && end < text.size() - 1) {
    refuse_key(first.front().place,
               "pose",
               "lines end with a carriage return alone, must end with a line feed");
  }
  if (const char* separator = other_separator(first)) {
    refuse_key(first.front().place,
               "pose",
               fmt::format("columns are separated by {}, must be by commas, and numbers have a "
                           "point, like 12.5",
                           separator));
  }
}

Columns head_columns(const CsvRow& head, PoseConvention& convention) {
  Columns columns = {.count = head.size()};
  std::vector<Heading> headings;
  for (std::size_t i = 0; i < head.size(); ++i) {
    const std::string word = lower(head[i].text);
    if (is_among(word, kPoseNameKeys)) {
      columns.name = i;
    } else if (is_among(word, kPoseStampKeys)) {
      columns.stamp = i;
    } else {
      headings.push_back(heading_of(head[i], i));
    }
  }
  spell_out(headings);
  const Layout* layout = layout_of(headings);
  if (layout == nullptr) {
    check_positions(headings);
  } else {
    check_angles_in_order(headings, *layout);
    convention.rotation = layout->rotation;
    columns.has_named_angles = layout->rotation == PoseRotation::kEuler;
    take_units(headings, convention);
    columns.has_angle_unit = convention.angle != PoseAngle::kAuto;
  }
  columns.numbers = number_columns(headings, layout);
  return columns;
}

/// Without a head: a first column of words is names, and so is one too many of numbers.
Columns plain_columns(const std::vector<CsvRow>& rows) {
  Columns columns = {.count = rows.front().size()};
  const bool has_words = std::ranges::any_of(
      rows, [](const CsvRow& row) { return !row.front().number().has_value(); });
  if (has_words || columns.count == 8 || columns.count == 13 || columns.count == 17) {
    columns.name = 0;
  }
  for (std::size_t i = columns.name ? 1 : 0; i < columns.count; ++i) {
    columns.numbers.push_back(i);
  }
  return columns;
}

double number_in(const CsvField& field) {
  const std::optional<double> number = field.number();
  if (!number) {
    refuse_key(field.place,
               "pose",
               fmt::format("'{}' is no number{}",
                           field.text,
                           has_decimal_comma(field) ? ", its comma must be a point" : ""));
  }
  return *number;
}

WrittenPose row_pose(const CsvRow& row, const Columns& columns) {
  if (row.size() != columns.count) {
    refuse_key(row.front().place,
               "pose",
               fmt::format("has {} columns, the first line has {}", row.size(), columns.count));
  }
  WrittenPose pose = {.place = row.front().place,
                      .has_named_angles = columns.has_named_angles,
                      .has_angle_unit = columns.has_angle_unit};
  if (columns.name) {
    pose.name = row[*columns.name].text;
  }
  if (columns.stamp) {
    pose.has_stamp = true;
    pose.stamp_s = number_in(row[*columns.stamp]);
  }
  for (const std::size_t column : columns.numbers) {
    pose.numbers.push_back(number_in(row[column]));
  }
  return pose;
}

}  // namespace

PoseFile parse_pose_table(std::string_view text, const std::string& file) {
  PoseFile poses;
  std::vector<CsvRow> rows = parse_csv(text, file, '#');
  if (rows.empty()) {
    return poses;
  }
  check_dialect(text, rows.front());
  Columns columns;
  if (is_head(rows.front())) {
    columns = head_columns(rows.front(), poses.convention);
    rows.erase(rows.begin());
  } else {
    columns = plain_columns(rows);
  }
  for (const CsvRow& row : rows) {
    poses.poses.push_back(row_pose(row, columns));
  }
  return poses;
}

}  // namespace glint
