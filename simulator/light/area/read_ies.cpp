// SPDX-License-Identifier: GPL-3.0-or-later
//
// The file: lines of text up to the one that begins with TILT=, then numbers only, which may stand
// on any number of lines, separated by blanks or commas.
#include "simulator/light/area/read_ies.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr double kMmPerFoot = 304.8;
constexpr double kMmPerMetre = 1000.0;
constexpr int kMaxAngles = 10000;

/// Lines, then numbers, with the place of the last one.
class IesCursor {
 public:
  IesCursor(std::string_view text, const std::string& file)
      : text_(text), file_(file), place_{.file = file, .line = 1} {}

  bool at_end() const { return position_ >= text_.size(); }

  std::string_view line() {
    begin_line_ = position_;
    std::size_t end = text_.find_first_of("\r\n", position_);
    end = end == std::string_view::npos ? text_.size() : end;
    const std::string_view line = text_.substr(position_, end - position_);
    place_ = {.file = file_, .line = line_, .column = 1};
    position_ = end;
    pass_line_end();
    return line;
  }

  /// Empty at the end of the text.
  std::string_view word() {
    while (!at_end() && is_gap(text_[position_])) {
      if (text_[position_] == '\n' || text_[position_] == '\r') {
        pass_line_end();
      } else {
        ++position_;
      }
    }
    const std::size_t begin = position_;
    place_ = {.file = file_, .line = line_, .column = static_cast<int>(begin - begin_line_) + 1};
    while (!at_end() && !is_gap(text_[position_])) {
      ++position_;
    }
    return text_.substr(begin, position_ - begin);
  }

  double number(std::string_view what) {
    std::string_view text = word();
    if (text.empty()) {
      fail(fmt::format("the file ends where {} should stand", what));
    }
    text.remove_prefix(text.front() == '+' ? 1 : 0);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      fail(fmt::format("{} is '{:.40}', must be a number", what, text));
    }
    return value;
  }

  int count(std::string_view what, int low, int high) {
    const double value = number(what);
    if (!(value >= low && value <= high) || value != std::floor(value)) {
      fail(fmt::format("{} is {:g}, must be a whole number in [{}, {}]", what, value, low, high));
    }
    return static_cast<int>(value);
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigError(place_.prefix() + message);
  }

 private:
  static bool is_gap(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == '\x1a' || c == '\0';
  }

  /// Over "\n", "\r\n" or "\r".
  void pass_line_end() {
    if (at_end()) {
      return;
    }
    const bool is_pair = text_.substr(position_, 2) == "\r\n";
    position_ += is_pair ? 2 : 1;
    ++line_;
    begin_line_ = position_;
  }

  std::string_view text_;
  std::string file_;
  std::size_t position_ = 0;
  std::size_t begin_line_ = 0;
  int line_ = 1;
  Place place_;
};

enum class Tilt { kNone, kInclude };

/// Reads up to and with the line TILT=.
Tilt read_head(IesCursor& cursor, IesTable& table) {
  while (!cursor.at_end()) {
    const std::string_view line = cursor.line();
    if (!line.starts_with("TILT=")) {
      table.keywords.emplace_back(line);
      continue;
    }
    std::string_view value = line.substr(5);
    value = value.substr(0, value.find_last_not_of(" \t") + 1);
    if (value == "NONE") {
      return Tilt::kNone;
    }
    if (value == "INCLUDE") {
      return Tilt::kInclude;
    }
    cursor.fail(fmt::format(
        "TILT is '{:.40}', must be NONE or INCLUDE (a table in another file is not read)", value));
  }
  cursor.fail("the file has no line TILT=, so it is no IES LM-63 file");
}

/// The lamp's output against the luminaire's tilt. It is checked but not applied: the table holds
/// for the position in which the light was measured.
void read_tilt(IesCursor& cursor, IesTable& table) {
  cursor.count("the lamp's position (TILT=INCLUDE)", 1, 3);
  const int pairs = cursor.count("the number of tilt angles", 1, kMaxAngles);
  for (int i = 0; i < pairs; ++i) {
    cursor.number("a tilt angle");
  }
  table.has_tilt = true;
  for (int i = 0; i < pairs; ++i) {
    const double factor = cursor.number("a tilt factor");
    table.min_tilt_factor = i == 0 ? factor : std::min(table.min_tilt_factor, factor);
    table.max_tilt_factor = i == 0 ? factor : std::max(table.max_tilt_factor, factor);
  }
}

std::vector<double> read_angles(IesCursor& cursor, int count, std::string_view what) {
  std::vector<double> angles_deg;
  for (int i = 0; i < count; ++i) {
    const double angle = cursor.number(what);
    if (!angles_deg.empty() && angle <= angles_deg.back()) {
      cursor.fail(fmt::format("{} {:g} follows {:g}, must rise", what, angle, angles_deg.back()));
    }
    angles_deg.push_back(angle);
  }
  return angles_deg;
}

/// The third factor is the ballast-lamp factor up to 1995; since 2019 the same place holds the code
/// of how the file was made, and in between a 1 for future use.
bool has_lamp_factor(const IesTable& table) {
  return table.keywords.empty() || (!table.keywords.front().starts_with("IES:LM-63-") &&
                                    !table.keywords.front().starts_with("IESNA:LM-63-2"));
}

struct Counts {
  int vertical = 0;
  int horizontal = 0;
  double factor = 1.0;  ///< of every intensity
};

void read_size(IesCursor& cursor, IesTable& table) {
  const int units = cursor.count("the units (1 feet, 2 metres)", 1, 2);
  const double mm = units == 1 ? kMmPerFoot : kMmPerMetre;
  const double width = cursor.number("the opening's width");
  const double length = cursor.number("the opening's length");
  const double height = cursor.number("the opening's height");
  constexpr double kMax_mm = 1e6;
  const double maximum = std::max({std::abs(width), std::abs(length), std::abs(height)}) * mm;
  if (maximum > kMax_mm) {
    cursor.fail(
        fmt::format("the opening is {:g} mm large, at most {:g} is allowed", maximum, kMax_mm));
  }
  // Negative sizes mean round (LM-63-2002, before by convention).
  table.is_round = width < 0.0 || length < 0.0;
  table.size_mm = Eigen::Vector3d(std::abs(length), std::abs(width), std::abs(height)) * mm;
}

Counts read_numbers(IesCursor& cursor, IesTable& table) {
  Counts counts;
  cursor.count("the number of lamps", 1, 1000000);
  table.lumens_per_lamp = cursor.number("the lumens of a lamp");
  table.is_absolute = table.lumens_per_lamp < 0.0;
  counts.factor = cursor.number("the multiplier of intensities");
  counts.vertical = cursor.count("the number of vertical angles", 2, kMaxAngles);
  counts.horizontal = cursor.count("the number of horizontal angles", 1, kMaxAngles);
  if (cursor.count("the photometric type (1 C, 2 B, 3 A)", 1, 3) != 1) {
    cursor.fail("photometry of type A or B is not read, must be type C (1)");
  }
  read_size(cursor, table);
  counts.factor *= cursor.number("the ballast factor");
  const double lamp_factor = cursor.number("the ballast-lamp factor");
  counts.factor *= has_lamp_factor(table) ? lamp_factor : 1.0;
  if (!(counts.factor > 0.0 && counts.factor <= 1e12)) {
    cursor.fail(fmt::format("the factors multiply to {:g}, must be > 0", counts.factor));
  }
  cursor.number("the input power");
  return counts;
}

void read_intensities(IesCursor& cursor, const Counts& counts, IesTable& table) {
  for (int plane = 0; plane < counts.horizontal; ++plane) {
    for (int i = 0; i < counts.vertical; ++i) {
      const double value = cursor.number("an intensity");
      if (!(value >= 0.0 && value <= 1e15)) {
        cursor.fail(fmt::format("an intensity is {:g}, must be >= 0", value));
      }
      table.intensity.push_back(value * counts.factor);
    }
  }
  if (!cursor.word().empty()) {
    cursor.fail(
        fmt::format("more numbers than {} x {} intensities", counts.horizontal, counts.vertical));
  }
}

/// Repeats the planes in the other order, reflected at the plane of that angle.
void mirror_planes(std::vector<double>& planes_deg, IesTable& table, double at_deg) {
  const std::size_t n = table.vertical_rad.size();
  for (std::size_t k = planes_deg.size(); k-- > 0;) {
    if (planes_deg[k] < at_deg) {
      planes_deg.push_back(2.0 * at_deg - planes_deg[k]);
      for (std::size_t i = 0; i < n; ++i) {
        table.intensity.push_back(table.intensity[k * n + i]);
      }
    }
  }
}

/// The intensities at a horizontal angle between the measured planes are appended.
void append_plane(const std::vector<double>& planes_deg,
                  const IesTable& table,
                  double angle_deg,
                  std::vector<double>& intensity) {
  const auto above = std::lower_bound(planes_deg.begin(), planes_deg.end(), angle_deg);
  const auto high = std::max<std::size_t>(1, static_cast<std::size_t>(above - planes_deg.begin()));
  const double share =
      (angle_deg - planes_deg[high - 1]) / (planes_deg[high] - planes_deg[high - 1]);
  const std::size_t n = table.vertical_rad.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double low = table.intensity[(high - 1) * n + i];
    intensity.push_back(low + share * (table.intensity[high * n + i] - low));
  }
}

/// Planes from 90 to 270 degrees, mirrored at 90 - 270, as planes from 0 to 360.
void unfold_side(std::vector<double>& planes_deg, IesTable& table) {
  mirror_planes(planes_deg, table, 270.0);
  // Now they run from 90 to 450; turn back what lies beyond 360 and close the circle.
  std::vector<double> angles_deg = {0.0, 360.0};
  for (const double angle : planes_deg) {
    angles_deg.push_back(angle >= 360.0 ? angle - 360.0 : angle);
  }
  std::sort(angles_deg.begin(), angles_deg.end());
  angles_deg.erase(std::unique(angles_deg.begin(), angles_deg.end()), angles_deg.end());
  std::vector<double> intensity;
  for (const double angle : angles_deg) {
    append_plane(planes_deg, table, angle < 90.0 ? angle + 360.0 : angle, intensity);
  }
  table.intensity = std::move(intensity);
  planes_deg = std::move(angles_deg);
}

/// Fills the circle from the part that was measured. @return empty, or what is wrong
std::string unfold(std::vector<double>& planes_deg, IesTable& table) {
  const double first = planes_deg.front();
  const double last = planes_deg.back();
  if (planes_deg.size() == 1) {
    planes_deg.front() = 0.0;
    return first == 0.0 ? "" : fmt::format("the only horizontal angle is {:g}, must be 0", first);
  }
  if (first == 90.0 && last == 270.0) {
    unfold_side(planes_deg, table);
    return "";
  }
  if (first != 0.0 || (last != 90.0 && last != 180.0 && last != 360.0)) {
    return fmt::format(
        "horizontal angles run from {:g} to {:g} degrees, must run from 0 to 90, 180 or 360, from "
        "90 to 270, or be 0 alone",
        first,
        last);
  }
  if (last == 90.0) {
    mirror_planes(planes_deg, table, 90.0);
  }
  if (last <= 180.0) {
    mirror_planes(planes_deg, table, 180.0);
  }
  return "";
}

std::vector<double> to_rad(const std::vector<double>& degrees) {
  std::vector<double> rad(degrees.size());
  std::ranges::transform(degrees, rad.begin(), [](double angle) { return angle * kRadPerDeg; });
  return rad;
}

}  // namespace

IesTable parse_ies(std::string_view text, const std::string& file) {
  IesCursor cursor(text, file);
  IesTable table;
  table.file = file;
  if (read_head(cursor, table) == Tilt::kInclude) {
    read_tilt(cursor, table);
  }
  const Counts counts = read_numbers(cursor, table);
  const auto vertical = read_angles(cursor, counts.vertical, "vertical angle");
  if (!(vertical.front() == 0.0 || vertical.front() == 90.0) ||
      !(vertical.back() == 90.0 || vertical.back() == 180.0)) {
    cursor.fail(fmt::format(
        "vertical angles run from {:g} to {:g} degrees, must begin at 0 or 90 and end at 90 or 180",
        vertical.front(),
        vertical.back()));
  }
  table.vertical_rad = to_rad(vertical);
  auto planes = read_angles(cursor, counts.horizontal, "horizontal angle");
  // The place of an error in the angles, before the intensities are read.
  const IesCursor after_angles = cursor;
  read_intensities(cursor, counts, table);
  if (const std::string wrong = unfold(planes, table); !wrong.empty()) {
    after_angles.fail(wrong);
  }
  table.horizontal_rad = to_rad(planes);
  return table;
}

IesTable read_ies(const std::filesystem::path& path) {
  return parse_ies(read_file(path), path.string());
}

}  // namespace glint
