// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that somebody else made, as one sequence: real cameras' or simulated ones, of any depth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/image/image.h"
#include "core/thread_pool.h"

namespace glint {

/// Whether a name comes before another as people count: frame_2 before frame_10. Numbers of the
/// same value are told apart by their zeros, so that this is a strict order of all texts.
bool natural_less(std::string_view a, std::string_view b);

/// The pictures in a folder (by the ends of their names), in natural order; hidden files and
/// folders are left out. @throws ConfigError when there is none, IoError
std::vector<std::filesystem::path> pictures_in(const std::filesystem::path& folder);

/// The pictures of one part, of one size, in natural order of their names.
struct PictureSequence {
  std::vector<std::filesystem::path> files;

  /// Codes where all files are grey and of that depth, else linear values.
  std::variant<std::vector<Image<std::uint8_t>>,
               std::vector<Image<std::uint16_t>>,
               std::vector<ImageF>>
      frames;
  int bits = 8;  ///< of the deepest file: 8, 16 or 32
  bool is_float = false;
  int channels = 1;                ///< of the file with the most, without alpha
  std::vector<std::string> notes;  ///< what a reader of the result must know

  int width() const;
  int height() const;

  std::size_t size() const { return files.size(); }
};

/// Reads a sequence. @param files  in any order
/// @throws IoError, ConfigError for none, a file given twice, pictures of different size, values
///         that are no finite numbers, and pictures that are all black or all at full scale
PictureSequence read_sequence(std::vector<std::filesystem::path> files, ThreadPool& pool);

/// The mean picture.
ImageF aspect_of(const PictureSequence& sequence, ThreadPool& pool);

/// The frames as linear values.
std::vector<ImageF> linear_frames(const PictureSequence& sequence);

/// A mask: 1 where the picture has at least half of its own largest value.
/// @param width_px, height_px  that it must have; 0: any
/// @throws IoError, ConfigError when it has another size or nothing is in it
Mask read_mask(const std::filesystem::path& file, int width_px = 0, int height_px = 0);

}  // namespace glint
