#include "deformation/steppers/modal.h"

#include <catch2/catch.hpp>

#include "deformation/steppers/modal_analysis.h"
#include "deformation/steppers/newton_backward_euler.h"
#include "squeeze.h"

namespace palpate::deformation {
namespace {

constexpr double kPi = 3.14159265358979323846;

scene::Organ modal_organ(double drag = 0) {
  auto organ = testing::reference_ball("modal");
  organ.tissue.drag = drag;
  return organ;
}

/// The block stands on z = −3 cm.
scene::Organ standing_organ() {
  auto organ = modal_organ(30);
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.0299)});
  return organ;
}

TEST_CASE("modal: the frequencies of a free ball are Lamb's") {
  // Oracle: analytic, studies/reference E. The mesh errs by 0.2 % in the lowest ten, 0.9 %
  // above.
  if (geometry::testing::without_gmsh()) return;
  const auto organ = modal_organ();
  const auto model =
      build_organ_model(organ, Vec3::Zero(), testing::ball_shape(organ.model, 0.05, 0.02));
  const Modal modal(model, 27, 0);
  const auto& frequencies = modal.angular_frequencies();
  REQUIRE(frequencies.size() == 33);
  CHECK(frequencies.head<6>().isZero(0));
  CHECK(frequencies.segment<5>(6).mean() / (2 * kPi) == Approx(9.98627).epsilon(5e-3));
  CHECK(frequencies.segment<5>(11).mean() / (2 * kPi) == Approx(10.6427).epsilon(5e-3));
  CHECK(frequencies.segment<10>(16).mean() / (2 * kPi) == Approx(15.4356).epsilon(1e-2));
  CHECK(frequencies.segment<7>(26).mean() / (2 * kPi) == Approx(15.9775).epsilon(1e-2));
}

TEST_CASE("modal: a scene says how many modes, beside rigid motion, and how damped") {
  // Oracle: the scene; and what a mesh of 27 nodes cannot give is not asked of it.
  auto organ = modal_organ();
  organ.solid.modes = 5;
  const auto model = testing::block_model(organ, 1);
  const auto dynamics = make_dynamics(organ, model, 0.01);
  const auto* few = dynamic_cast<const Modal*>(dynamics.get());
  REQUIRE(few != nullptr);
  CHECK(few->angular_frequencies().size() == 6 + 5);
  organ.solid.modes = 400;
  const auto many = make_dynamics(organ, model, 0.01);
  CHECK(dynamic_cast<const Modal&>(*many).angular_frequencies().size() == 6 + 81 / 4);
}

TEST_CASE("modal: an organ at rest stays there") {
  const auto model = testing::block_model(modal_organ(), 2);
  Modal modal(model, 20, 0.1);
  testing::check_stays_at_rest(model, modal, 0);
}

TEST_CASE("modal: free fall is exact for any step") {
  // Oracle: analytic, ½ g t², 1e-8 of what the modes were found to.
  const auto model = testing::block_model(modal_organ(), 2, Vec3(1, 2, -9.81));
  Modal modal(model, 20, 0.1);
  OrganState state = rest_state(model);
  for (int k = 0; k < 10; ++k) modal.step(0.01, {}, state);
  const Vec3 fallen = 0.5 * 0.1 * 0.1 * model.gravity;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3 moved = state.positions[i] - model.rest_positions[i];
    REQUIRE((moved - fallen).norm() < 1e-6 * fallen.norm());
  }
}

TEST_CASE("modal: a mode swings and decays as a damped oscillator, whatever the step") {
  // Oracle: analytic, e^(−δt) (cos ω't + δ/ω' sin ω't), from a shape found apart, for light and
  // for strong damping.
  const auto model = testing::block_model(standing_organ(), 2);
  const auto found = deformation::modal_analysis(quadratic_solid(model), dirichlet_dofs(model), 12);
  for (const double damping_ratio : {0.05, 1.5}) {
    Modal modal(model, 12, damping_ratio);
    for (const int k : {0, 4}) {
      const double frequency = found.angular_frequencies[static_cast<std::size_t>(k)];
      const double decay = damping_ratio * frequency + model.drag / 2;
      const double square = frequency * frequency - decay * decay,
                   swing = std::sqrt(std::abs(square));
      for (const double h : {1e-3, 1e-2}) {
        OrganState state = rest_state(model);
        const auto shape = found.modes.col(k) * 1e-3;
        for (std::size_t i = 0; i < model.node_count(); ++i) {
          state.positions[i] += shape.segment<3>(static_cast<Eigen::Index>(3 * i));
        }
        const OrganState start = state;
        const double t = 0.03;
        for (int n = 0; n < static_cast<int>(std::round(t / h)); ++n) modal.step(h, {}, state);
        const double c = square > 0 ? std::cos(swing * t) : std::cosh(swing * t);
        const double s = (square > 0 ? std::sin(swing * t) : std::sinh(swing * t)) / swing;
        const double left = std::exp(-decay * t) * (c + decay * s);
        double error = 0, size = 0;
        for (std::size_t i = 0; i < model.node_count(); ++i) {
          const Vec3& x = model.rest_positions[i];
          size = std::max(size, (start.positions[i] - x).norm());
          error =
              std::max(error, (state.positions[i] - x - left * (start.positions[i] - x)).norm());
        }
        CHECK(error < 1e-4 * size);  // what modes of equal frequency were mixed by
      }
    }
  }
}

TEST_CASE("modal: a standing block sags like the elements it comes from") {
  // Oracle: independent method, the nonlinear elements under a weight so small that they are
  // linear. 60 of 750 coordinates' modes are 2 % short of the sag.
  auto organ = standing_organ();
  const Vec3 gravity(0.05, 0, -0.1);
  const auto sag = [&](OrganDynamics& dynamics, const OrganModel& model) {
    OrganState state = rest_state(model);
    for (int k = 0; k < 200; ++k) dynamics.step(0.01, {}, state);
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      mean += state.positions[i] - model.rest_positions[i];
    }
    return Vec3(mean / static_cast<double>(model.node_count()));
  };
  const auto model = testing::block_model(organ, 2, gravity);
  Modal modal(model, 60, 0.1);
  NewtonBackwardEuler elements(model);
  const Vec3 wanted = sag(elements, model), found = sag(modal, model);
  CHECK(found.x() == Approx(wanted.x()).epsilon(0.03));
  CHECK(found.z() == Approx(wanted.z()).epsilon(0.03));
}

TEST_CASE("modal: between plates nothing penetrates, pulls or blows up, far beyond its range") {
  // Oracle: invariants. Linear springs in parallel: force grows, at most a probe's own speed.
  const auto model = testing::block_model(modal_organ(10), 2);
  Modal modal(model, 40, 0.1);
  testing::Squeeze squeeze(model, modal, 0.03);
  double last = 0;
  for (const double height : {0.028, 0.024, 0.015, 0.006}) {
    const double force = squeeze.go_to(height, 0.1, 0.5);
    CHECK(force > last);
    CHECK(squeeze.deepest() < 1e-4);
    CHECK(squeeze.equatorial_radius() < 0.2);
    last = force;
  }
}

TEST_CASE("modal: friction stays within Coulomb's cone and drags the organ along") {
  // Oracle: Coulomb, momentum: a free organ under its weight on a floor that moves.
  const auto model = testing::block_model(modal_organ(), 2, Vec3(0, 0, -9.81));
  Modal modal(model, 20, 0.2);
  OrganState state = rest_state(model);
  std::vector<ContactRow> rows;
  double rubbed = 0;
  for (int k = 0; k < 20; ++k) {
    rows.clear();
    for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
      const double gap = state.positions[i].z() + 0.03;
      if (gap > 5e-3) continue;
      ContactRow row{.nodes = {i, i, i}, .weights = Vec3(1, 0, 0), .normal = -Vec3::UnitZ()};
      row.gap = gap;
      row.friction = 0.3;
      row.probe_velocity = Vec3(1, 0, 0);
      rows.push_back(row);
    }
    modal.step(5e-3, rows, state);
    for (const auto& row : rows) {
      CHECK(row.tangential_impulse.norm() <= 0.3 * row.normal_impulse * (1 + 1e-9));
      rubbed += row.tangential_impulse.x();
    }
  }
  const auto solid = quadratic_solid(model);
  double momentum = 0;
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    const Eigen::VectorXd shares = solid.mass(e).rowwise().sum();
    for (int a = 0; a < deformation::kElementNodes; ++a) {
      momentum += shares[a] * state.velocities[solid.mesh().elements[e][a]].x();
    }
  }
  CHECK(rubbed > 0);
  CHECK(momentum == Approx(rubbed).epsilon(1e-6));
}

}  // namespace
}  // namespace palpate::deformation
