// Visits of springs for any instruction set: included once by each spring_gauss_seidel_<set>.cpp,
// which is compiled for that set and gives a struct of kWidth lanes:
//
//   Pack                       kWidth doubles with + − * / elementwise
//   broadcast, load, store     a Pack from and to memory
//   root(pack)                 elementwise
//   load_nodes(base, offsets)  x, y, z and the fourth double of kWidth nodes
//   store_nodes(base, offsets, nodes)
#pragma once

#include "deformation/springs/kernel/spring_gauss_seidel_arrays.h"

namespace palpate::deformation::kernel {
namespace {

template <class Set>
struct VisitedNodes {
  typename Set::Pack x, y, z, inverse_mass;
};

template <class Set>
struct Visitor {
  using Pack = typename Set::Pack;
  using Nodes = VisitedNodes<Set>;

  /// x += s d
  static void move(const Pack& s, const Pack (&d)[3], Nodes& nodes) {
    nodes.x = nodes.x + s * d[0];
    nodes.y = nodes.y + s * d[1];
    nodes.z = nodes.z + s * d[2];
  }

  /// xpbd_springs.h's Δλ and what it moves; with one root and one division.
  template <bool kOnly>
  static void visit(const VisitPass& pass, const VisitBatch& batch, std::size_t lane,
                    double* multipliers) {
    const Pack per_h = Set::broadcast(pass.per_h);
    const Nodes start_a = Set::load_nodes(pass.start, batch.nodes_a + lane);
    const Nodes start_b = Set::load_nodes(pass.start, batch.nodes_b + lane);
    Nodes a = Set::load_nodes(pass.nodes, batch.nodes_a + lane);
    Nodes b = Set::load_nodes(pass.nodes, batch.nodes_b + lane);
    const Pack d[3] = {b.x - a.x, b.y - a.y, b.z - a.z};
    const Pack square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + Set::broadcast(kTinyVisitSquare);
    const Pack length = Set::root(square);
    const Pack closing = square - (d[0] * (start_b.x - start_a.x) + d[1] * (start_b.y - start_a.y) +
                                   d[2] * (start_b.z - start_a.z));  // times the length
    const Pack compliance = Set::load(batch.flexibilities + lane) * per_h * per_h;
    const Pack damping = Set::load(batch.damping_times + lane) * per_h;
    Pack stretch = length - Set::load(batch.rest_lengths + lane);
    if constexpr (!kOnly) stretch = stretch + compliance * Set::load(multipliers + lane);
    const Pack inverse_mass = a.inverse_mass + b.inverse_mass;
    const Pack pull = (stretch * length + damping * closing) /
                      (square * (inverse_mass + damping * inverse_mass + compliance));
    if constexpr (!kOnly) {
      Set::store(multipliers + lane, Set::load(multipliers + lane) - pull * length);
    }
    move(a.inverse_mass * pull, d, a);
    move(-(b.inverse_mass * pull), d, b);
    Set::store_nodes(pass.nodes, batch.nodes_a + lane, a);
    Set::store_nodes(pass.nodes, batch.nodes_b + lane, b);
  }

  template <bool kOnly>
  static void visit_all(const VisitPass& pass) {
    for (std::size_t k = 0; k < pass.batch_count; ++k) {
      double* const multipliers = kOnly ? nullptr : pass.multipliers + kVisitLanes * k;
      for (std::size_t lane = 0; lane < kVisitLanes; lane += Set::kWidth) {
        visit<kOnly>(pass, pass.batches[k], lane, multipliers);
      }
    }
  }

  static void run(const VisitPass& pass) {
    pass.multipliers == nullptr ? visit_all<true>(pass) : visit_all<false>(pass);
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
