// What a round probe's contact rows are worth to the solve: a ball pressed into an organ with all
// of its rows, and with at most so many, the deepest or half of them spread over the others. Rows
// that are left out get a gap of a metre. A search before each step, as in a session.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>

#include "collision/activation_distance.h"
#include "collision/contact_finder.h"
#include "collision/contact_reduction.h"
#include "deformation/contact/probe_contacts.h"
#include "deformation/models.h"
#include "modules/core/data_folder.h"
#include "modules/runtime/program.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "studies/rigs/poked_organ.h"

namespace {

using namespace palpate;
using deformation::ContactRow;

constexpr double kDepth = 10e-3, kSpeed = 15e-3;  // [m], [m/s]
constexpr double kHold = 0.5;                     // [s]
constexpr double kFar = 1;                        // a gap that never closes [m]

/// Which rows are left to the solve.
struct Kept {
  std::size_t most = 0;  ///< 0: all
  bool spread = false;   ///< half of them, over the others
};

Vec3 tissue_of(const ContactRow& row, const deformation::OrganState& state) {
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < 3; ++k) x += row.weights[k] * state.positions[row.nodes[k]];
  return x;
}

/// The deepest first, then, if asked for, always the one farthest from those chosen.
void leave_out(std::vector<ContactRow>& rows, const deformation::OrganState& state,
               const Kept& kept) {
  if (kept.most == 0 || rows.size() <= kept.most) return;
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t r) { return rows[r].gap; });
  std::size_t chosen = kept.spread ? kept.most / 2 : kept.most;
  for (; chosen < kept.most; ++chosen) {
    const auto apart = [&](std::size_t r) {
      double least = kFar;
      for (std::size_t i = 0; i < chosen; ++i) {
        const Vec3 way = tissue_of(rows[r], state) - tissue_of(rows[order[i]], state);
        least = std::min(least, way.squaredNorm());
      }
      return least;
    };
    const auto farthest =
        std::max_element(order.begin() + static_cast<std::ptrdiff_t>(chosen), order.end(),
                         [&](std::size_t a, std::size_t b) { return apart(a) < apart(b); });
    std::swap(order[chosen], *farthest);
  }
  for (std::size_t i = kept.most; i < order.size(); ++i) {
    ContactRow& row = rows[order[i]];
    row.gap = kFar;
    row.normal_impulse = 0;
    row.tangential_impulse.setZero();
  }
}

struct Result {
  std::size_t rows = 0, pressing = 0;  ///< at most, of a step
  double force = 0;                    ///< mean of the second half of the hold [N]
  double deepest = 0;                  ///< any free node in the ball, in that time [m]
};

Result press(const scene::Organ& organ, const geometry::TriangleSurface& surface, double period,
             double radius, const Kept& kept) {
  const auto model = deformation::build_organ_model(organ, Vec3::Zero(), surface);
  const auto dynamics = deformation::make_dynamics(organ, model, period);
  auto state = deformation::rest_state(model);
  deformation::SurfaceWalk walk(model);
  scene::Probe probe;
  probe.shape = scene::SphereShape{radius};
  deformation::ProbeContacts contacts(probe);
  collision::ContactFinder finder({model.triangles},
                                  {geometry::RoundedSegment{Vec3::Zero(), Vec3::Zero(), radius}});
  const auto [scene, x, z] = rigs::kOnStomach;
  const double front = rigs::front_of(surface, x, z);
  const double margin = collision::activation_distance({}, kSpeed);
  const int in = static_cast<int>(kDepth / kSpeed / period),
            hold = static_cast<int>(kHold / period);
  const int sub = std::max(1, static_cast<int>(std::ceil(period / dynamics->largest_step())));
  Result result;
  std::vector<ContactRow> rows;
  ContactSet found;
  Pose before{Vec3(x, front - radius - 1e-3, z), Quat::Identity()};
  contacts.set_pose(before);
  for (int k = 0; k <= in + hold; ++k) {
    const double depth = std::min(kDepth, kSpeed * period * k);
    const Pose now{Vec3(x, front - radius + depth, z), Quat::Identity()};
    finder.update_organ(0, std::span(state.positions).first(model.surface_node_count));
    finder.find(0, {before, now}, margin, {collision::kUsualContacts, 0, 0}, found);
    contacts.set_pose(now);
    contacts.set_contacts(found.contacts);
    contacts.begin(period);
    for (int s = 1; s <= sub; ++s) {
      rows.clear();
      contacts.append_rows(0, walk, state, period / sub, double(s) / sub, rows);
      leave_out(rows, state, kept);
      dynamics->step(period / sub, rows, state);
      contacts.take_rows(0, period / sub, rows);
      const auto pressing =
          std::ranges::count_if(rows, [](const ContactRow& row) { return row.normal_impulse > 0; });
      result.rows = std::max(result.rows, rows.size());
      result.pressing = std::max(result.pressing, static_cast<std::size_t>(pressing));
    }
    contacts.end();
    before = now;
    if (k <= in + hold / 2) continue;
    result.force += contacts.impulse().norm() / period / (hold - hold / 2);
    for (std::size_t i = 0; i < model.surface_node_count; ++i) {
      if (model.inverse_masses[i] == 0) continue;
      result.deepest =
          std::max(result.deepest, radius - (state.positions[i] - now.position).norm());
    }
  }
  return result;
}

int run(const std::string& scene_file, const std::vector<double>& radii) {
  const auto scene = scene::load_scene(scene_file);
  const scene::Organ& organ = scene.organs[0];
  const auto surface = scene::load_organ(organ).surface;
  std::printf("%zu nodes; a ball pressed %g mm deep at %g mm/s, then held\n", surface.nodes.size(),
              1e3 * kDepth, 1e3 * kSpeed);
  std::printf("%9s  %-24s %6s %9s %9s %9s %14s\n", "radius mm", "rows in the solve", "rows",
              "pressing", "force mN", "of all", "node deep mm");
  for (const double radius : radii) {
    double all = 0;
    for (const Kept& kept : {Kept{}, Kept{64, true}, Kept{64, false}, Kept{128, false}}) {
      const Result r = press(organ, surface, 1 / scene.rates.deformation, radius, kept);
      if (kept.most == 0) all = r.force;
      char what[64];
      std::snprintf(what, sizeof what, kept.spread ? "%zu, half of them spread" : "%zu deepest",
                    kept.most);
      std::printf("%9.1f  %-24s %6zu %9zu %9.2f %9.3f %14.4f\n", 1e3 * radius,
                  kept.most == 0 ? "all" : what, r.rows, r.pressing, 1e3 * r.force, r.force / all,
                  1e3 * r.deepest);
    }
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("What a round probe's contact rows are worth to the solve.",
                           "palpate-bench-contact-rows");
  auto scene = (data_folder() / "scenes/stomach_probe_refined.yaml").string();
  std::vector<double> radii{8e-3, 14e-3, 20e-3};
  program.add("--scene", scene, "Stomach whose front is pressed").shows_default();
  program.add("--radius", radii, "Of the ball [m]").range(1e-3, 0.05).shows_default();
  return program.run(argc, argv, [&] { return run(scene, radii); });
}
