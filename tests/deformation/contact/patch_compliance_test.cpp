#include "deformation/contact/patch_compliance.h"

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "deformation/springs/patch_springs.h"
#include "deformation/springs/spring_forces.h"
#include "tests/deformation/organs.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

/// A ball of 42 nodes blown up by 5 %, so that all springs are in tension.
struct SwollenBall {
  OrganModel model = testing::ball_model(1);
  OrganState state = rest_state(model);
  PatchSprings springs{model.network(), model.node_count()};
  SwollenBall() {
    for (Vec3& x : state.positions) x *= 1.05;
  }

  /// All of the surface. Virtual nodes share no edge: a patch never has them.
  Patch whole() const {
    Patch patch;
    patch.places.assign(model.node_count(), -1);
    for (std::uint32_t i = 0; i < model.surface_node_count; ++i) {
      patch.places[i] = static_cast<std::int32_t>(i);
      patch.nodes.push_back(i);
    }
    return patch;
  }
  AddStiffness add() const {
    return [this](const Patch& patch, Eigen::MatrixXf& stiffness, Eigen::MatrixXf& damping) {
      springs.add(state.positions, patch, stiffness, damping);
    };
  }
};

Eigen::MatrixXd symmetric(const Eigen::MatrixXf& lower) {
  return lower.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
}

std::vector<ComplianceRow> some_rows() {
  return {{{{3, 0.2}, {7, 0.3}, {12, 0.5}}, Vec3(0.6, 0, 0.8), 0.3},
          {{{3, 1.0}}, Vec3::UnitY()},
          {{{20, 0.5}, {21, 0.5}}, Vec3::UnitX(), -0.4}};
}

/// C, three columns a node.
Eigen::MatrixXd matrix_of(const std::vector<ComplianceRow>& rows, std::size_t nodes) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()),
                                            static_cast<Eigen::Index>(3 * nodes));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [node, weight] : rows[r].weights) {
      C.block<1, 3>(static_cast<Eigen::Index>(r), 3 * node) += weight * rows[r].axis.transpose();
    }
  }
  return C;
}

TEST_CASE("patch springs: stiffness and damping are the derivatives of the springs' forces") {
  // Oracle: central differences of the plain forces. Tolerance: float, 1e-5 of the largest entry.
  SwollenBall ball;
  const Patch whole = ball.whole();
  const auto size = static_cast<Eigen::Index>(3 * whole.nodes.size());
  Eigen::MatrixXf stiffness = Eigen::MatrixXf::Zero(size, size), damping = stiffness;
  ball.springs.add(ball.state.positions, whole, stiffness, damping);
  const auto forces = [&](OrganState state, Eigen::Index column, double by, bool move) {
    auto& moved = move ? state.positions : state.velocities;
    moved[static_cast<std::size_t>(column / 3)][column % 3] += by;
    std::vector<Vec3> result(ball.model.node_count(), Vec3::Zero());
    add_spring_forces(ball.model.network(), state, result);
    return result;
  };
  for (const bool move : {true, false}) {
    const Eigen::MatrixXd matrix = symmetric(move ? stiffness : damping);
    const double h = move ? 1e-7 : 1;
    for (Eigen::Index column = 0; column < size; column += 5) {
      const auto more = forces(ball.state, column, h, move);
      const auto less = forces(ball.state, column, -h, move);
      for (Eigen::Index row = 0; row < size; ++row) {
        const auto node = static_cast<std::size_t>(row / 3);
        const double slope = -(more[node] - less[node])[row % 3] / (2 * h);
        REQUIRE(matrix(row, column) == Approx(slope).margin(1e-5 * matrix.cwiseAbs().maxCoeff()));
      }
    }
  }
}

TEST_CASE("patch compliance: of a patch that is the whole organ it is C A⁻¹ Cᵀ") {
  // Oracle: the dense matrix in double, inverted; with a kept volume the bordered one. Tolerance:
  // float's ε times the condition of A, of the largest entry. In explicit steps all of it in the
  // proportion that the rows' press gives way in them (even_press_test.cpp).
  const SwollenBall ball;
  PatchCompliance compliance(ball.model, Neighbours(ball.model, {}), ball.model.node_count());
  VolumeGradient volume;
  evaluate_volume(ball.model, ball.state.positions, volume);
  const auto rows = some_rows();
  const Eigen::MatrixXd C = matrix_of(rows, ball.model.surface_node_count);
  const Eigen::Index size = C.cols();
  for (const bool implicit : {false, true}) {
    const PeriodSteps steps{0.01, 4, implicit};
    const double T = steps.period, moving = implicit ? 1 : 0.75,
                 displaced = implicit ? 0.625 : 0.375;
    PressedPatch pressed;
    pressed.stiffness = pressed.damping = Eigen::MatrixXf::Zero(size, size);
    ball.springs.add(ball.state.positions, ball.whole(), pressed.stiffness, pressed.damping);
    Eigen::MatrixXd A =
        displaced * symmetric(pressed.stiffness) + moving / T * symmetric(pressed.damping);
    for (Eigen::Index i = 0; i < size; ++i) {
      A(i, i) += ball.model.masses[static_cast<std::size_t>(i / 3)] *
                 (1 + T * ball.model.drag * moving) / (T * T);
    }
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(size + 1, size + 1);
    bordered.topLeftCorner(size, size) = A;
    for (std::size_t i = 0; i < volume.gradient.size(); ++i) {
      bordered.block<3, 1>(static_cast<Eigen::Index>(3 * i), size) = volume.gradient[i];
      bordered.block<1, 3>(size, static_cast<Eigen::Index>(3 * i)) = volume.gradient[i].transpose();
    }
    const Eigen::MatrixXd free = C * inverse_of(A) * C.transpose();
    const Eigen::MatrixXd kept = C * inverse_of(bordered).topLeftCorner(size, size) * C.transpose();
    const auto found_free = compliance.solve(ball.state.positions, rows, steps, {}, ball.add());
    const auto found_kept =
        compliance.solve(ball.state.positions, rows, steps, volume.gradient, ball.add());
    const Eigen::VectorXd modes = eigenvalues_of(A);
    const double tolerance = std::numeric_limits<float>::epsilon() * modes.maxCoeff() /
                             modes.minCoeff() * free.cwiseAbs().maxCoeff();
    const auto scale = [&](const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
      return implicit ? 1 : found.norm() / expected.norm();
    };
    CHECK((found_free - scale(found_free, free) * free).cwiseAbs().maxCoeff() < tolerance);
    CHECK((found_kept - scale(found_kept, kept) * kept).cwiseAbs().maxCoeff() < tolerance);
    if (implicit) continue;
    pressed.push = C.transpose() * Eigen::Vector3d(0.6, 0, -0.8);
    pressed.drag = ball.model.drag;
    pressed.volume = Eigen::VectorXd::Zero(size);
    pressed.masses.resize(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      pressed.masses[i] = ball.model.masses[static_cast<std::size_t>(i / 3)];
    }
    const double of_press = even_press_compliance(pressed, T, steps.count);
    const Eigen::Vector3d press(0.6, 0, -0.8);
    CHECK(press.dot(found_free * press) == Approx(of_press).epsilon(1e-4));
    CHECK((free - kept).cwiseAbs().maxCoeff() > 10 * tolerance);
  }
}

TEST_CASE("patch compliance: what goes along beyond a small patch is counted on a fine wall") {
  // Oracle: the same with a patch as large as the far one, dense. A contact of seven nodes on a
  // ball of 2,562, a step in which hundreds go along. As a whole it gives way within 5 % of that
  // and never more (Galerkin; 2e-3: far
  // couplings have eight binary digits); without the far nodes a tenth is
  // missing at least, so that there is something to find.
  scene::Organ organ = testing::ball_organ();
  organ.springs.inner_ratio = 0;
  const OrganModel model = testing::ball_model(4, organ);
  const PatchSprings springs(model.network(), model.node_count());
  std::vector<Vec3> positions = model.rest_positions;
  for (Vec3& x : positions) x *= 1.02;
  const AddStiffness add = [&](const Patch& patch, Eigen::MatrixXf& stiffness,
                               Eigen::MatrixXf& damping) {
    springs.add(positions, patch, stiffness, damping);
  };
  std::vector<ComplianceRow> rows;
  const Neighbours neighbours(model, {});
  for (const std::uint32_t node : neighbours.of(50)) {
    rows.push_back({{{node, 0.5}, {50, 0.5}}, positions[node].normalized()});
  }
  const PeriodSteps steps{0.15, 1, true};
  // Σ W with the nodes of a patch of so many alone: no patch but the largest has none beyond it.
  const auto held_beyond = [&](std::size_t nodes) {
    Patch patch;
    std::vector<std::uint32_t> touched{50};
    Vec3 centre = Vec3::Zero();
    for (const ComplianceRow& row : rows) {
      touched.push_back(row.weights[0].first);
      centre += 0.5 * (positions[50] + positions[row.weights[0].first]) / double(rows.size());
    }
    grow_patch(model, neighbours, positions, touched, centre, nodes, patch);
    const auto size = static_cast<Eigen::Index>(3 * patch.nodes.size());
    const double T = steps.period;
    Eigen::MatrixXf stiffness = Eigen::MatrixXf::Zero(size, size), damping = stiffness;
    add(patch, stiffness, damping);
    Eigen::MatrixXf A = static_cast<float>(steps.displaced()) * stiffness +
                        static_cast<float>(steps.moving() / T) * damping;
    Eigen::VectorXf push = Eigen::VectorXf::Zero(size);
    for (const std::uint32_t node : patch.nodes) {
      A.diagonal().segment<3>(3 * patch.place(node)).array() +=
          static_cast<float>((1 + T * model.drag) / (T * T) * model.masses[node]);
    }
    for (const ComplianceRow& row : rows) {
      for (const auto& [node, weight] : row.weights) {
        push.segment<3>(3 * patch.place(node)) += (weight * row.axis).cast<float>();
      }
    }
    return double(push.dot(A.selfadjointView<Eigen::Lower>().llt().solve(push)));
  };
  PatchCompliance compliance(model, neighbours, 32);
  const double exact = held_beyond(400), small = held_beyond(32),
               found = compliance.solve(positions, rows, steps, {}, add).sum();
  CHECK(found < 1.002 * exact);
  CHECK(found > 0.95 * exact);
  CHECK(small < 0.9 * exact);
}

/// Elements whose products tell nodes of the patch to be dragged along a thousand times as hard as
/// their blocks say: no matrix is positive that has both.
class TornApart : public ElasticForceElements {
 public:
  TornApart(ElasticForceElements& whole, Patch patch) : whole_(whole), patch_(std::move(patch)) {}
  void linearise(const std::vector<Vec3>& positions, double scale,
                 std::span<const double> shift) override {
    whole_.linearise(positions, scale, shift);
  }
  const std::vector<Vec3>& forces() const override { return whole_.forces(); }
  const std::vector<Mat3>& diagonal() const override { return whole_.diagonal(); }
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) override {
    whole_.apply(p, out);
    for (const std::uint32_t node : patch_.nodes) out[node] *= 1000;
  }
  void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const override {
    whole_.add_block(patch, share, sum);
  }
  double energy(const std::vector<Vec3>& positions) override { return whole_.energy(positions); }

 private:
  ElasticForceElements& whole_;
  Patch patch_;
};

TEST_CASE("patch compliance: a solid goes along beyond the patch") {
  // Oracle: the same with all free nodes of a cube of 512 in the patch, dense. As a whole it gives
  // way within 5 % of that and never more (Galerkin; 1e-4: floats); without the others a fifth is
  // missing at least, so that there is something to find. Touched nodes that the patch has no place
  // for answer as if alone, too: 44 of 64 make it too soft by a tenth at most, and more than twice
  // as soft without the others.
  scene::Organ organ = testing::solid_organ("nodal_pressure", 0.45);
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-3)});
  const OrganModel model = testing::cube_model(organ, Vec3::Zero(), 7);
  const auto dynamics = make_dynamics(organ, model, 0.01);
  OrganState state = rest_state(model);
  dynamics->step(0.01, {}, state);
  const AddStiffness add = [&](const Patch& patch, Eigen::MatrixXf& stiffness, Eigen::MatrixXf&) {
    dynamics->add_stiffness(patch, stiffness);
  };
  const Neighbours neighbours(model, model.mesh().tetrahedra);
  const PeriodSteps steps{0.01, 1, true};
  // About the middle of the top: places 8 × 8.
  const auto top = [](std::uint32_t i, std::uint32_t j) { return 448 + 8 * j + i; };
  std::vector<ComplianceRow> few, many;
  for (const std::uint32_t i : {3u, 4u}) {
    few.push_back({{{top(i, 3), 0.5}, {top(i, 4), 0.5}}, Vec3::UnitZ(), 1});
  }
  for (std::uint32_t j = 0; j < 8; ++j) {
    many.push_back({{}, Vec3::UnitZ(), 1});
    for (std::uint32_t i = 0; i < 8; ++i) many.back().weights.push_back({top(i, j), 0.125});
  }
  const auto solve = [&](const std::vector<ComplianceRow>& rows, std::size_t nodes,
                         const StepMatrix& last) {
    return PatchCompliance(model, neighbours, nodes)
        .solve(state.positions, rows, steps, {}, add, last)
        .sum();
  };
  constexpr std::size_t kAll = 512, kSmall = 20;
  const double few_exact = solve(few, kAll, {}), many_exact = solve(many, kAll, {});
  const double few_found = solve(few, kSmall, dynamics->step_matrix());
  CHECK(few_found < 1.0001 * few_exact);
  CHECK(few_found > 0.95 * few_exact);
  CHECK(solve(few, kSmall, {}) < 0.8 * few_exact);
  // Where the two together are no matrix, the patch answers as if all else were held.
  std::vector<std::uint32_t> touched{top(3, 3), top(3, 4), top(4, 3), top(4, 4)};
  Patch patch;
  grow_patch(model, neighbours, state.positions, touched,
             (state.positions[touched[0]] + state.positions[touched[3]]) / 2, kSmall, patch);
  StepMatrix torn = dynamics->step_matrix();
  TornApart elements(*torn.elements, patch);
  torn.elements = &elements;
  CHECK(solve(few, kSmall, torn) == Approx(solve(few, kSmall, {})).epsilon(1e-5));
  CHECK(solve(many, kSmall, dynamics->step_matrix()) == Approx(many_exact).epsilon(0.1));
  CHECK(solve(many, kSmall, {}) > 2 * many_exact);
}

TEST_CASE("patch compliance: in a single explicit step masses answer, whatever rows share") {
  // Oracle: the dense C M⁻¹ Cᵀ T²/(1 + …) in double; with a kept volume that of the bordered
  // matrix. Rows name a node twice, share nodes, and one of them is fixed. Tolerance: rounding of
  // the dense inverse, some hundred numbers summed.
  SwollenBall ball;
  ball.model.inverse_masses[7] = 0;
  PatchCompliance compliance(ball.model, Neighbours(ball.model, {}), 4);
  VolumeGradient volume;
  evaluate_volume(ball.model, ball.state.positions, volume);
  auto rows = some_rows();
  rows.push_back({{{3, 0.3}, {20, 0.1}, {3, 0.2}, {30, 0.4}}, Vec3(0, 0.6, -0.8)});
  const double T = 0.01;
  const Eigen::MatrixXd C = matrix_of(rows, ball.model.surface_node_count);
  Eigen::VectorXd W(C.cols()), g(C.cols());
  for (Eigen::Index i = 0; i < C.cols(); ++i) {
    const auto node = static_cast<std::size_t>(i / 3);
    W[i] = T * T * ball.model.inverse_masses[node];
    g[i] = volume.gradient[node][i % 3];
  }
  const Eigen::MatrixXd free = C * W.asDiagonal() * C.transpose();
  const Eigen::VectorXd share = C * W.cwiseProduct(g);
  const Eigen::MatrixXd kept = free - share * share.transpose() / g.dot(W.cwiseProduct(g));
  const auto found_free = compliance.solve(ball.state.positions, rows, {T, 1, false}, {}, {});
  const auto found_kept =
      compliance.solve(ball.state.positions, rows, {T, 1, false}, volume.gradient, {});
  CHECK((found_free - free).norm() < 1e-13 * free.norm());
  CHECK((found_kept - kept).norm() < 1e-13 * free.norm());
  CHECK((kept - free).norm() > 1e-3 * free.norm());
}

TEST_CASE("patch compliance: in a single explicit step only masses answer") {
  // Oracle: by hand, Σ b² T²/m, and nothing between rows that share no node.
  const SwollenBall ball;
  SwollenBall drag_free;
  drag_free.model.drag = 0;
  PatchCompliance without_drag(drag_free.model, Neighbours(drag_free.model, {}), 5);
  const auto W =
      without_drag.solve(ball.state.positions, some_rows(), {0.004, 1, false}, {}, ball.add());
  const auto& w = ball.model.inverse_masses;
  const double T2 = 0.004 * 0.004;
  CHECK(W(0, 0) == Approx(T2 * (0.04 * w[3] + 0.09 * w[7] + 0.25 * w[12])).epsilon(1e-6));
  CHECK(W(1, 1) == Approx(T2 * w[3]).epsilon(1e-6));
  CHECK(W(0, 2) == Approx(0).margin(1e-12));
  // A touch of more nodes than the patch has asks for those in reach too.
  ComplianceRow wide{{}, Vec3::UnitZ()};
  double expected = 0;
  for (std::uint32_t node = 0; node < 20; ++node) {
    wide.weights.push_back({node, 0.05});
    expected += T2 * 0.05 * 0.05 * w[node];
  }
  const auto of_wide = without_drag.solve(ball.state.positions, std::vector{wide},
                                          {0.004, 1, false}, {}, ball.add());
  CHECK(of_wide(0, 0) == Approx(expected).epsilon(1e-6));
}

}  // namespace
}  // namespace palpate::deformation
