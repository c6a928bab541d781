// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/sobol.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include <boost/random/sobol.hpp>

#include "core/error.h"
#include "core/rng.h"

namespace glint {

using Engine = boost::random::sobol_engine<std::uint32_t, 32>;
static_assert(kMaxSobolDimension == boost::random::default_sobol_table::max_dimension);

Sobol::Sobol(std::uint64_t seed, int num_dimensions) {
  if (num_dimensions > kMaxSobolDimension) {
    throw ConfigError("search: there are " + std::to_string(num_dimensions) +
                      " variables, Sobol's sequence has at most " +
                      std::to_string(kMaxSobolDimension));
  }
  Rng rng(seed, Stream::kSearch, 0);
  for (int d = 0; d < num_dimensions; ++d) {
    shifts_.push_back(rng.next_u32());
  }
}

std::vector<double> Sobol::point(std::uint32_t index) const {
  Engine engine(std::max<std::size_t>(1, shifts_.size()));
  if (index > 0) {
    engine.seed(index - 1);  // it leaves out the first point, which is zero
  }
  std::vector<double> point;
  for (const std::uint32_t shift : shifts_) {
    const std::uint32_t bits = (index > 0 ? engine() : 0U) ^ shift;
    point.push_back(static_cast<double>(bits) * 0x1p-32);
  }
  return point;
}

}  // namespace glint
