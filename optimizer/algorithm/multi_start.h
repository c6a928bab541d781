// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs a method for continuous variables again and again over any space, until nobody asks.
//
// First the given start points and a Sobol design over all variables; then `batch` runs side by
// side, served in turn. A run searches the continuous variables that are active at its start
// point, everything else stays as there. When a run ends, the next one starts from the best design
// so far (with another step width than last time), from a fresh Sobol point or, where there are
// choices or integers, from the best design with one of them changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "optimizer/algorithm/algorithm.h"
#include "optimizer/algorithm/ask_tell_thread.h"
#include "optimizer/algorithm/nlopt_methods.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {

struct MultiStartPlan {
  std::string method;
  std::uint64_t seed = 1;
  int batch = 1;
  int num_design = 0;      ///< points asked before the first run, start points included
  int num_limits = 0;      ///< told beside the objective to gradient methods
  int num_objectives = 1;  ///< more than one: all are told, and all limits
  double tolerance = 1e-4;
  double patience_s = 10.0;
};

class MultiStart final : public Algorithm {
 public:
  using BodyMaker = std::function<AskTellThread::Body(const MethodRun&)>;

  /// @param start_points  canonical
  /// @param make_body     nlopt_body, pagmo_body, or a stand-in
  MultiStart(const SearchSpace& space,
             const MultiStartPlan& plan,
             std::vector<Point> start_points,
             BodyMaker make_body);

  std::optional<Point> ask() override;
  using Algorithm::tell;
  void tell(const Point& point, const Answer& answer) override;

  void abandon_run(int run) override { runs_to_abandon_.insert(run); }

 private:
  /// One of the runs side by side.
  struct Slot {
    std::unique_ptr<AskTellThread> thread;
    int run = 0;
    Point base;                         ///< values of what the run does not vary
    std::vector<std::size_t> variable;  ///< indices of what it varies
    bool is_waiting = false;            ///< its point is asked and not told
  };

  /// Where a run begins.
  struct Start {
    Point point;
    double step = 0.0;
    std::string text;
  };

  struct Told {
    Point point;
    double merit = 0.0;
  };

  /// What is asked and not told yet; no slot: a point of the design or a single sample.
  struct Pending {
    Point point;
    std::optional<std::size_t> slot;
  };

  std::optional<std::size_t> free_slot();
  Pending ask_slot(std::size_t index);
  std::optional<Point> ask_run(Slot& slot);
  Answer answer_for(const Slot& slot, const Answer& answer) const;
  void begin_run(std::size_t index, const Start& start);
  void set_box(MethodRun& run) const;
  std::vector<std::size_t> variables_to_search(const Point& point) const;

  Start next_start();
  std::optional<Start> first_start();
  Start start_from_best();
  Start start_from_neighbour();
  Start start_from_sobol();
  std::vector<Point> neighbours(const Point& point) const;
  Point fresh_sobol_point();
  std::optional<Point> told_of_rank(std::size_t rank) const;

  SearchSpace space_;
  MultiStartPlan plan_;
  BodyMaker make_body_;
  Sobol sobol_;
  std::deque<Point> design_;
  std::vector<Slot> slots_;
  std::deque<Pending> pending_;
  std::vector<Told> told_;       ///< not failed, each point once
  std::set<Point> told_points_;  ///< of told_
  std::set<Point> asked_;        ///< every point ever asked
  std::set<int> runs_to_abandon_;
  std::size_t next_slot_ = 0;
  std::uint32_t next_sobol_ = 0;
  int num_starts_ = 0;
  int num_runs_ = 0;
  int num_best_starts_ = 0;
  int num_neighbours_ = 0;
  bool has_discrete_ = false;
};

}  // namespace glint
