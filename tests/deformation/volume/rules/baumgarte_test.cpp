#include "deformation/volume/rules/baumgarte.h"

#include <catch2/catch.hpp>

#include "deformation/volume/rules/explicit_step.h"
#include "method_checks.h"

namespace palpate::deformation {
namespace {

/// Largest distance from the law, over Φ₀, in 0.1 s.
double distance_from_law(double h) {
  const auto model = testing::ball_model(2, testing::ball_organ_with("baumgarte"));
  auto baumgarte = testing::stepped_by<Baumgarte>(model);
  OrganState state = testing::shaken_state(model, 1e-3, 0);
  testing::scale(state, 1.01);
  const double start = testing::volume_of(model, state) - model.rest_volume;
  const double a = Baumgarte::kA;
  double worst = 0;
  for (int s = 1; s * h <= 0.1; ++s) {
    baumgarte.step(h, {}, state);
    const double t = s * h, law = start * (1 + a * t) * std::exp(-a * t);
    worst = std::max(worst, std::abs(testing::volume_of(model, state) - model.rest_volume - law));
  }
  return worst / start;
}

TEST_CASE("Baumgarte: the volume error decays like (1 + a t) e^(-a t), whatever the springs do") {
  // Oracle: the linear equation's solution for a = b. Symplectic Euler is of first order, so the
  // distance halves with h; it is at most about a h / 2 = 0.5 % of the start at h = 0.2 ms.
  static_assert(Baumgarte::kA == Baumgarte::kB);
  const double coarse = distance_from_law(4e-4), fine = distance_from_law(2e-4);
  CHECK(fine < 5e-3);
  CHECK(coarse / fine == Approx(2).epsilon(0.2));
}

TEST_CASE("Baumgarte: where springs are soft, the step is that of the law alone") {
  // Oracle: analytic, the root of b² h² + 4 a h = 4: an error decays below it, and grows beyond.
  auto organ = testing::ball_organ_with("baumgarte");
  organ.tissue.youngs_modulus = 100;
  const auto model = testing::ball_model(1, organ);
  auto baumgarte = testing::stepped_by<Baumgarte>(model);
  CHECK(baumgarte.largest_step() == Approx(0.9 * Baumgarte::law_step_bound()));
  const auto left_after = [&](double h) {
    OrganState state = rest_state(model);
    testing::scale(state, 1 + 1e-6);
    const double start = testing::volume_of(model, state) - model.rest_volume;
    for (int s = 0; s < 100; ++s) baumgarte.step(h, {}, state);
    return std::abs((testing::volume_of(model, state) - model.rest_volume) / start);
  };
  CHECK(left_after(0.95 * Baumgarte::law_step_bound()) < 0.1);
  CHECK(left_after(1.05 * Baumgarte::law_step_bound()) > 10);
  organ.tissue.youngs_modulus = 1e6;
  const auto stiff = testing::ball_model(1, organ);
  CHECK(Baumgarte(stiff).largest_step() == largest_explicit_step(stiff, 0));
}

}  // namespace
}  // namespace palpate::deformation
