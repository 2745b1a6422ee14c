// Springs visited one after another, each moved to where its compliant constraint wants it
// (xpbd_springs.h), fast.
//
// A visit waits for those before it that moved a node of its own: root and division take longer
// than all else, and done one by one, most of the time is waiting. So springs are put in an order
// in which four at a time share no node, nor do they with the four before where that can be; four
// are done side by side. The order is from node to node, so that memory is passed through once. All
// instruction sets give the same bits.
#pragma once

#include <vector>

#include "deformation/model/body.h"
#include "deformation/model/spring_network.h"
#include "deformation/springs/kernel/spring_gauss_seidel_arrays.h"
#include "deformation/springs/kernel/spring_kernel.h"

namespace palpate::deformation {

class SpringGaussSeidel {
 public:
  /// Springs of no stiffness and those between fixed nodes are left out.
  SpringGaussSeidel(const Body& body, const SpringNetwork& network,
                    InstructionSet set = available_instruction_sets().back());

  /// Passes over all springs.
  /// @param h           of the step [s]
  /// @param start       where the step began  (node_count) [m]
  /// @param velocities  in: those it began with; out: what takes `start` to `positions` [m/s]
  /// @param positions   out: at its end [m]
  void relax(double h, int passes, const std::vector<Vec3>& start, std::vector<Vec3>& velocities,
             std::vector<Vec3>& positions);

  /// In the order of visits, for tests.
  const std::vector<kernel::VisitBatch>& batches() const { return batches_; }

 private:
  void add_batches(const Body& body, const SpringNetwork& network);

  kernel::VisitSprings visit_;
  std::vector<kernel::VisitBatch> batches_;
  std::vector<double> multipliers_;
  AlignedVector<double> start_, nodes_;
};

}  // namespace palpate::deformation
