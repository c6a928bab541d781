// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small acquisition with the devices of a FakeCell.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/hardware/acquisition/fake_cell.h"

namespace glint {

inline JointVector joints(double a, double b) {
  JointVector vector = JointVector::Zero();
  vector[0] = a;
  vector[1] = b;
  return vector;
}

/// home, a point on the way, left, right, home.
inline Tour small_tour() {
  return {{.name = "home", .joints_rad = joints(0, 0), .is_safe = true},
          {.name = "", .joints_rad = joints(0.5, 0)},
          {.name = "left", .joints_rad = joints(0.5, 0.5)},
          {.name = "right", .joints_rad = joints(1.0, 0.5)},
          {.name = "home", .joints_rad = joints(0, 0), .is_safe = true}};
}

inline AcquisitionPlan small_plan(int positions) {
  AcquisitionPlan plan = {.tour = small_tour()};
  std::vector<int> all;
  for (int i = 0; i < positions; ++i) {
    all.push_back(i);
  }
  plan.tasks = {
      {.point = 2, .name = "left", .lights = {"ring"}, .exposure_us = 100, .positions = all},
      {.point = 3, .name = "right", .lights = {"bar"}, .exposure_us = 200, .positions = all}};
  return plan;
}

/// The devices of a FakeCell, and what came of them.
struct Bench {
  explicit Bench(int positions)
      : plan(small_plan(positions)), cell(plan.tour), stage(positions, cell) {}

  AcquisitionResult run() {
    const AcquisitionDevices devices = {
        .robot = robot,
        .camera = camera,
        .lamps = {{.light = &ring, .settle_s = 0.0}, {.light = &bar, .settle_s = 0.0}},
        .stage = &stage,
        .wait = [](double) {}};
    AcquisitionOptions options;
    options.interrupt = &cell.interrupt;
    return acquire(plan, devices, options, [this](const TakenPicture& picture) {
      if (cell.call(FakeFault::kSink)) {
        throw IoError("no space left on device");
      }
      if (cell.call(FakeFault::kProgram)) {
        throw std::runtime_error("a mistake");
      }
      taken.push_back(picture);
      if (before_end && taken.size() == plan.tasks.size()) {
        before_end();
      }
    });
  }

  /// Takes away what has been taken, as a resumed run does.
  void forget_taken() {
    for (const TakenPicture& picture : taken) {
      if (picture.is_accepted) {
        std::erase(plan.tasks[picture.task].positions, picture.position);
      }
    }
  }

  AcquisitionPlan plan;
  FakeCell cell;
  FakeRobot robot{cell};
  FakeCamera camera{cell};
  FakeLight ring{"ring", cell};
  FakeLight bar{"bar", cell};
  FakeStage stage;
  std::vector<TakenPicture> taken;
  std::function<void()> before_end = {};  ///< with as many pictures as views
};

}  // namespace glint
