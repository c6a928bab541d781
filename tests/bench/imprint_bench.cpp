// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fifty mixed imprints (60 % dents of 1,280 triangles, 40 % scratches of 1,504) on a gear, on one
// core, tree included. `of_whole_mesh` is the time of one imprint in units of a Boolean operation
// of CGAL on the whole mesh for the same tools, taken in the same run. `growth_to_4M` is the time
// of an imprint on 4 M faces over that on 0.5 M, without the tree, at equal density: copies of one
// gear.
#include <algorithm>
#include <chrono>
#include <functional>
#include <map>

#include <benchmark/benchmark.h>

#include "defects/boolean/imprint.h"
#include "tests/bench/whole_mesh_boolean.h"
#include "tests/defects/boolean/imprint_support.h"

namespace glint {
namespace {

namespace support = imprint_support;

constexpr int kTools = 50;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Job {
  TriangleMesh part;
  std::vector<TriangleMesh> tools;
};

const Job& job_of(double edge_mm) {
  static std::map<double, Job> jobs;
  const auto found = jobs.find(edge_mm);
  if (found != jobs.end()) {
    return found->second;
  }
  Job job{support::gear(edge_mm), {}};
  const support::Places places(job.part);
  const double size_mm = support::diagonal_mm(job.part);
  for (int i = 0; i < kTools; ++i) {
    job.tools.push_back(support::mixed_tool(places, size_mm, 5, i));
  }
  return jobs.emplace(edge_mm, std::move(job)).first->second;
}

int imprint_all(ImprintedMesh& mesh, const std::vector<TriangleMesh>& tools) {
  int done = 0;
  for (std::size_t i = 0; i < tools.size(); ++i) {
    const ImprintResult result = mesh.imprint(tools[i],
                                              static_cast<std::int32_t>(i) + 1,
                                              ImprintOperation::kSubtract,
                                              {.may_break_through = true});
    done += result.is_done() ? 1 : 0;
  }
  return done;
}

/// whole_tools: how many of the tools the whole-mesh operation gets, 0 for none.
void bench_fifty(benchmark::State& state, double edge_mm, std::size_t whole_tools) {
  const Job& job = job_of(edge_mm);
  int done = 0;
  double bytes = 0.0;
  double seconds = 1e9;
  for (auto _ : state) {
    seconds = std::min(seconds, seconds_of([&] {
                         ImprintedMesh mesh(job.part);
                         done = imprint_all(mesh, job.tools);
                         bytes = static_cast<double>(mesh.memory_bytes());
                       }));
  }
  state.counters["faces"] = static_cast<double>(job.part.num_triangles());
  state.counters["done"] = done;
  state.counters["bytes_a_face"] = bytes / static_cast<double>(job.part.num_triangles());
  if (whole_tools > 0) {
    const std::vector<TriangleMesh> tools(
        job.tools.begin(), job.tools.begin() + static_cast<std::ptrdiff_t>(whole_tools));
    const double whole_s = whole_mesh_difference_seconds(job.part, tools);
    state.counters["of_whole_mesh"] =
        (seconds / kTools) / (whole_s / static_cast<double>(whole_tools));
  }
}

TriangleMesh copies(const TriangleMesh& part, int count) {
  TriangleMesh out;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::int32_t>(out.vertices_mm.size());
    for (const Eigen::Vector3d& point : part.vertices_mm) {
      out.vertices_mm.emplace_back(point.x() + 200.0 * i, point.y(), point.z());
    }
    for (const Triangle& t : part.triangles) {
      out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  return out;
}

double best_imprint_seconds(const TriangleMesh& part, const std::vector<TriangleMesh>& tools) {
  const ImprintedMesh fresh(part);
  double best_s = 1e9;
  for (int repeat = 0; repeat < 5; ++repeat) {
    ImprintedMesh mesh = fresh;
    best_s = std::min(best_s, seconds_of([&] { imprint_all(mesh, tools); }));
  }
  return best_s;
}

void bench_growth(benchmark::State& state) {
  const Job& job = job_of(0.535);
  const double small_s = best_imprint_seconds(job.part, job.tools);
  const TriangleMesh large = copies(job.part, 8);
  double large_s = 0.0;
  for (auto _ : state) {
    large_s = best_imprint_seconds(large, job.tools);
  }
  state.counters["faces"] = static_cast<double>(large.num_triangles());
  state.counters["growth_to_4M"] = large_s / small_s;
}

BENCHMARK_CAPTURE(bench_fifty, 50k, 1.77, kTools)
    ->Name("imprint/fifty_on_50k")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_fifty, 500k, 0.535, 4)
    ->Name("imprint/fifty_on_500k")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_fifty, 2M, 0.2645, 0)
    ->Name("imprint/fifty_on_2M")
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bench_growth)->Name("imprint/growth_to_4M")->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace glint
