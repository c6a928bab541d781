// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ten thousand random imprints on procedural and real parts, broken parts, and flush tools. Prints
// what it counted.
#include <cstdlib>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "defects/boolean/imprint.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "tests/defects/boolean/imprint_support.h"
#include "tests/defects/boolean/mesh_faults.h"

namespace glint {
namespace {

namespace support = imprint_support;
namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kGroup = 50;  // imprints that accumulate on one part
constexpr int kMaxRetries = 8;

struct NamedPart {
  std::string name;
  TriangleMesh mesh;
};

/// The meshes of Debian's libcgal-demo, unpacked for this run; empty when it is not installed.
class DemoMeshes {
 public:
  DemoMeshes() {
    for (const char* package : {"libcgal-demo", "libcgal-dev"}) {
      const fs::path archive = fs::path("/usr/share/doc") / package / "data.tar.gz";
      if (folder_.empty() && fs::exists(archive)) {
        unpack(archive);
      }
    }
  }

  DemoMeshes(const DemoMeshes&) = delete;
  DemoMeshes& operator=(const DemoMeshes&) = delete;

  ~DemoMeshes() {
    if (!folder_.empty()) {
      fs::remove_all(folder_);
    }
  }

  fs::path path(const std::string& name) const { return folder_ / "data" / "meshes" / name; }

 private:
  void unpack(const fs::path& archive) {
    std::string name = (fs::temp_directory_path() / "glint_imprint_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      return;
    }
    folder_ = name;
    const std::string command = "tar -xzf " + archive.string() + " -C " + name + " data/meshes";
    if (std::system(command.c_str()) != 0) {
      fmt::print("{} could not be unpacked\n", archive.string());
    }
  }

  fs::path folder_;
};

void add_file(std::vector<NamedPart>& parts, const fs::path& path) {
  if (!fs::exists(path)) {
    fmt::print("left out: {} is not there\n", path.filename().string());
    return;
  }
  parts.push_back({path.filename().string(), read_mesh(path)});
}

std::vector<NamedPart> closed_parts(const DemoMeshes& demo) {
  std::vector<NamedPart> parts;
  parts.push_back({"gear, coarse", support::gear(6.0)});
  parts.push_back({"gear, fine", support::gear(2.0)});
  parts.push_back({"cube of 12 triangles", support::cube(40.0, 1)});
  parts.push_back({"cube, fine", support::cube(40.0, 24)});
  parts.push_back({"plate", support::box({0.0, 0.0, 0.0}, {80.0, 50.0, 6.0}, 7)});
  parts.push_back({"sphere", support::scaled(support::unit_sphere(4), 25.0)});
  parts.push_back({"torus", support::torus(30.0, 8.0, 96, 32)});
  const fs::path shared = fs::path(GLINT_SHARED_DIR) / "data" / "meshes";
  for (const char* name :
       {"moveo_t3m1c.stl", "odri_pulley_at3_t30_output.stl", "fandisk.obj", "rocker-arm.obj"}) {
    add_file(parts, shared / name);
  }
  for (const char* name : {"anchor_dense.off",
                           "couplingdown.off",
                           "joint.off",
                           "pinion.off",
                           "turbine.off",
                           "rotor.off",
                           "dragknob.off"}) {
    add_file(parts, demo.path(name));
  }
  std::erase_if(parts, [](const NamedPart& part) {
    const bool is_valid = find_faults(part.mesh).none();
    if (!is_valid) {
      fmt::print("left out: {} is not valid itself\n", part.name);
    }
    return !is_valid;
  });
  return parts;
}

struct Counts {
  int done = 0;
  int retried = 0;
  int no_contact = 0;
  int drawn_anew = 0;
  int refused = 0;
  std::map<ImprintOutcome, int> reasons;
};

/// Draws tool number `index`, and others in its place while what was drawn meets only air (it fell
/// into an earlier dent).
template <class TryTool>
ImprintResult imprint_drawn(int index, Counts& counts, const TryTool& try_tool) {
  ImprintResult result;
  for (int draw = 0; draw < 20; ++draw) {
    result = try_tool(index + 1'000'000 * draw);
    if (result.outcome != ImprintOutcome::kNoContact) {
      break;
    }
    ++counts.drawn_anew;
  }
  return result;
}

/// Tries a tool, moved a little after each refusal.
ImprintResult imprint_with_retries(ImprintedMesh& part,
                                   const TriangleMesh& tool,
                                   std::int32_t label,
                                   std::uint64_t seed,
                                   Counts& counts) {
  constexpr ImprintLimits kLimits = {.may_break_through = true};
  ImprintResult result = part.imprint(tool, label, ImprintOperation::kSubtract, kLimits);
  Rng rng(seed, Stream::kTest, 1'000'000U + static_cast<std::uint64_t>(label));
  int retry = 0;
  while (!result.is_done() && result.outcome != ImprintOutcome::kNoContact && retry < kMaxRetries) {
    ++retry;
    result = part.imprint(
        jittered(tool, jitter_size(retry), rng), label, ImprintOperation::kSubtract, kLimits);
  }
  counts.retried += retry > 0 && result.is_done() ? 1 : 0;
  counts.done += result.is_done() ? 1 : 0;
  counts.no_contact += result.outcome == ImprintOutcome::kNoContact ? 1 : 0;
  const bool is_refused = !result.is_done() && result.outcome != ImprintOutcome::kNoContact;
  counts.refused += is_refused ? 1 : 0;
  if (is_refused) {
    ++counts.reasons[result.outcome];
  }
  return result;
}

std::string reasons_text(const Counts& counts) {
  std::string text;
  for (const auto& [outcome, count] : counts.reasons) {
    text += fmt::format("; {}: {}", outcome_text(outcome), count);
  }
  return text;
}

/// Imprints `wanted` tools into copies of a part, kGroup into each.
/// @param p  the part's number, from which random numbers follow
Counts imprint_closed_part(const NamedPart& named, std::uint64_t p, int wanted) {
  const TriangleMesh& mesh = named.mesh;
  const support::Places places(mesh);
  const double size_mm = support::diagonal_mm(mesh);
  const double volume_mm3 = enclosed_volume_mm3(mesh);
  const ImprintedMesh fresh(mesh);
  Counts counts;
  for (int first = 0; first < wanted; first += kGroup) {
    ImprintedMesh part = fresh;
    double removed_mm3 = 0.0;
    for (int i = first; i < first + kGroup; ++i) {
      const ImprintResult imprinted = imprint_drawn(i, counts, [&](int index) {
        const TriangleMesh tool = support::mixed_tool(places, size_mm, p, index);
        return imprint_with_retries(part, tool, i + 1, p, counts);
      });
      removed_mm3 += imprinted.removed_volume_mm3;
    }
    const TriangleMesh result = part.result().mesh;
    const MeshFaults faults = find_faults(result);
    EXPECT_TRUE(faults.none()) << named.name << ", imprints from " << first << ": open "
                               << faults.open_edges << ", repeated " << faults.repeated_edges
                               << ", crossing " << faults.crossing_pairs << ", flat "
                               << faults.degenerate;
    const double changed_mm3 = volume_mm3 - enclosed_volume_mm3(result);
    EXPECT_NEAR(changed_mm3, removed_mm3, 1e-9 * volume_mm3) << named.name;
  }
  return counts;
}

TEST(ImprintRobust, TenThousandRandomImprintsLeaveValidParts) {
  const DemoMeshes demo;
  const std::vector<NamedPart> parts = closed_parts(demo);
  ASSERT_GE(parts.size(), 10U);
  constexpr int kTotal = 10'000;
  const int per_part = (kTotal / static_cast<int>(parts.size()) / kGroup + 1) * kGroup;
  Counts all;
  int tried = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Counts counts = imprint_closed_part(parts[p], p, per_part);
    tried += per_part;
    fmt::print(
        "{:32} {:6} faces: {} done ({} after retries, {} drawn anew), {} "
        "refused{}\n",
        parts[p].name,
        parts[p].mesh.num_triangles(),
        counts.done,
        counts.retried,
        counts.drawn_anew,
        counts.refused,
        reasons_text(counts));
    all.done += counts.done;
    all.retried += counts.retried;
    all.drawn_anew += counts.drawn_anew;
    all.refused += counts.refused;
  }
  fmt::print(
      "{} wanted on {} parts: {} done ({} after retries, {} drawn anew), {} "
      "refused\n",
      tried,
      parts.size(),
      all.done,
      all.retried,
      all.drawn_anew,
      all.refused);
  EXPECT_GE(tried, kTotal);
  EXPECT_EQ(all.done, tried);
  EXPECT_EQ(all.refused, 0);
  EXPECT_LE(all.drawn_anew, tried / 100);
}

TEST(ImprintRobust, BrokenPartsTakeMostImprintsAndNeverGetWorse) {
  const DemoMeshes demo;
  std::vector<NamedPart> parts;
  const fs::path shared = fs::path(GLINT_SHARED_DIR) / "data" / "meshes";
  for (const char* name : {"moveo_servo_gear.stl",
                           "moveo_pivot_arm.stl",
                           "odri_foot_structure.stl",
                           "stanford-bunny.obj"}) {
    add_file(parts, shared / name);
  }
  for (const char* name : {"b9_mesh.off", "pig.off", "mech-holes-shark.off"}) {
    add_file(parts, demo.path(name));
  }
  if (parts.empty()) {
    GTEST_SKIP() << "no broken meshes on this machine";
  }
  constexpr int kTools = 200;
  int done = 0;
  int tried = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    support::turn_outwards(parts[p].mesh);
    const support::Places places(parts[p].mesh);
    const double size_mm = support::diagonal_mm(parts[p].mesh);
    const MeshFaults before = find_faults(parts[p].mesh);
    const ImprintedMesh fresh(parts[p].mesh);
    Counts counts;
    for (int first = 0; first < kTools; first += kGroup) {
      ImprintedMesh part = fresh;
      for (int i = first; i < first + kGroup; ++i) {
        imprint_with_retries(
            part, support::mixed_tool(places, size_mm, 100 + p, i), i + 1, p, counts);
      }
      const MeshFaults after = find_faults(part.result().mesh);
      EXPECT_LE(after.open_edges, before.open_edges) << parts[p].name;
      EXPECT_LE(after.repeated_edges, before.repeated_edges) << parts[p].name;
      EXPECT_LE(after.degenerate, before.degenerate) << parts[p].name;
    }
    fmt::print("{:32} {} open, {} crossing: {} of {} done ({} after retries), {} no contact{}\n",
               parts[p].name,
               before.open_edges,
               before.crossing_pairs,
               counts.done,
               kTools,
               counts.retried,
               counts.no_contact,
               reasons_text(counts));
    done += counts.done;
    tried += kTools;
  }
  fmt::print("broken parts: {} of {} done\n", done, tried);
  EXPECT_GE(done, tried * 9 / 10);
}

TEST(ImprintRobust, FlushToolsSucceedAtAllPlacesWithRetries) {
  const ImprintedMesh fresh(support::cube(100.0, 20));
  Counts counts;
  int max_retries = 0;
  for (int i = 0; i < 19; ++i) {
    for (int j = 0; j < 19; ++j) {
      // Top faces in one plane; the sides lie on the part's grid lines for every other place.
      const double x_mm = -45.0 + 5.0 * i;
      const double y_mm = -45.0 + 5.0 * j;
      const TriangleMesh tool =
          support::box({x_mm - 2.5, y_mm - 2.5, 45.0}, {x_mm + 2.5, y_mm + 2.5, 50.0}, 2);
      ImprintedMesh part = fresh;
      const int before = counts.retried;
      const ImprintResult result =
          imprint_with_retries(part, tool, 1, static_cast<std::uint64_t>(100 * i + j), counts);
      ASSERT_TRUE(result.is_done()) << i << ' ' << j << ": " << outcome_text(result.outcome);
      EXPECT_NEAR(result.removed_volume_mm3, 125.0, 0.1 * 125.0);
      EXPECT_TRUE(find_faults(part.result().mesh).none());
      max_retries += counts.retried - before;
    }
  }
  fmt::print("flush tools: {} of 361 done, {} of them after retries\n", counts.done, max_retries);
  EXPECT_EQ(counts.done, 361);
}

/// A ball at a grid vertex of a cube's face, edge or corner loses exactly a half, a quarter or an
/// eighth of its volume to the cube.
TEST(ImprintRobust, BallsAtAllGridVerticesRemoveExactParts) {
  const TriangleMesh cube = support::cube(100.0, 20);
  ASSERT_EQ(cube.vertices_mm.size(), 2402U);
  const TriangleMesh ball = support::scaled(support::unit_sphere(2), 2.0);
  const double volume_mm3 = enclosed_volume_mm3(ball);
  const ImprintedMesh fresh(cube);
  int done = 0;
  double worst = 0.0;
  for (const Vector3d& centre : cube.vertices_mm) {
    ImprintedMesh part = fresh;
    const ImprintResult result = part.imprint(
        support::moved(ball, {.translation_mm = centre}), 1, ImprintOperation::kSubtract);
    const auto sides = (centre.cwiseAbs().array() == 50.0).count();
    const double expected = volume_mm3 / static_cast<double>(1 << sides);
    done += result.is_done() ? 1 : 0;
    worst = std::max(worst, std::abs(result.removed_volume_mm3 / expected - 1.0));
  }
  fmt::print(
      "balls at grid vertices: {} of 2402 done, volume off by at most {:.2g}\n", done, worst);
  EXPECT_EQ(done, 2402);
  EXPECT_LT(worst, 1e-10);
}

}  // namespace
}  // namespace glint
