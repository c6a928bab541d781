// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/front.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace glint {

namespace {

using Row = std::vector<double>;

bool is_finite(std::span<const double> row) {
  return std::ranges::all_of(row, [](double value) { return std::isfinite(value); });
}

bool is_inside(std::span<const double> row, std::span<const double> reference) {
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (!(row[i] < reference[i])) {
      return false;
    }
  }
  return is_finite(row);
}

double box_volume(std::span<const double> row, std::span<const double> reference) {
  double volume = 1.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    volume *= reference[i] - row[i];
  }
  return volume;
}

std::vector<Row> picked(std::span<const Row> rows, const std::vector<std::size_t>& indices) {
  std::vector<Row> result;
  for (const std::size_t index : indices) {
    result.push_back(rows[index]);
  }
  return result;
}

/// The others, each moved into the box that `row` dominates; only the front of them.
std::vector<Row> limited_to(std::span<const Row> others, const Row& row) {
  std::vector<Row> limited(others.begin(), others.end());
  for (Row& other : limited) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      other[i] = std::max(other[i], row[i]);
    }
  }
  return picked(limited, front_of(limited));
}

/// Of a front whose rows all lie inside the reference. Areas need only a sweep.
double volume_of(std::vector<Row> front, std::span<const double> reference) {
  std::ranges::sort(front);
  double volume = 0.0;
  if (reference.size() == 2) {
    double top = reference[1];
    for (const Row& row : front) {
      volume += (reference[0] - row[0]) * std::max(0.0, top - row[1]);
      top = std::min(top, row[1]);
    }
    return volume;
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    const std::span<const Row> later = std::span(front).subspan(i + 1);
    volume += box_volume(front[i], reference) - volume_of(limited_to(later, front[i]), reference);
  }
  return volume;
}

void check_sizes(std::span<const Row> rows, std::span<const double> reference) {
  for (const Row& row : rows) {
    GLINT_CHECK(row.size() == reference.size(), "one number per objective in each row");
  }
}

std::vector<Row> inside(std::span<const Row> rows, std::span<const double> reference) {
  std::vector<Row> result;
  std::ranges::copy_if(
      rows, std::back_inserter(result), [&](const Row& row) { return is_inside(row, reference); });
  return result;
}

}  // namespace

bool dominates(std::span<const double> a, std::span<const double> b) {
  bool is_better = false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] > b[i]) {
      return false;
    }
    is_better = is_better || a[i] < b[i];
  }
  return is_better;
}

std::vector<std::size_t> front_of(std::span<const std::vector<double>> rows) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bool is_beaten = !is_finite(rows[i]);
    for (std::size_t k = 0; k < rows.size() && !is_beaten; ++k) {
      is_beaten =
          is_finite(rows[k]) && (dominates(rows[k], rows[i]) || (k < i && rows[k] == rows[i]));
    }
    if (!is_beaten) {
      front.push_back(i);
    }
  }
  return front;
}

double hypervolume(std::span<const std::vector<double>> rows, std::span<const double> reference) {
  check_sizes(rows, reference);
  const std::vector<Row> kept = inside(rows, reference);
  return volume_of(picked(kept, front_of(kept)), reference);
}

std::vector<double> hypervolume_contributions(std::span<const std::vector<double>> rows,
                                              std::span<const double> reference) {
  check_sizes(rows, reference);
  std::vector<double> contributions(rows.size(), 0.0);
  for (const std::size_t index : front_of(rows)) {
    if (!is_inside(rows[index], reference)) {
      continue;
    }
    std::vector<Row> others(rows.begin(), rows.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(index));
    const std::vector<Row> limited = limited_to(inside(others, reference), rows[index]);
    contributions[index] =
        std::max(0.0, box_volume(rows[index], reference) - volume_of(limited, reference));
  }
  return contributions;
}

}  // namespace glint
