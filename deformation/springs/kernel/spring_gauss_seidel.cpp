#include "deformation/springs/kernel/spring_gauss_seidel.h"

#include <algorithm>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

kernel::VisitSprings visits_by(InstructionSet set) {
#if defined(__x86_64__)
  if (set != InstructionSet::kPortable) return kernel::avx2_visits();
#endif
  return kernel::portable_visits();
}

std::uint32_t offset(std::size_t node) {
  return static_cast<std::uint32_t>(kernel::kVisitedDoubles * node);
}

Eigen::Map<Vec3> place(AlignedVector<double>& nodes, std::size_t node) {
  return Eigen::Map<Vec3>(&nodes[offset(node)]);
}

/// Springs still to visit, from the first node on.
std::vector<std::size_t> from_node_to_node(const Body& body, const SpringNetwork& network) {
  const auto& springs = network.springs;
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const bool moves =
        body.inverse_masses[springs[s].node_a] + body.inverse_masses[springs[s].node_b] > 0;
    if (moves && springs[s].stiffness > 0) order.push_back(s);
  }
  std::ranges::stable_sort(
      order, {}, [&](std::size_t s) { return std::min(springs[s].node_a, springs[s].node_b); });
  return order;
}

/// Takes springs out of an order such that four have no node in common.
class Chooser {
 public:
  Chooser(const Body& body, const SpringNetwork& network)
      : springs_(network.springs),
        order_(from_node_to_node(body, network)),
        last_batch_(body.node_count(), -2) {}

  bool is_done() const { return next_ == order_.size() && waiting_.empty(); }

  /// Up to four.
  std::vector<std::size_t> next_batch() {
    std::vector<std::size_t> batch;
    for (std::size_t lane = 0; lane < kernel::kVisitLanes; ++lane) {
      while (next_ < order_.size() && waiting_.size() < kPutOff) {
        waiting_.push_back(order_[next_++]);
      }
      auto chosen = find_untouched_since(batch_ - 1);
      if (chosen == waiting_.end()) chosen = find_untouched_since(batch_);
      if (chosen == waiting_.end()) break;
      const Spring& spring = springs_[*chosen];
      last_batch_[spring.node_a] = last_batch_[spring.node_b] = batch_;
      batch.push_back(*chosen);
      waiting_.erase(chosen);
    }
    ++batch_;
    return batch;
  }

 private:
  static constexpr std::size_t kPutOff = 256;

  std::vector<std::size_t>::iterator find_untouched_since(int batch) {
    return std::ranges::find_if(waiting_, [&](std::size_t s) {
      return std::max(last_batch_[springs_[s].node_a], last_batch_[springs_[s].node_b]) < batch;
    });
  }

  const std::vector<Spring>& springs_;
  std::vector<std::size_t> order_, waiting_;
  std::vector<int> last_batch_;  ///< that moved a node
  std::size_t next_ = 0;
  int batch_ = 0;
};

}  // namespace

SpringGaussSeidel::SpringGaussSeidel(const Body& body, const SpringNetwork& network,
                                     InstructionSet set)
    : visit_(visits_by(set)) {
  add_batches(body, network);
  const std::size_t nodes = body.node_count() + 1;  // and the one of lanes left over
  start_.assign(kernel::kVisitedDoubles * nodes, 0);
  nodes_ = start_;
  for (std::size_t i = 0; i < body.node_count(); ++i) {
    nodes_[offset(i) + 3] = body.inverse_masses[i];
  }
}

void SpringGaussSeidel::add_batches(const Body& body, const SpringNetwork& network) {
  Chooser chooser(body, network);
  while (!chooser.is_done()) {
    kernel::VisitBatch batch;
    std::ranges::fill(batch.nodes_a, offset(body.node_count()));
    std::ranges::fill(batch.nodes_b, offset(body.node_count()));
    std::ranges::fill(batch.flexibilities, 1.0);
    std::size_t lane = 0;
    for (const std::size_t s : chooser.next_batch()) {
      const Spring& spring = network.springs[s];
      batch.nodes_a[lane] = offset(spring.node_a);
      batch.nodes_b[lane] = offset(spring.node_b);
      batch.rest_lengths[lane] = spring.rest_length;
      batch.flexibilities[lane] = 1 / spring.stiffness;
      batch.damping_times[lane] = network.damping[s] / spring.stiffness;
      ++lane;
    }
    batches_.push_back(batch);
  }
}

void SpringGaussSeidel::relax(double h, int passes, const std::vector<Vec3>& start,
                              std::vector<Vec3>& velocities, std::vector<Vec3>& positions) {
  PALPATE_DEMAND(start.size() == velocities.size() && h > 0);
  for (std::size_t i = 0; i < start.size(); ++i) {
    place(start_, i) = start[i];
    place(nodes_, i) = start[i] + h * velocities[i];
  }
  if (passes > 1) multipliers_.assign(kernel::kVisitLanes * batches_.size(), 0);
  const kernel::VisitPass pass{.per_h = 1 / h,
                               .batches = batches_.data(),
                               .batch_count = batches_.size(),
                               .start = start_.data(),
                               .nodes = nodes_.data(),
                               .multipliers = passes > 1 ? multipliers_.data() : nullptr};
  for (int k = 0; k < passes; ++k) visit_(pass);
  positions.resize(start.size());
  for (std::size_t i = 0; i < start.size(); ++i) {
    positions[i] = place(nodes_, i);
    velocities[i] = pass.per_h * (positions[i] - start[i]);
  }
}

}  // namespace palpate::deformation
