// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/picture_sequence.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/image/image_io.h"
#include "metrics/inspection/aspect.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 9> kExtensions = {
    ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".pgm", ".ppm", ".pnm", ".exr"};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// The digits that a text begins with, without leading zeros.
std::string_view number_at(std::string_view text, std::size_t& size) {
  size = 0;
  while (size < text.size() && is_digit(text[size])) {
    ++size;
  }
  std::string_view number = text.substr(0, size);
  while (number.size() > 1 && number.front() == '0') {
    number.remove_prefix(1);
  }
  return number;
}

bool is_picture_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return !path.filename().string().starts_with(".") &&
         std::ranges::find(kExtensions, extension) != kExtensions.end();
}

/// What must be known of a picture before it is one of a sequence.
struct Facts {
  std::optional<std::size_t> not_finite;  ///< index of the first such value
  bool is_black = true;                   ///< no value above 0
  bool is_full = true;                    ///< all at the largest code
  bool uses_12_bits = false;              ///< 16-bit codes, all below 4096
};

template <class Value>
Facts facts_of(const Image<Value>& image) {
  Facts facts;
  Value largest = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const Value value = image.values()[i];
    if constexpr (std::is_integral_v<Value>) {
      facts.is_full = facts.is_full && value == std::numeric_limits<Value>::max();
    } else {
      facts.is_full = false;
      if (!std::isfinite(value) && !facts.not_finite) {
        facts.not_finite = i;
      }
    }
    facts.is_black = facts.is_black && !(value > 0);
    largest = std::max(largest, value);
  }
  facts.uses_12_bits = std::is_same_v<Value, std::uint16_t> && largest < 4096;
  return facts;
}

struct ReadPicture {
  Picture picture;
  Facts facts;
};

void check_one_size(const std::vector<ReadPicture>& pictures, const std::vector<fs::path>& files) {
  const Picture& first = pictures.front().picture;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    const Picture& picture = pictures[i].picture;
    if (picture.width() != first.width() || picture.height() != first.height()) {
      throw ConfigError(fmt::format(
          "{}: is {} x {} pixels, but {} is {} x {}: the pictures of a part must have one size",
          files[i].string(),
          picture.width(),
          picture.height(),
          files.front().string(),
          first.width(),
          first.height()));
    }
  }
}

void check_finite(const std::vector<ReadPicture>& pictures, const std::vector<fs::path>& files) {
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (const auto index = pictures[i].facts.not_finite) {
      const auto width = static_cast<std::size_t>(pictures[i].picture.width());
      throw ConfigError(fmt::format("{}: the value of pixel ({}, {}) is no finite number",
                                    files[i].string(),
                                    *index % width,
                                    *index / width));
    }
  }
}

std::string names_of(const std::vector<fs::path>& files) {
  return files.size() == 1
             ? files.front().string()
             : fmt::format("{} to {}", files.front().string(), files.back().filename().string());
}

void check_light(const std::vector<ReadPicture>& pictures, const std::vector<fs::path>& files) {
  const auto all = [&](bool Facts::*is_so) {
    return std::ranges::all_of(pictures, [&](const ReadPicture& p) { return p.facts.*is_so; });
  };
  if (all(&Facts::is_black)) {
    throw ConfigError(names_of(files) + ": black all over, there is nothing to inspect");
  }
  if (all(&Facts::is_full)) {
    throw ConfigError(names_of(files) +
                      ": at full scale all over, no defect can show; expose for a shorter time");
  }
}

/// Files in natural order. @return whether they were not
bool sort_files(std::vector<fs::path>& files) {
  const auto by_name = [](const fs::path& a, const fs::path& b) {
    return natural_less(a.string(), b.string());
  };
  const bool was_sorted = std::ranges::is_sorted(files, by_name);
  std::ranges::sort(files, by_name);
  const auto twice = std::ranges::adjacent_find(files);
  if (twice != files.end()) {
    throw ConfigError(twice->string() + ": is given twice");
  }
  return !was_sorted;
}

template <class Frame>
std::vector<Frame> taken_frames(std::vector<ReadPicture>& pictures) {
  std::vector<Frame> frames;
  for (ReadPicture& read : pictures) {
    frames.push_back(std::move(std::get<Frame>(read.picture.pixels)));
  }
  return frames;
}

template <class Frame>
bool all_are(const std::vector<ReadPicture>& pictures) {
  return std::ranges::all_of(pictures, [](const ReadPicture& read) {
    return std::holds_alternative<Frame>(read.picture.pixels);
  });
}

void take_frames(std::vector<ReadPicture>& pictures, PictureSequence& sequence) {
  using Frame8 = Image<std::uint8_t>;
  using Frame16 = Image<std::uint16_t>;
  if (all_are<Frame8>(pictures)) {
    sequence.frames = taken_frames<Frame8>(pictures);
  } else if (all_are<Frame16>(pictures)) {
    sequence.frames = taken_frames<Frame16>(pictures);
  } else {
    std::vector<ImageF> frames;
    for (ReadPicture& read : pictures) {
      frames.push_back(linear_values(read.picture.pixels));
      read.picture.pixels = ImageF();
    }
    sequence.frames = std::move(frames);
  }
}

void describe(const std::vector<ReadPicture>& pictures, PictureSequence& sequence) {
  bool is_mixed = false;
  bool has_more = false;
  for (const auto& [picture, facts] : pictures) {
    is_mixed = is_mixed || picture.bits != pictures.front().picture.bits;
    has_more = has_more || picture.has_more;
    sequence.bits = std::max(sequence.bits, picture.bits);
    sequence.is_float = sequence.is_float || picture.is_float;
    sequence.channels = std::max(sequence.channels, picture.channels);
  }
  if (sequence.channels >= 3) {
    sequence.notes.emplace_back("The pictures have colours: their luminance was inspected.");
  } else if (sequence.channels == 2) {
    sequence.notes.emplace_back("The pictures have two channels: the first one was inspected.");
  }
  if (is_mixed) {
    sequence.notes.emplace_back(
        "The pictures differ in depth; all were brought to one full scale.");
  }
  if (has_more) {
    sequence.notes.emplace_back("A file holds several pictures: the first of each was inspected.");
  }
  if (std::ranges::all_of(pictures, [](const ReadPicture& p) { return p.facts.uses_12_bits; })) {
    sequence.notes.emplace_back(
        "The pictures use at most 12 of 16 bits; grey values count in shares of 16 bits.");
  }
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    std::size_t size_a = 1;
    std::size_t size_b = 1;
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = number_at(a, size_a);
      const std::string_view number_b = number_at(b, size_b);
      if (number_a != number_b) {
        return number_a.size() != number_b.size() ? number_a.size() < number_b.size()
                                                  : number_a < number_b;
      }
    } else if (a.front() != b.front()) {
      return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front());
    }
    a.remove_prefix(size_a);
    b.remove_prefix(size_b);
  }
  return a.empty() != b.empty() ? a.empty() : whole_a < whole_b;
}

std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator at(folder, error);
  if (error) {
    throw IoError(
        fmt::format("{}: the folder cannot be read: {}", folder.string(), error.message()));
  }
  std::vector<fs::path> files;
  for (const fs::directory_iterator end; at != end; at.increment(error)) {
    if (is_picture_name(at->path()) && !at->is_directory(error)) {
      files.push_back(at->path());
    }
  }
  if (files.empty()) {
    throw ConfigError(fmt::format("{}: holds no picture; looked for files that end in {}",
                                  folder.string(),
                                  fmt::join(kExtensions, " ")));
  }
  sort_files(files);
  return files;
}

int PictureSequence::width() const {
  return std::visit([](const auto& list) { return list.front().width(); }, frames);
}

int PictureSequence::height() const {
  return std::visit([](const auto& list) { return list.front().height(); }, frames);
}

PictureSequence read_sequence(std::vector<fs::path> files, ThreadPool& pool) {
  if (files.empty()) {
    throw ConfigError("no picture is given; a sequence needs at least one");
  }
  PictureSequence sequence;
  if (sort_files(files)) {
    sequence.notes.emplace_back(
        "The pictures were taken in the natural order of their names, not in the order given.");
  }
  auto pictures = pool.map<ReadPicture>(static_cast<std::int64_t>(files.size()), [&](auto i) {
    ReadPicture read{.picture = read_picture(files[static_cast<std::size_t>(i)]), .facts = {}};
    read.facts = std::visit([](const auto& image) { return facts_of(image); }, read.picture.pixels);
    return read;
  });
  check_one_size(pictures, files);
  check_finite(pictures, files);
  check_light(pictures, files);
  describe(pictures, sequence);
  take_frames(pictures, sequence);
  sequence.files = std::move(files);
  return sequence;
}

ImageF aspect_of(const PictureSequence& sequence, ThreadPool& pool) {
  return std::visit([&](const auto& frames) { return aspect_of(std::span(frames), pool); },
                    sequence.frames);
}

std::vector<ImageF> linear_frames(const PictureSequence& sequence) {
  return std::visit(
      [](const auto& frames) {
        std::vector<ImageF> linear;
        for (const auto& frame : frames) {
          linear.push_back(linear_values(frame));
        }
        return linear;
      },
      sequence.frames);
}

Mask read_mask(const fs::path& file, int width_px, int height_px) {
  const ImageF values = linear_values(read_picture(file).pixels);
  if (width_px > 0 && (values.width() != width_px || values.height() != height_px)) {
    throw ConfigError(fmt::format("{}: the mask is {} x {} pixels, the pictures are {} x {}",
                                  file.string(),
                                  values.width(),
                                  values.height(),
                                  width_px,
                                  height_px));
  }
  float largest = 0.0F;
  for (const float value : values.values()) {
    largest = std::isfinite(value) ? std::max(largest, value) : largest;
  }
  if (!(largest > 0.0F)) {
    throw ConfigError(file.string() + ": the mask is empty: no pixel is above 0");
  }
  Mask mask(values.width(), values.height());
  std::ranges::transform(values.values(), mask.values().begin(), [&](float value) {
    return static_cast<unsigned char>(value >= 0.5F * largest ? 1 : 0);
  });
  return mask;
}

}  // namespace glint
