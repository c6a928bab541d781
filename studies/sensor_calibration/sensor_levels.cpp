// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/sensor_calibration/sensor_levels.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "core/csv.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  for (const std::string& word : split(line, ' ')) {
    if (!word.empty()) {
      words.push_back(word);
    }
  }
  return words;
}

double number_at(const std::vector<std::string>& words, std::size_t i, const std::string& place) {
  double value = 0.0;
  const std::string text = i < words.size() ? words[i] : std::string();
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size() || !std::isfinite(value) ||
      value < 0.0) {
    throw ConfigError(fmt::format("{}: '{}' must be a number >= 0", place, text));
  }
  return value;
}

/// The reference data of EMVA write Windows' separators.
std::string with_slashes(std::string path) {
  std::ranges::replace(path, '\\', '/');
  return path;
}

/// Where a table names its pictures. One that is listed twice is no second picture: within a level
/// it would hide noise, in another one it was not taken there.
class PicturePlaces {
 public:
  /// @param place  of the picture in the table, as errors begin: "levels.csv:3:1: "
  /// @throws ConfigError where it was named before
  void add(const fs::path& picture, const std::string& place, int line) {
    const auto [first, is_new] = lines_.emplace(picture.lexically_normal(), line);
    if (!is_new) {
      throw ConfigError(
          fmt::format("{}file: {} is listed in line {} already; each picture counts once",
                      place,
                      picture.filename().string(),
                      first->second));
    }
  }

 private:
  std::map<fs::path, int> lines_;
};

/// The level of these numbers, begun when there is none.
LevelFiles& level_of(std::vector<LevelFiles>& levels, const LevelFiles& wanted) {
  const auto found = std::ranges::find_if(levels, [&](const LevelFiles& level) {
    return level.is_dark == wanted.is_dark && level.exposure == wanted.exposure &&
           level.photons == wanted.photons;
  });
  return found != levels.end() ? *found : levels.emplace_back(wanted);
}

void check_levels(const std::vector<LevelFiles>& levels, const fs::path& file) {
  if (levels.empty()) {
    throw ConfigError(fmt::format("{}: has no levels", file.string()));
  }
  for (const LevelFiles& level : levels) {
    if (level.pictures.size() < 2) {
      throw ConfigError(
          fmt::format("{}: the {} level of exposure {} has {} picture{}; noise needs "
                      "two or more of each level",
                      file.string(),
                      level.is_dark ? "dark" : "bright",
                      shortest(level.exposure),
                      level.pictures.size(),
                      level.pictures.size() == 1 ? "" : "s"));
    }
  }
}

/// A column of a table of levels; throws where it is needed and missing.
const CsvField* field_of(const CsvRow& head,
                         const CsvRow& row,
                         std::string_view name,
                         bool is_needed) {
  const auto column = std::ranges::find(head, name, &CsvField::text) - head.begin();
  if (column < std::ssize(head) && column < std::ssize(row)) {
    return &row[static_cast<std::size_t>(column)];
  }
  if (is_needed) {
    throw ConfigError(fmt::format("{}has no {}", row.front().place.prefix(), name));
  }
  return nullptr;
}

double csv_number(const CsvField& field, std::string_view name) {
  const auto value = field.number();
  if (!value || !std::isfinite(*value) || *value < 0.0) {
    throw ConfigError(fmt::format("{}{}: must be a number >= 0", field.place.prefix(), name));
  }
  return *value;
}

}  // namespace

std::vector<LevelFiles> parse_levels_txt(std::string_view text, const fs::path& file) {
  std::vector<LevelFiles> levels;
  PicturePlaces places;
  int number = 0;
  for (std::string line : split(text, '\n')) {
    std::erase(line, '\r');
    const std::string place = fmt::format("{}:{}", file.string(), ++number);
    const std::vector<std::string> words = words_of(line);
    if (words.empty() || words[0].starts_with('#')) {
      continue;
    }
    if (words[0] == "b" || words[0] == "d") {
      LevelFiles level{.is_dark = words[0] == "d", .exposure = number_at(words, 1, place)};
      level.photons = !level.is_dark && words.size() > 2 ? number_at(words, 2, place) : 0.0;
      levels.push_back(std::move(level));
    } else if (words[0] == "i") {
      if (levels.empty() || words.size() < 2) {
        throw ConfigError(
            fmt::format("{}: a picture, \"i FILE\", must follow a level, \"b EXPOSURE PHOTONS\" or "
                        "\"d EXPOSURE\"",
                        place));
      }
      const fs::path picture = file.parent_path() / with_slashes(line.substr(line.find('i') + 2));
      places.add(picture, place + ": ", number);
      levels.back().pictures.push_back(picture);
    }
  }
  check_levels(levels, file);
  return levels;
}

std::vector<LevelFiles> parse_levels_csv(std::string_view text, const fs::path& file) {
  std::vector<LevelFiles> levels;
  PicturePlaces places;
  const std::vector<CsvRow> rows = parse_csv(text, file.string(), '#');
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const CsvField& kind = *field_of(rows[0], rows[i], "kind", true);
    if (kind.text != "bright" && kind.text != "dark") {
      throw ConfigError(
          fmt::format("{}kind: is '{}', must be bright or dark", kind.place.prefix(), kind.text));
    }
    LevelFiles level{.is_dark = kind.text == "dark"};
    level.exposure = csv_number(*field_of(rows[0], rows[i], "exposure", true), "exposure");
    const CsvField* photons = field_of(rows[0], rows[i], "photons", false);
    if (photons != nullptr && !photons->text.empty()) {
      level.photons = csv_number(*photons, "photons");
    }
    const CsvField& name = *field_of(rows[0], rows[i], "file", true);
    const fs::path picture = file.parent_path() / name.text;
    places.add(picture, name.place.prefix(), name.place.line);
    level_of(levels, level).pictures.push_back(picture);
  }
  check_levels(levels, file);
  return levels;
}

std::vector<LevelFiles> read_levels(const fs::path& folder) {
  std::error_code ignored;
  if (const fs::path file = folder / "levels.csv"; fs::is_regular_file(file, ignored)) {
    return parse_levels_csv(read_file(file), file);
  }
  const fs::path file = folder / "levels.txt";
  if (!fs::is_regular_file(file, ignored)) {
    throw ConfigError(
        fmt::format("{}: holds neither levels.csv (file,kind,exposure,photons) nor "
                    "levels.txt, which list the levels of light",
                    folder.string()));
  }
  return parse_levels_txt(read_file(file), file);
}

CodeRange code_range(unsigned all_bits) {
  const auto used = static_cast<int>(std::bit_width(all_bits));
  // Cameras put 10 and 12 bits at the upper end of 16, or at the lower one.
  const int zeros = all_bits == 0 ? 0 : std::countr_zero(all_bits);
  const bool is_shifted = used == 16 && (zeros == 4 || zeros == 6);
  CodeRange range{.shift = is_shifted ? zeros : 0};
  for (const int bits : {8, 10, 12, 16}) {
    range.bits = bits;
    if (used - range.shift <= bits) {
      break;
    }
  }
  return range;
}

CodeRange told_range(int bits, unsigned all_bits) {
  const int unused = 16 - bits;
  const bool is_shifted =
      std::bit_width(all_bits) == 16 && std::countr_zero(all_bits) >= unused && unused > 0;
  const CodeRange range{.bits = bits, .shift = is_shifted ? unused : 0};
  if ((all_bits >> range.shift) >= (1U << static_cast<unsigned>(bits))) {
    throw ConfigError(fmt::format("--bits {}: the pictures hold larger codes, up to {} bits",
                                  bits,
                                  code_range(all_bits).bits));
  }
  return range;
}

}  // namespace glint
