#include "deformation/elements/kernel/kernel_elements.h"

#include "deformation/elements/corotational.h"
#include "deformation/elements/kernel/corotational_kernel.h"
#include "deformation/elements/kernel/nodal_pressure_kernel.h"
#include "tests/deformation/elements/element_checks.h"
#include "tests/deformation/springs/chunk_threads.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

namespace {

/// Everything an ElasticForceElements says, about one state.
struct Answers {
  std::vector<Vec3> forces;
  std::vector<Mat3> diagonal;
  std::vector<Vec4f> product;
  Eigen::MatrixXf block;
  double energy = 0;
  Eigen::VectorXd pressures;
};

/// The nodes of a corner and what lies between: surface and inside.
Patch patch_of(const OrganModel& model, std::size_t count) {
  Patch patch;
  patch.places.assign(model.node_count(), -1);
  for (std::uint32_t node = 0; patch.nodes.size() < count; node += 2) {
    patch.places[node] = static_cast<std::int32_t>(patch.nodes.size());
    patch.nodes.push_back(node);
  }
  return patch;
}

Answers answers_of(ElasticForceElements& elements, const OrganModel& model,
                   const std::vector<Vec3>& positions) {
  Answers answers;
  elements.take_pressures_of_shape(positions, answers.pressures);
  remember(elements);
  linearise(elements, model, positions, 0.01);
  answers.forces = elements.forces();
  answers.diagonal = elements.diagonal();
  answers.product.resize(model.node_count());
  elements.apply(random_velocities(model.node_count()), answers.product);
  const Patch patch = patch_of(model, 12);
  answers.block = Eigen::MatrixXf::Zero(36, 36);
  elements.add_block(patch, 0.5f, answers.block);
  answers.energy = elements.energy(positions);
  return answers;
}

/// Largest difference over largest size.
struct Difference {
  double forces = 0, diagonal = 0, product = 0, block = 0, energy = 0, pressures = 0;
};

Difference difference(const Answers& a, const Answers& b) {
  Difference most;
  double force = 0, diagonal = 0, product = 0;
  for (std::size_t i = 0; i < a.forces.size(); ++i) {
    most.forces = std::max(most.forces, (a.forces[i] - b.forces[i]).norm());
    most.diagonal = std::max(most.diagonal, (a.diagonal[i] - b.diagonal[i]).norm());
    most.product =
        std::max(most.product, static_cast<double>((a.product[i] - b.product[i]).norm()));
    force = std::max(force, b.forces[i].norm());
    diagonal = std::max(diagonal, b.diagonal[i].norm());
    product = std::max(product, static_cast<double>(b.product[i].norm()));
  }
  const Eigen::MatrixXf low = b.block.triangularView<Eigen::Lower>();
  const Eigen::MatrixXf other = a.block.triangularView<Eigen::Lower>();
  most.block = static_cast<double>((other - low).norm() / low.norm());
  most.forces /= force;
  if (b.pressures.size() > 0) {
    most.pressures = (a.pressures - b.pressures).norm() / b.pressures.norm();
  }
  most.diagonal /= diagonal;
  most.product /= product;
  most.energy = std::abs(a.energy - b.energy) / b.energy;
  return most;
}

template <class Elements>
Answers kernel_answers(const OrganModel& model, const std::vector<Vec3>& positions,
                       ChunkRunner* runner, InstructionSet set) {
  Elements elements(LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra),
                    model.mesh().elastic(), runner, set);
  return answers_of(elements, model, positions);
}

/// Forces are double in both, and sum some twenty terms a hundred times as large as they are: 1e-12
/// is a hundred times their rounding. Blocks of float sum twenty terms, products fourteen blocks:
/// 2e-6 is twice what that rounds off at worst, relative to the largest.
template <class Plain, class Fast>
void check_agrees(const OrganModel& model, const std::vector<Vec3>& positions) {
  auto plain = elements_of<Plain>(model);
  const Answers expected = answers_of(plain, model, positions);
  for (const InstructionSet set : available_instruction_sets()) {
    const Difference found =
        difference(kernel_answers<Fast>(model, positions, nullptr, set), expected);
    INFO(name_of(set) << ", " << model.node_count() << " nodes");
    CHECK(found.forces < 1e-12);
    CHECK(found.energy < 1e-12);
    CHECK(found.pressures < 1e-12);
    CHECK(found.diagonal < 2e-6);
    CHECK(found.product < 2e-6);
    CHECK(found.block < 2e-6);
  }
}

bool same_bits(const Answers& a, const Answers& b) {
  return a.forces == b.forces && a.diagonal == b.diagonal && a.product == b.product &&
         a.block == b.block && a.pressures == b.pressures;
}

/// One set gives the same bits whatever the threads; `a` and `b` of all that fuse.
template <class Fast>
void check_bits(const OrganModel& model) {
  const auto positions = shaken(model, 2e-3);
  ChunkThreads two(2), three(3);
  std::vector<Answers> fused;
  for (const InstructionSet set : available_instruction_sets()) {
    INFO(name_of(set));
    const Answers alone = kernel_answers<Fast>(model, positions, nullptr, set);
    CHECK(same_bits(kernel_answers<Fast>(model, positions, &two, set), alone));
    CHECK(same_bits(kernel_answers<Fast>(model, positions, &three, set), alone));
    if (set != InstructionSet::kPortable) fused.push_back(alone);
  }
  for (const Answers& other : fused) CHECK(same_bits(other, fused.front()));
}

OrganModel kernel_cube(const char* model, double poisson_ratio, int cells) {
  return cube_model(solid_organ(model, poisson_ratio), Vec3::Zero(), cells);
}

}  // namespace

TEST_CASE("element kernel: nodal pressure agrees with the plain code") {
  // Oracle: average_nodal_pressure.h. A mesh of one part, and one of several; hardly and strongly
  // deformed, with tetrahedra inside out.
  for (const int cells : {2, 9}) {
    const auto model = kernel_cube("nodal_pressure", 0.499, cells);
    for (const double by : {1e-4, 2e-3, 1e-2}) {
      check_agrees<AverageNodalPressure, NodalPressureKernel>(model, shaken(model, by));
    }
  }
}

TEST_CASE("element kernel: corotational agrees with the plain code") {
  // Oracle: corotational.h, as above, also turned by two radians.
  for (const int cells : {2, 9}) {
    const auto model = kernel_cube("corotational", 0.4, cells);
    for (const double by : {1e-4, 2e-3}) {
      auto positions = shaken(model, by);
      check_agrees<Corotational, CorotationalKernel>(model, positions);
      const Quat turn(Eigen::AngleAxisd(2, Vec3(1, 2, -1).normalized()));
      for (Vec3& x : positions) x = turn * x;
      check_agrees<Corotational, CorotationalKernel>(model, positions);
    }
  }
}

TEST_CASE("element kernel: the same bits from any number of threads, and from AVX2 and AVX-512") {
  // Oracle: itself on one thread; itself with the other set, which does the same in the same order.
  check_bits<NodalPressureKernel>(kernel_cube("nodal_pressure", 0.499, 9));
  check_bits<CorotationalKernel>(kernel_cube("corotational", 0.4, 9));
}
