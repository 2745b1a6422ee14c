// How fast the answer settles as steps are halved: the order of each integrator.
#include <catch2/catch.hpp>
#include <functional>

#include "deformation/steppers/backward_euler.h"
#include "deformation/steppers/symplectic_euler.h"
#include "modules/scene/models.h"
#include "tests/robustness/models_under_test.h"

namespace palpate::deformation {
namespace {

constexpr double kTime = 0.1;  // [s]; a third of the slowest swing

/// A ball or cube let go from an ellipsoid of the same volume, in `steps` steps.
std::vector<Vec3> let_go(OrganDynamics& dynamics, const OrganModel& model, int steps) {
  OrganState state = rest_state(model);
  for (Vec3& p : state.positions) p = Vec3(1.1 * p.x(), p.y(), p.z() / 1.1);
  for (int s = 0; s < steps; ++s) dynamics.step(kTime / steps, {}, state);
  return state.positions;
}

/// RMS over the nodes [m]
double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / double(a.size()));
}

using Motion =
    std::function<std::vector<Vec3>(OrganDynamics& dynamics, const OrganModel& model, int steps)>;

/// Distances of the results of `coarsest` steps, twice as many, and so on.
std::vector<double> differences(const Motion& motion, OrganDynamics& dynamics,
                                const OrganModel& model, int coarsest) {
  std::vector<double> found;
  std::vector<Vec3> last = motion(dynamics, model, coarsest);
  for (int k = 1; k < 5; ++k) {
    std::vector<Vec3> next = motion(dynamics, model, coarsest << k);
    found.push_back(distance(last, next));
    last = std::move(next);
  }
  return found;
}

/// The errors halve with the step. 0.2: what is left of the next order.
void check_first_order(const std::vector<double>& found, const std::string& name) {
  for (std::size_t k = 1; k < found.size(); ++k) {
    const double order = std::log2(found[k - 1] / found[k]);
    UNSCOPED_INFO(name << ", halved " << k << " times: " << found[k - 1] << " m, order " << order);
    CHECK(order == Approx(1).margin(0.2));
  }
}

struct Settling {
  std::string model;
  scene::Integrator integrator;
  std::size_t iterations;  ///< so many that the system of a step is solved to the end
  int coarsest;            ///< number of steps in kTime
};

std::unique_ptr<OrganDynamics> solved_to_the_end(scene::Organ organ, const OrganModel& model,
                                                 std::size_t iterations) {
  if (organ.integrator == scene::Integrator::kBackwardEuler) {
    return std::make_unique<BackwardEuler>(model,
                                           KeptVolume{.is_kept = organ.model == "implicit_volume"},
                                           static_cast<int>(iterations));
  }
  organ.iterations = iterations;
  return make_dynamics(organ, model, testing::kPeriod);
}

TEST_CASE("step halving: the error of every method halves with its step") {
  // Oracle: the order of the method. Solids are soft, so that these steps are short for their
  // swings.
  using scene::Integrator;
  for (const Settling& kind : {Settling{"implicit_volume", Integrator::kSymplecticEuler, 0, 200},
                               {"implicit_volume", Integrator::kBackwardEuler, 100, 200},
                               {"xpbd_springs", Integrator::kAutomatic, 1, 200},
                               {"xpbd_springs", Integrator::kAutomatic, 20, 200},
                               {"xpbd_tetrahedra", Integrator::kAutomatic, 1, 200},
                               {"xpbd_tetrahedra", Integrator::kAutomatic, 20, 200},
                               {"corotational", Integrator::kAutomatic, 200, 200},
                               {"nodal_pressure", Integrator::kAutomatic, 200, 200},
                               {"quadratic_pressure", Integrator::kAutomatic, 200, 200},
                               {"quadratic_elements", Integrator::kAutomatic, 0, 200}}) {
    auto organ = testing::organ_of({kind.model, kind.integrator});
    if (scene::is_solid(kind.model)) organ.tissue.youngs_modulus = 1e3;
    const auto model = build_organ_model(organ, Vec3::Zero(), testing::compact_shape(kind.model));
    const auto dynamics = solved_to_the_end(organ, model, kind.iterations);
    check_first_order(differences(let_go, *dynamics, model, kind.coarsest),
                      testing::name_of({kind.model, kind.integrator}));
  }
}

TEST_CASE("step halving: modes move exactly while nothing touches, so there is nothing to halve") {
  // Oracle: a damped oscillator's solution has no step. 1e-12: rounding of up to 1600 steps.
  const auto organ = testing::organ_of({"modal"});
  const auto model = build_organ_model(organ, Vec3::Zero(), testing::compact_shape(organ.model));
  const auto dynamics = make_dynamics(organ, model, testing::kPeriod);
  for (const double difference : differences(let_go, *dynamics, model, 10))
    CHECK(difference < 1e-12);
}

/// A standing organ pressed by a plate that comes down at 5 cm/s, no shock at the start.
std::vector<Vec3> press_down(OrganDynamics& dynamics, const OrganModel& model, int steps) {
  constexpr double kPlateSpeed = 0.05;
  const double h = kTime / steps;
  OrganState state = rest_state(model);
  std::vector<ContactRow> rows;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const double height = state.positions[i].z() / testing::kBallRadius + 1;
    state.velocities[i].z() = -kPlateSpeed * height / 2;
  }
  for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
    if (state.positions[i].z() < testing::kBallRadius - 1e-9) continue;
    ContactRow& row = rows.emplace_back();
    row.nodes = {i, i, i};
    row.weights = Vec3::UnitX();
    row.probe_velocity = Vec3(0, 0, -kPlateSpeed);
  }
  for (int s = 0; s < steps; ++s) {
    const double plate = testing::kBallRadius - kPlateSpeed * h * s;
    for (ContactRow& row : rows) row.gap = plate - state.positions[row.nodes[0]].z();
    dynamics.step(h, rows, state);
  }
  return state.positions;
}

TEST_CASE("step halving: modes under a plate are of first order") {
  // Oracle: the order of backward Euler, which they step by while something presses.
  auto organ = testing::organ_of({"modal"});
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.049)});
  const auto model = build_organ_model(organ, Vec3::Zero(), testing::compact_shape(organ.model));
  const auto dynamics = make_dynamics(organ, model, testing::kPeriod);
  check_first_order(differences(press_down, *dynamics, model, 200), "modal");
}

TEST_CASE("step halving: symplectic Euler's energy swings with the step but does not drift") {
  // Oracle: a symplectic method keeps a Hamiltonian near by: half the step, half the swing; no
  // trend over 500 swings. Undamped springs, no volume constraint.
  auto organ = testing::ball_organ();
  organ.model = "mass_spring";
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  const auto model = testing::ball_model(1, organ);
  double last_swing = 0;
  for (const double fraction : {0.4, 0.2, 0.1}) {
    auto dynamics = testing::springs_alone(model);
    const double h = fraction * dynamics.largest_step();
    OrganState state = rest_state(model);
    for (Vec3& p : state.positions) p = Vec3(1.02 * p.x(), p.y(), p.z() / 1.02);
    const double begin = dynamics.elastic_energy(state);
    double low[2] = {1e300, 1e300}, high[2] = {0, 0};
    const int steps = static_cast<int>(10'000 / fraction);
    for (int s = 0; s < steps; ++s) {
      dynamics.step(h, {}, state);
      double energy = dynamics.elastic_energy(state);
      for (std::size_t i = 0; i < model.node_count(); ++i) {
        energy += model.masses[i] * state.velocities[i].squaredNorm() / 2;
      }
      const int half = s < steps / 2 ? 0 : 1;
      low[half] = std::min(low[half], energy / begin);
      high[half] = std::max(high[half], energy / begin);
    }
    const double swing = high[1] - low[1];
    UNSCOPED_INFO(fraction << ": " << low[0] << " … " << high[0] << ", then " << low[1] << " … "
                           << high[1]);
    CHECK(std::abs(high[1] + low[1] - high[0] - low[0]) < swing);
    if (last_swing > 0) CHECK(last_swing / swing == Approx(2).margin(1));
    last_swing = swing;
  }
}

}  // namespace
}  // namespace palpate::deformation
