// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part is Perfect inside a box of four limits (holes and scratches, biggest and sum), Acceptable
// inside a larger one. With P in A, the number wrong falls apart into
//   perfect parts outside P + acceptable ones inside P   and
//   acceptable parts outside A + rejected ones inside A,
// so each box is searched with its own parts; only P <= A ties them. Limits need only be tried at
// the values of the parts that belong inside. Branch and bound over the four limits, exact unless
// the budget ends; docs/theory/inspection_masks.md.
#include "metrics/inspection/learn_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "core/error.h"

namespace glint {
namespace {

constexpr std::size_t kMeasures = 4;
using Measures = std::array<double, kMeasures>;  // holes: biggest, sum; scratches: biggest, sum
using Parts = std::vector<Measures>;

constexpr std::int64_t kBudget = 200'000'000;  // looks at a part; about half a second

Measures measures_of(const LabelledPart& part) {
  return {part.holes.biggest, part.holes.sum, part.scratches.biggest, part.scratches.sum};
}

bool is_inside(const Measures& part, const Measures& limits) {
  for (std::size_t i = 0; i < kMeasures; ++i) {
    if (part[i] > limits[i]) {
      return false;
    }
  }
  return true;
}

int count_inside(const Parts& parts, const Measures& limits) {
  return static_cast<int>(
      std::ranges::count_if(parts, [&](const Measures& part) { return is_inside(part, limits); }));
}

int count_wrong(const Parts& good, const Parts& bad, const Measures& limits) {
  return static_cast<int>(good.size()) - count_inside(good, limits) + count_inside(bad, limits);
}

Measures larger_of(const Measures& a, const Measures& b) {
  Measures larger;
  std::ranges::transform(a, b, larger.begin(), [](double x, double y) { return std::max(x, y); });
  return larger;
}

/// The distinct values of a figure that are above the floor, downwards, then the floor.
std::vector<double> values_of(const Parts& parts, std::size_t measure, double floor) {
  std::vector<double> values = {floor};
  for (const Measures& part : parts) {
    if (part[measure] > floor) {
      values.push_back(part[measure]);
    }
  }
  std::ranges::sort(values, std::greater<>());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Parts within(const Parts& parts, std::size_t measure, double limit) {
  Parts kept;
  std::ranges::copy_if(parts, std::back_inserter(kept), [&](const Measures& part) {
    return part[measure] <= limit;
  });
  return kept;
}

/// Visits the boxes that may have at most so many wrong, tight ones only.
class BoxSearch {
 public:
  /// Is given limits and their number wrong, returns how many may be wrong from now on.
  using Visit = std::function<int(const Measures&, int)>;

  BoxSearch(const Measures& floor, Visit visit, std::int64_t& budget)
      : floor_(floor), visit_(std::move(visit)), budget_(&budget) {}

  /// @param minded  parts that count as nothing here, but whose being inside may cost elsewhere
  void run(const Parts& good, const Parts& bad, const Parts& minded, int allowed) {
    allowed_ = allowed;
    const Measures start = improved(good, bad);
    allowed_ = visit_(start, count_wrong(good, bad, start));
    branch(0, floor_, {.good = good, .bad = bad, .minded = minded}, 0);
  }

 private:
  /// One limit after the other at its best, from around all good parts, until none gets better: a
  /// number wrong near the least makes the search short.
  Measures improved(const Parts& good, const Parts& bad) const {
    Measures limits = floor_;
    for (const Measures& part : good) {
      limits = larger_of(limits, part);
    }
    int minimum = count_wrong(good, bad, limits);
    for (bool is_better = true; is_better;) {
      is_better = false;
      for (std::size_t i = 0; i < kMeasures; ++i) {
        Measures trial = limits;
        for (const double value : values_of(good, i, floor_[i])) {
          trial[i] = value;
          const int wrong = count_wrong(good, bad, trial);
          if (wrong < minimum) {
            minimum = wrong;
            limits = trial;
            is_better = true;
          }
        }
      }
    }
    return limits;
  }

  /// What is inside the limits set so far.
  struct Inside {
    Parts good;
    Parts bad;
    Parts minded;

    std::size_t unwanted() const { return bad.size() + minded.size(); }
  };

  void branch(std::size_t measure, Measures limits, const Inside& inside, int lost) {
    *budget_ -= static_cast<std::int64_t>(inside.good.size() + inside.unwanted() + 1);
    if (*budget_ < 0) {
      return;
    }
    if (measure == kMeasures) {
      allowed_ = visit_(limits, lost + static_cast<int>(inside.bad.size()));
      return;
    }
    std::size_t unwanted_before = std::numeric_limits<std::size_t>::max();
    for (const double value : values_of(inside.good, measure, floor_[measure])) {
      Inside then{.good = within(inside.good, measure, value)};
      const int lost_then = lost + static_cast<int>(inside.good.size() - then.good.size());
      if (lost_then > allowed_ || unwanted_before == 0) {
        return;
      }
      then.bad = within(inside.bad, measure, value);
      then.minded = within(inside.minded, measure, value);
      if (then.unwanted() == unwanted_before) {
        continue;  // loses good parts for nothing
      }
      unwanted_before = then.unwanted();
      limits[measure] = value;
      branch(measure + 1, limits, then, lost_then);
    }
  }

  Measures floor_;
  Visit visit_;
  std::int64_t* budget_;
  int allowed_ = 0;
};

/// Where limits may lie between the parts inside and the worse ones outside.
struct Room {
  Measures limits = {};
  double gap = 1.0;  ///< the narrowest, as a share of a figure's largest value
};

/// The measure by which a part is farthest beyond limits, as a share of the largest one.
std::size_t clearest_of(const Measures& part, const Measures& tight, const Measures& largest) {
  const auto share = [&](std::size_t i) {
    return largest[i] > 0.0 ? (part[i] - tight[i]) / largest[i] : 0.0;
  };
  std::size_t clearest = 0;
  for (std::size_t i = 1; i < kMeasures; ++i) {
    clearest = share(i) > share(clearest) ? i : clearest;
  }
  return clearest;
}

/// Each worse part is left to the figure by which it is outside most clearly, so that all limits
/// can be raised at once and none of these parts gets in.
Room room_above(const Measures& tight, const Parts& worse, const Measures& largest) {
  Measures ends;
  ends.fill(std::numeric_limits<double>::infinity());
  Measures farthest = tight;
  for (const Measures& part : worse) {
    const std::size_t clearest = clearest_of(part, tight, largest);
    if (part[clearest] > tight[clearest]) {
      ends[clearest] = std::min(ends[clearest], part[clearest]);
    }
    farthest = larger_of(farthest, part);
  }
  Room room{.limits = tight};
  for (std::size_t i = 0; i < kMeasures; ++i) {
    const bool is_needed = std::isfinite(ends[i]);
    const double middle = std::midpoint(tight[i], is_needed ? ends[i] : farthest[i]);
    room.limits[i] = middle < ends[i] ? middle : tight[i];
    if (is_needed) {
      room.gap = std::min(room.gap, (ends[i] - tight[i]) / largest[i]);
    }
  }
  return room;
}

Parts joined(Parts a, const Parts& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Boxes {
  Measures perfect = {};
  Measures acceptable = {};
  int wrong = std::numeric_limits<int>::max();
  double gap = -1.0;
};

bool is_better(int wrong, double gap, const Boxes& best) {
  return wrong < best.wrong || (wrong == best.wrong && gap > best.gap);
}

/// Searches the two boxes.
class LimitSearch {
 public:
  explicit LimitSearch(std::span<const LabelledPart> parts) {
    for (const LabelledPart& part : parts) {
      const Measures measures = measures_of(part);
      by_grade_[static_cast<std::size_t>(part.grade)].push_back(measures);
      largest_ = larger_of(largest_, measures);
    }
    worse_than_perfect_ = joined(acceptable(), rejected());
  }

  Boxes run() {
    outer_ = best_outer({}, {}, std::numeric_limits<int>::max());
    Boxes best;
    const auto visit = [&](const Measures& limits, int wrong) {
      if (wrong <= best.wrong - outer_.wrong) {
        take(limits, wrong, best);
      }
      return best.wrong - outer_.wrong;
    };
    BoxSearch search({}, visit, budget_);
    search.run(perfect(), acceptable(), rejected(), std::numeric_limits<int>::max());
    return best;
  }

  bool is_proven() const { return budget_ >= 0; }

  /// Limits within their room.
  Boxes placed(const Boxes& tight) const {
    Boxes boxes = tight;
    boxes.acceptable = room_above(tight.acceptable, rejected(), largest_).limits;
    boxes.perfect = room_above(tight.perfect, worse_than_perfect_, largest_).limits;
    for (std::size_t i = 0; i < kMeasures; ++i) {
      boxes.perfect[i] = std::min(boxes.perfect[i], boxes.acceptable[i]);
    }
    return boxes;
  }

 private:
  const Parts& perfect() const { return by_grade_[0]; }

  const Parts& acceptable() const { return by_grade_[1]; }

  const Parts& rejected() const { return by_grade_[2]; }

  /// The best box of acceptable parts around a box of perfect ones.
  Boxes best_outer(const Measures& inner, const Boxes& start, int allowed) {
    Boxes best = start;
    best.wrong = std::min(best.wrong, allowed);
    const auto visit = [&](const Measures& limits, int wrong) {
      const double gap = room_above(limits, rejected(), largest_).gap;
      if (is_better(wrong, gap, best)) {
        best = {.perfect = inner, .acceptable = limits, .wrong = wrong, .gap = gap};
      }
      return best.wrong;
    };
    BoxSearch search(inner, visit, budget_);
    search.run(acceptable(), rejected(), {}, best.wrong);
    return best;
  }

  void take(const Measures& inner, int wrong_inner, Boxes& best) {
    const Measures around = larger_of(outer_.acceptable, inner);
    Boxes boxes{.perfect = inner,
                .acceptable = around,
                .wrong = count_wrong(acceptable(), rejected(), around),
                .gap = room_above(around, rejected(), largest_).gap};
    if (boxes.wrong > outer_.wrong) {
      boxes = best_outer(inner, boxes, boxes.wrong);
    }
    boxes.perfect = inner;
    boxes.wrong += wrong_inner;
    boxes.gap = std::min(boxes.gap, room_above(inner, worse_than_perfect_, largest_).gap);
    if (is_better(boxes.wrong, boxes.gap, best)) {
      best = boxes;
    }
  }

  std::array<Parts, 3> by_grade_;
  Parts worse_than_perfect_;
  Measures largest_ = {};
  Boxes outer_;
  std::int64_t budget_ = kBudget;
};

GradeLimits limits_of(const Boxes& boxes, std::size_t first) {
  return {.perfect_biggest = boxes.perfect[first],
          .perfect_sum = boxes.perfect[first + 1],
          .acceptable_biggest = boxes.acceptable[first],
          .acceptable_sum = boxes.acceptable[first + 1]};
}

void check_parts(std::span<const LabelledPart> parts) {
  if (parts.empty()) {
    throw ConfigError("labelled parts: there is none, at least one is needed");
  }
  for (const LabelledPart& part : parts) {
    for (const double measure : measures_of(part)) {
      if (!(measure >= 0.0) || !std::isfinite(measure)) {
        throw ConfigError("labelled parts: a size is negative or no number");
      }
    }
  }
}

}  // namespace

LearnedLimits learn_limits(std::span<const LabelledPart> parts) {
  check_parts(parts);
  LimitSearch search(parts);
  const Boxes boxes = search.placed(search.run());
  LearnedLimits learned{.holes = limits_of(boxes, 0), .scratches = limits_of(boxes, 2)};
  learned.is_proven = search.is_proven();
  for (const LabelledPart& part : parts) {
    const Grade grade =
        std::max(grade_by(part.holes, learned.holes), grade_by(part.scratches, learned.scratches));
    learned.wrong += grade == part.grade ? 0 : 1;
  }
  return learned;
}

}  // namespace glint
