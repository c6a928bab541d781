// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint compare` is given: pictures, folders of pictures, folders of runs and their views;
// and which of them belong together.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint {

/// One picture to compare, with what is known of it. Empty paths are unknown.
struct CompareSource {
  std::string name;  ///< how it is told apart: "view_03", "img07"
  std::filesystem::path picture;
  std::filesystem::path geometry = {};  ///< depth, normals and positions, of a rendered view
  std::filesystem::path mask = {};      ///< bright where the part is
  std::filesystem::path scene = {};     ///< what it was rendered from
  std::filesystem::path truth = {};     ///< its list of defects

  bool is_rendered() const { return !scene.empty(); }
};

/// A simulated picture beside a real one.
struct ComparePair {
  CompareSource simulated;
  CompareSource real;
  std::filesystem::path real_mask = {};  ///< bright where the real part is; empty: to be found
};

struct CompareInputs {
  std::filesystem::path simulated;
  std::vector<std::filesystem::path> reals;  ///< at least one
  /// CSV: simulated,real or simulated,real,mask; empty: by name or order. Masks are where the real
  /// part is, relative to the file; an empty field: --mask, or the part is looked for.
  std::filesystem::path pairs;
};

struct ComparePlan {
  std::vector<ComparePair> pairs;  ///< at least one
  std::vector<std::string> notes;  ///< how they were put together
};

/// All pictures that a path stands for, in natural order: a file itself; of a folder of a rendered
/// view or a design its picture; of a run all its views; of any other folder its pictures.
/// @throws IoError where there is nothing, ConfigError for folders without pictures
std::vector<CompareSource> compare_sources(const std::filesystem::path& path);

/// Pairs by the CSV file where there is one; else one simulated picture with every real one; else
/// one real picture with every rendered one; else by equal names; else, of equal numbers, by order.
/// @throws ConfigError naming the picture that has no partner, IoError
ComparePlan plan_comparison(const CompareInputs& inputs);

}  // namespace glint
