// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/calibration/corner_bank_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"

namespace glint {
namespace {

using BankJson = nlohmann::ordered_json;

constexpr int kBankSchema = 1;

double rounded(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit;
}

std::string header_line(const BankHeader& header) {
  const BankJson json = {{"schema", kBankSchema},
                         {"seed", header.seed},
                         {"scene", header.scene},
                         {"inputs", header.inputs}};
  return json.dump() + "\n";
}

std::string picture_line(const BankPicture& picture, std::size_t number) {
  BankJson corners = BankJson::array();
  for (const BankCorner& corner : picture.corners) {
    corners.push_back(BankJson::array({rounded(corner.error_px.x(), 1e4),
                                       rounded(corner.error_px.y(), 1e4),
                                       rounded(corner.blur_px, 1e3),
                                       rounded(corner.distance_mm, 10.0),
                                       rounded(corner.radius_px, 10.0)}));
  }
  const BankJson json = {{"picture", number},
                         {"outcome", picture.outcome},
                         {"f_number", picture.f_number},
                         {"tilt_deg", rounded(picture.tilt_deg, 1e3)},
                         {"turn_deg", rounded(picture.turn_deg, 1e3)},
                         {"corners", std::move(corners)}};
  return json.dump() + "\n";
}

BankPicture picture_of(const BankJson& json) {
  BankPicture picture{.outcome = json.at("outcome").get<std::string>(),
                      .f_number = json.at("f_number").get<double>(),
                      .tilt_deg = json.at("tilt_deg").get<double>(),
                      .turn_deg = json.at("turn_deg").get<double>()};
  for (const BankJson& corner : json.at("corners")) {
    picture.corners.push_back({.error_px = {corner.at(0).get<double>(), corner.at(1).get<double>()},
                               .blur_px = corner.at(2).get<double>(),
                               .distance_mm = corner.at(3).get<double>(),
                               .radius_px = corner.at(4).get<double>()});
  }
  return picture;
}

/// A bank's text, line by line.
class BankReader {
 public:
  explicit BankReader(const std::filesystem::path& path)
      : path_(path), text_(read_file(path)), left_(text_) {}

  /// The next whole line; none at the end, where a line that was cut off is left out.
  std::optional<std::string_view> next() {
    const std::size_t end = left_.find('\n');
    if (end == std::string_view::npos) {
      return std::nullopt;
    }
    ++line_;
    const std::string_view line = left_.substr(0, end);
    left_.remove_prefix(end + 1);
    return line;
  }

  BankHeader header() {
    const BankJson json = parsed(next().value_or(std::string_view()));
    return made([&] {
      if (json.at("schema").get<int>() != kBankSchema) {
        fail("schema", fmt::format("is {}, must be {}", json.at("schema").dump(), kBankSchema));
      }
      return BankHeader{.seed = json.at("seed").get<std::uint64_t>(),
                        .scene = json.at("scene").get<std::string>(),
                        .inputs = json.value("inputs", std::string())};
    });
  }

  std::vector<BankPicture> pictures() {
    std::vector<BankPicture> result;
    while (const auto line = next()) {
      const BankJson json = parsed(*line);
      result.push_back(made([&] {
        if (json.at("picture").get<std::size_t>() != result.size()) {
          fail("picture",
               fmt::format("is {}, must be {}", json.at("picture").dump(), result.size()));
        }
        return picture_of(json);
      }));
    }
    return result;
  }

  /// All whole lines.
  std::string whole() const { return text_.substr(0, text_.size() - left_.size()); }

  [[noreturn]] void fail(const std::string& key, const std::string& text) const {
    throw ConfigError(
        Problem{.place = {.file = path_.string(), .line = std::max(1, line_), .column = 1},
                .key = key,
                .text = text});
  }

 private:
  BankJson parsed(std::string_view line) const {
    BankJson json = BankJson::parse(line, nullptr, false);
    if (!json.is_object()) {
      fail("", "is no JSON object, which each line must be");
    }
    return json;
  }

  /// What a function makes of a line; what it lacks is told with the line.
  template <class Make>
  auto made(const Make& make) const -> decltype(make()) {
    try {
      return make();
    } catch (const BankJson::exception& error) {
      fail("", fmt::format("is no line of a corner bank: {}", error.what()));
    }
  }

  const std::filesystem::path& path_;
  std::string text_;
  std::string_view left_;
  int line_ = 0;
};

void check_header(const BankReader& reader, const BankHeader& found, const BankHeader& wanted) {
  const char* what = "the bank's pictures are others: give another file or remove this one";
  if (found.seed != wanted.seed) {
    reader.fail("seed", fmt::format("is {}, must be {}; {}", found.seed, wanted.seed, what));
  }
  if (found.scene != wanted.scene) {
    reader.fail("scene",
                fmt::format(R"(is "{}", must be "{}"; {})", found.scene, wanted.scene, what));
  }
  if (found.inputs != wanted.inputs) {
    reader.fail("inputs", fmt::format("is that of another study or board; {}", what));
  }
}

}  // namespace

CornerBankFile::CornerBankFile(std::filesystem::path path, const BankHeader& header)
    : path_(std::move(path)), text_(header_line(header)) {
  if (!is_there(path_)) {
    return;
  }
  BankReader reader(path_);
  check_header(reader, reader.header(), header);
  pictures_ = reader.pictures();
  text_ = reader.whole();
}

void CornerBankFile::append(const BankPicture& picture) {
  const std::string line = picture_line(picture, pictures_.size());
  write_file(path_, text_ + line);
  text_ += line;
  pictures_.push_back(picture_of(BankJson::parse(line)));
}

std::vector<BankPicture> read_corner_bank(const std::filesystem::path& path) {
  BankReader reader(path);
  reader.header();
  return reader.pictures();
}

}  // namespace glint
