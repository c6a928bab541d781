// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// A complex refractive index n - i k.
struct RefractiveIndex {
  double n = 1.0;
  double k = 0.0;
};

/// Measured optical constants of a metal.
///
/// Read from the files of refractiveindex.info: YAML with a block `type: tabulated nk`, whose rows
/// hold wavelength in micrometres, n, k; or CSV with a header `wl,n,k`, or with two tables `wl,n`
/// and `wl,k` one after the other.
struct NkTable {
  std::string file;                   ///< for messages
  std::vector<double> wavelength_nm;  ///< rising, at least one
  std::vector<double> n;              ///< > 0
  std::vector<double> k;              ///< >= 0

  /// Linear between the rows.
  /// @throws ConfigError outside the table, naming file and range
  RefractiveIndex at(double at_nm) const;
};

/// @throws ConfigError with file:line
NkTable parse_nk(std::string_view text, const std::string& file);

/// @throws IoError, ConfigError
NkTable read_nk(const std::filesystem::path& path);

}  // namespace glint
