#include "bench/solids/step_cost.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>

#include "deformation/elements/average_nodal_pressure.h"
#include "deformation/elements/corotational.h"
#include "deformation/models.h"
#include "deformation/steppers/linearly_implicit_euler.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/schema.h"

namespace palpate::solids_bench {
namespace {

using namespace deformation;  // NOLINT: a bench of it

constexpr double kStep = 0.01;  // [s]
constexpr int kRounds = 100;

/// Keeps the least.
template <typename Work>
void time_least(double& least, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  least = std::min(least, elapsed.count());
}

/// K p of linear elasticity at rest, tetrahedron by tetrahedron.
void plain_product(const LinearTetrahedra& tetrahedra, double mu, double lambda,
                   const std::vector<Vec3>& p, std::vector<Vec3>& out) {
  std::fill(out.begin(), out.end(), Vec3::Zero());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    const Mat3 H = tetrahedra.deformation_gradient(e, p);
    const Mat3 P = mu * (H + H.transpose()) + lambda * H.trace() * Mat3::Identity();
    const Mat34 pushes = tetrahedra.volumes[e] * P * tetrahedra.gradients[e];
    for (std::size_t a = 0; a < 4; ++a) {
      out[tetrahedra.corners[e][a]] += pushes.col(static_cast<int>(a));
    }
  }
}

scene::Organ hung_organ(const std::string& model, const geometry::TetMesh& mesh) {
  scene::Organ organ;
  organ.name = "solid";
  organ.model = model;
  organ.tissue.youngs_modulus = 5e3;
  organ.solid.poisson_ratio = model == "corotational" ? 0.45 : 0.499;
  Vec3 low = mesh.nodes[0], high = low;
  for (const Vec3& x : mesh.nodes) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double margin = (high - low).norm();
  Vec3 held = high + Vec3::Constant(margin);
  held.x() = low.x() + 0.1 * (high.x() - low.x());
  organ.fixed.push_back(scene::BoxRegion{low - Vec3::Constant(margin), held});
  return organ;
}

}  // namespace

void print_step_cost(const std::string& model, const geometry::TetMesh& mesh) {
  const auto organ = hung_organ(model, mesh);
  const auto built = build_organ_model(organ, Vec3(0, 0, -9.81), geometry::shape_of(mesh));
  const LinearTetrahedra tetrahedra(built.rest_positions, built.mesh().tetrahedra);
  std::unique_ptr<ElasticForceElements> elements;
  if (model == "corotational") {
    elements = std::make_unique<Corotational>(tetrahedra, built.mesh().elastic());
  } else {
    elements = std::make_unique<AverageNodalPressure>(tetrahedra, built.mesh().elastic());
  }
  const auto dynamics = make_dynamics(organ, built, kStep);
  const auto& solid = dynamic_cast<const LinearlyImplicitEuler&>(*dynamics);
  auto state = rest_state(built);
  std::vector<Vec4f> p(built.node_count(), Vec4f(1e-3f, 2e-3f, 3e-3f, 0)), out = p;
  std::vector<Vec3> plain_p(built.node_count(), Vec3(1e-3, 2e-3, 3e-3)), plain_out = plain_p;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  double step = kNever, linearisation = kNever, product = kNever, yardstick = kNever;
  double iterations = 0;
  for (int k = 0; k < kRounds; ++k) {
    time_least(step, [&] { dynamics->step(kStep, {}, state); });
    iterations += static_cast<double>(solid.iterations_used()) / kRounds;
    time_least(linearisation,
               [&] { elements->linearise(state.positions, kStep * kStep, built.masses); });
    time_least(product, [&] { elements->apply(p, out); });
    time_least(yardstick, [&] { plain_product(tetrahedra, 2e3, 1e4, plain_p, plain_out); });
  }
  const double per_tetrahedron = 1e9 / static_cast<double>(tetrahedra.size());
  std::printf("%s: %zu nodes, %zu tetrahedra, %.1f iterations per step of 10 ms\n", model.c_str(),
              built.node_count(), tetrahedra.size(), iterations);
  std::printf("  step           %8.3f ms, of %d the least\n", 1e3 * step, kRounds);
  std::printf("  linearisation  %8.3f ms, %6.1f ns per tetrahedron\n", 1e3 * linearisation,
              linearisation * per_tetrahedron);
  std::printf("  product        %8.3f ms, %6.1f ns per tetrahedron, %.2f of a plain element loop\n",
              1e3 * product, product * per_tetrahedron, product / yardstick);
}

}  // namespace palpate::solids_bench
