#include "deformation/models.h"

#include <catch2/catch.hpp>
#include <set>

#include "modules/scene/models.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using testing::kPeriod;

TEST_CASE("models: deformation and scene have a row each for the same words, in the same order") {
  // Oracle: the other table.
  std::vector<std::string> ours, theirs;
  for (const ModelRow& row : model_rows()) ours.emplace_back(row.word);
  for (const scene::ModelFormat& format : scene::model_formats()) theirs.emplace_back(format.word);
  CHECK(ours == theirs);
  CHECK(std::set(ours.begin(), ours.end()).size() == ours.size());
  for (const ModelRow& row : model_rows()) CHECK(row.make != nullptr);
}

TEST_CASE("models: Poisson's ratio computed with is what is asked for, but where it is capped") {
  // Oracle: analytic, κ = 100 μ is (3·100 − 2)/(2 (3·100 + 1)) = 298/602.
  scene::Organ organ;
  for (const scene::ModelFormat& format : scene::model_formats()) {
    if (!format.is_solid()) continue;
    organ.model = format.word;
    organ.solid.poisson_ratio = 0.45;
    CHECK(computed_poisson_ratio(organ) == 0.45);
    organ.solid.poisson_ratio = format.largest_poisson_ratio;
    const bool capped = organ.model == "nodal_pressure" || organ.model == "quadratic_pressure";
    CHECK(computed_poisson_ratio(organ) ==
          (capped ? Approx(298.0 / 602) : Approx(organ.solid.poisson_ratio)));
  }
}

TEST_CASE("models: those that conserve volume or momentum do") {
  // Oracle: invariants, without contacts and gravity. 1e-3 of V₀: steps of 1 ms leave what their
  // linearisation leaves. Momentum: floats of the springs.
  for (const ModelRow& row : model_rows()) {
    if (scene::is_solid(row.word)) continue;
    auto organ = testing::ball_organ();
    organ.model = row.word;
    organ.tissue.drag = 0;
    const auto model = testing::ball_model(2, organ);
    const auto dynamics = make_dynamics(organ, model, kPeriod);
    OrganState state = rest_state(model);
    double size = 0;
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      state.velocities[i] = Vec3(2 * state.positions[i].y(), 0, -1 * state.positions[i].x());
      size += model.masses[i] * state.velocities[i].norm();
    }
    for (int s = 0; s < 100; ++s) dynamics->step(1e-3, {}, state);
    Vec3 momentum = Vec3::Zero();
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      momentum += model.masses[i] * state.velocities[i];
    }
    INFO(row.word);
    const double volume = geometry::enclosed_volume(state.positions, model.triangles);
    if (row.volume == VolumeKeeping::kExactly)
      CHECK(std::abs(volume / model.rest_volume - 1) < 1e-3);
    if (row.conserves_momentum) CHECK(momentum.norm() < 1e-5 * size);
  }
}

}  // namespace
}  // namespace palpate::deformation
