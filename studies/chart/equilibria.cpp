#include "studies/chart/equilibria.h"

#include <stdexcept>

#include "studies/truth/pressed_solid.h"

namespace palpate::chart {

using deformation::SolidState;
using deformation::TaylorHoodElements;

std::vector<Pressed> press_at_rest(const TaylorHoodElements& solid, std::vector<char> constrained,
                                   const Press& press, const std::function<void()>& keep_going) {
  const auto at = [&](double depth) {
    const Vec3 centre = press.place + (depth - press.radius) * press.direction;
    return truth::Station{{centre, centre, press.radius}};
  };
  std::vector<truth::Station> stations{at(0)};
  for (const double depth : press.depths) stations.push_back(at(depth));
  truth::PressedSolid pressed(solid, std::move(constrained), stations);
  auto state = solid.rest_state();
  std::vector<Pressed> answers;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    if (!pressed.press(stations[i - 1], stations[i], state, keep_going)) break;
    const auto found = pressed.equilibrium(state, press.marks);
    answers.push_back({-found.forces[0].dot(press.direction), found.displacements});
  }
  return answers;
}

// Weight as inertia: M f (x − x̂) with x̂ = X + g/f is −M g, but for the part f |x − X|/|g|.
std::vector<Vec3> sag_at_rest(const TaylorHoodElements& solid, std::vector<char> constrained,
                              const Vec3& gravity, const std::vector<Vec3>& marks,
                              const std::function<void()>& keep_going) {
  constexpr double kFactor = 1e-3;  // f [1/s²]
  constexpr int kStrides = 8;
  deformation::QuasiStaticNewton solver(solid, std::move(constrained), nullptr);
  SolidState state = solid.rest_state();
  for (int k = 1; k <= kStrides; ++k) {
    keep_going();
    std::vector<Vec3> predicted = solid.mesh().nodes;
    for (Vec3& x : predicted) x += double(k) / kStrides / kFactor * gravity;
    if (!solver.solve(state, deformation::Inertia{kFactor, predicted}).converged) {
      throw std::runtime_error("the reference found no equilibrium under its weight");
    }
  }
  return truth::displacements_at(marks, solid, state);
}

}  // namespace palpate::chart
