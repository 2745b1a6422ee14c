#include "bench/solids/step_cost.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <type_traits>

#include "deformation/elements/average_nodal_pressure.h"
#include "deformation/elements/corotational.h"
#include "deformation/elements/kernel/corotational_kernel.h"
#include "deformation/elements/kernel/nodal_pressure_kernel.h"
#include "deformation/linear_algebra/conjugate_gradients.h"
#include "deformation/models.h"
#include "deformation/steppers/linearly_implicit_euler.h"
#include "modules/geometry/organ_shape.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/models.h"
#include "modules/scene/schema.h"

namespace palpate::solids_bench {
namespace {

using namespace deformation;  // NOLINT: a bench of it

constexpr double kStep = 0.01;  // [s]
/// A touch takes so many; the model makes 80 at most.
constexpr int kOfCorotational = 20;
constexpr int kRounds = 100;

/// The least time of some work [s]: other programs on the machine only ever add.
struct Least {
  double seconds = std::numeric_limits<double>::infinity();

  template <typename Work>
  void time(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    seconds = std::min(seconds, elapsed.count());
  }
};

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

/// A way to make the elements of a model.
template <class Elements>
std::unique_ptr<ElasticForceElements> made(const OrganModel& model, ChunkRunner* runner) {
  LinearTetrahedra tetrahedra(model.rest_positions, model.mesh().tetrahedra);
  if constexpr (std::is_base_of_v<KernelElements, Elements>) {
    return std::make_unique<Elements>(std::move(tetrahedra), model.mesh().elastic(), runner);
  } else {
    return std::make_unique<Elements>(std::move(tetrahedra), model.mesh().elastic());
  }
}

/// A x = b of a step, b from its forces and weights, preconditioned by 3×3 blocks as the stepper
/// does.
class StepSystem {
 public:
  StepSystem(const OrganModel& model, ElasticForceElements& elements)
      : elements_(elements), r_(model.node_count(), Vec4f::Zero()), z_(r_), d_(r_), q_(r_) {
    for (std::size_t i = 0; i < r_.size(); ++i) {
      blocks_.emplace_back(Eigen::Matrix3f::Zero());
      if (model.inverse_masses[i] == 0) continue;
      blocks_[i] = elements.diagonal()[i].inverse().cast<float>();
      const Vec3 force = elements.forces()[i] + model.masses[i] * model.gravity;
      r_[i].head<3>() = (kStep * force).cast<float>();
    }
  }
  double begin() {
    const double descent = precondition();
    d_ = z_;
    return descent;
  }
  double curvature() {
    elements_.apply(d_, q_);
    return dot(d_, q_);
  }
  double descend(double length) {
    add(static_cast<float>(-length), q_, r_);
    return precondition();
  }
  void turn(double kept) {
    for (std::size_t i = 0; i < d_.size(); ++i) d_[i] = z_[i] + static_cast<float>(kept) * d_[i];
  }

 private:
  double precondition() {
    for (std::size_t i = 0; i < r_.size(); ++i) z_[i].head<3>() = blocks_[i] * r_[i].head<3>();
    return dot(r_, z_);
  }

  ElasticForceElements& elements_;
  std::vector<Eigen::Matrix3f> blocks_;
  std::vector<Vec4f> r_, z_, d_, q_;
};

/// The elements alone and a step with them, of one organ that sways.
class Swaying {
 public:
  using Make = std::unique_ptr<ElasticForceElements> (*)(const OrganModel&, ChunkRunner*);

  Swaying(const char* name, const OrganModel& model, Make make, int iterations, ChunkRunner* runner)
      : name_(name),
        model_(model),
        elements_(make(model, runner)),
        stepper_(model, make(model, runner), iterations),
        state_(rest_state(model)),
        p_(model.node_count(), Vec4f(1e-3f, 2e-3f, 3e-3f, 0)),
        out_(p_) {}

  void turn() {
    step_.time([&] { stepper_.step(kStep, {}, state_); });
    iterations_ += stepper_.iterations_used();
    linearisation_.time(
        [&] { elements_->linearise(state_.positions, kStep * kStep, model_.masses); });
    product_.time([&] { elements_->apply(p_, out_); });
  }

  /// Of conjugate gradients until the residual, r·z, is 1e-4 of what it was: 1e-2 in its norm.
  int enough() {
    elements_->linearise(state_.positions, kStep * kStep, model_.masses);
    StepSystem system(model_, *elements_);
    return conjugate_gradients(system, 1000, 0, 1e-4).iterations;
  }

  void print(const Swaying& plain) const {
    std::printf("  %-26s %8.3f %5.1f %8.3f %7.1f %8.4f %7.2f %7.2f %7.2f\n", name_,
                1e3 * step_.seconds, static_cast<double>(iterations_) / kRounds,
                1e3 * linearisation_.seconds,
                1e9 * linearisation_.seconds / static_cast<double>(model_.mesh().tetrahedra.size()),
                1e3 * product_.seconds, plain.step_.seconds / step_.seconds,
                plain.linearisation_.seconds / linearisation_.seconds,
                plain.product_.seconds / product_.seconds);
  }

 private:
  const char* name_;
  const OrganModel& model_;
  std::unique_ptr<ElasticForceElements> elements_;
  LinearlyImplicitEuler stepper_;
  OrganState state_;
  std::vector<Vec4f> p_, out_;
  Least step_, linearisation_, product_;
  int iterations_ = 0;
};

/// The least of some makings of the organ and its stepper [s].
double seconds_to_build(const scene::Organ& organ, const geometry::OrganShape& shape) {
  Least least;
  for (int k = 0; k < 5; ++k) {
    least.time([&] {
      const auto built = build_organ_model(organ, Vec3(0, 0, -9.81), shape);
      make_dynamics(organ, built, kStep);
    });
  }
  return least.seconds;
}

}  // namespace

void print_step_cost(const std::string& model, const geometry::TetMesh& mesh) {
  const auto organ = hung_organ(model, mesh);
  const auto shape = geometry::shape_of(mesh);
  const auto built = build_organ_model(organ, Vec3(0, 0, -9.81), shape);
  const bool corotational = model == "corotational";
  const auto plain = corotational ? made<Corotational> : made<AverageNodalPressure>;
  const auto fast = corotational ? made<CorotationalKernel> : made<NodalPressureKernel>;
  const int most =
      corotational ? kOfCorotational : static_cast<int>(scene::format_of(organ.model).iterations);
  runtime::WorkerTeam team(2);
  std::vector<Swaying> ways;
  ways.reserve(5);
  ways.emplace_back("plain", built, plain, most, nullptr);
  ways.emplace_back("kernel", built, fast, most, nullptr);
  ways.emplace_back("kernel, two threads", built, fast, most, &team);
  int enough = 0;
  Swaying looked_at("", built, fast, most, nullptr);
  for (int k = 0; k < kRounds; ++k) {
    looked_at.turn();
    enough += looked_at.enough();
  }
  ways.emplace_back("kernel, 40 iterations", built, fast, 40, nullptr);
  ways.emplace_back("kernel, residual 1e-2", built, fast, (enough + kRounds - 1) / kRounds,
                    nullptr);
  for (int k = 0; k < kRounds; ++k) {
    for (Swaying& way : ways) way.turn();
  }
  std::printf("%s: %zu nodes, %zu tetrahedra, built in %.2f ms; steps of 10 ms, the least of %d\n",
              model.c_str(), built.node_count(), built.mesh().tetrahedra.size(),
              1e3 * seconds_to_build(organ, shape), kRounds);
  std::printf("  %-26s %8s %5s %8s %7s %8s %23s\n", "", "step", "it.", "lineari-", "ns per",
              "product", "plain over it: step,");
  std::printf("  %-26s %8s %5s %8s %7s %8s %23s\n", "", "[ms]", "", "sation", "tet.", "[ms]",
              "linearisation, product");
  for (const Swaying& way : ways) way.print(ways.front());
}

}  // namespace palpate::solids_bench
