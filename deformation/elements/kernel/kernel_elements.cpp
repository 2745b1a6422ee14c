#include "deformation/elements/kernel/kernel_elements.h"

#include <algorithm>
#include <numeric>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

using kernel::block_place;
using kernel::ElementPart;
using kernel::kGroupPairs;
using kernel::kTetrahedronLanes;

constexpr std::size_t kRowFloats = 12;  ///< of a node's block

const kernel::ElementFunctions& element_functions_of(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return kernel::avx512_element_functions();
  if (set == InstructionSet::kAvx2) return kernel::avx2_element_functions();
#endif
  PALPATE_DEMAND(set == InstructionSet::kPortable);
  return kernel::portable_element_functions();
}

using Quad = Eigen::Map<Eigen::Vector4f>;
Quad quad(float* at) { return Quad(at); }

/// to += from, a pair's three rows.
void add_block_rows(const float* from, float* to) {
  for (std::size_t row = 0; row < 3; ++row) {
    quad(to + kTetrahedronLanes * row) +=
        Eigen::Map<const Eigen::Vector4f>(from + kTetrahedronLanes * row);
  }
}

}  // namespace

KernelElements::KernelElements(LinearTetrahedra tetrahedra, bool with_volumes, ChunkRunner* runner,
                               InstructionSet set)
    : mesh_(std::move(tetrahedra)),
      with_volumes_(with_volumes),
      runner_(runner),
      functions_(element_functions_of(set)),
      parts_(mesh_) {
  const std::size_t slots = parts_.slot_count(), groups = parts_.group_count();
  positions_.assign(4 * slots, 0);
  part_forces_.assign(4 * slots, 0);
  blocks_.assign(kernel::kBlockFloats * groups, 0);
  own_diagonals_.assign(kRowFloats * slots, 0);
  part_diagonals_.assign(kRowFloats * slots, 0);
  p_.assign(4 * slots, 0);
  product_.assign(4 * slots, 0);
  if (with_volumes) {
    node_volumes_.assign(slots, 0);
    volumes_.assign(parts_.batch_count() * kTetrahedronLanes, 0);
    volume_gradients_.assign(kTetrahedronLanes * groups, 0);
    whole_diagonals_.assign(kRowFloats * slots, 0);
    open_.assign(4 * parts_.open_count(), 0);
    rates_.assign(slots, 0);
    weighted_rates_.assign(4 * slots, 0);
    slot_weights_.assign(slots, 0);
  }
  arrays_.positions = positions_.data();
  arrays_.forces = part_forces_.data();
  arrays_.node_volumes = node_volumes_.data();
  arrays_.volumes = volumes_.data();
  arrays_.blocks = blocks_.data();
  arrays_.volume_gradients = volume_gradients_.data();
  arrays_.own_diagonals = own_diagonals_.data();
  arrays_.diagonals = part_diagonals_.data();
  arrays_.whole_diagonals = whole_diagonals_.data();
  arrays_.open = open_.data();
  arrays_.weights = slot_weights_.data();
  arrays_.p = p_.data();
  arrays_.product = product_.data();
  arrays_.rates = rates_.data();
  arrays_.weighted_rates = weighted_rates_.data();
  part_sums_.assign(parts_.parts().size(), 0);
  forces_.assign(mesh_.node_count, Vec3::Zero());
  diagonal_.assign(mesh_.node_count, Mat3::Zero());
}

void KernelElements::run(ChunkBody body) {
  SerialRunner serial;
  (runner_ == nullptr ? serial : *runner_).run(parts_.parts().size(), body);
}

void KernelElements::load_positions(const ElementPart& part, const std::vector<Vec3>& positions) {
  for (std::size_t slot = part.first_slot; slot < part.first_slot + part.slot_count; ++slot) {
    Eigen::Map<Vec3>(positions_.data() + 4 * slot) = positions[parts_.node(slot)];
  }
}

double KernelElements::total_of_parts() const {
  return std::accumulate(part_sums_.begin(), part_sums_.end(), 0.0);
}

double KernelElements::sum_of(const double* numbers, std::size_t node) const {
  double sum = 0;
  for (const std::uint32_t slot : parts_.slots(node)) sum += numbers[slot];
  return sum;
}

void KernelElements::finish(std::span<const double> shift) {
  for_parts([&](const ElementPart& part) { merge(part, shift); });
  if (with_volumes_) {
    for_parts([&](const ElementPart& part) { functions_.finish_volumes(part, arrays_); });
  }
  for_parts([&](const ElementPart& part) { collect(part); });
}

void KernelElements::merge(const ElementPart& part, std::span<const double> shift) {
  for (std::size_t k = 0; k < part.pair_merge_count; ++k) {
    const auto [to, from] = part.pair_merges[k];
    add_block_rows(&blocks_[block_place(from)], &blocks_[block_place(to)]);
    if (with_volumes_) quad(&volume_gradients_[4 * to]) += quad(&volume_gradients_[4 * from]);
  }
  for (std::size_t k = 0; k < part.owned_count; ++k) {
    const std::uint32_t slot = part.owned[k];
    float* const rows = &part_diagonals_[kRowFloats * slot];
    std::copy_n(&own_diagonals_[kRowFloats * slot], kRowFloats, rows);
    for (std::size_t row = 0; row < 3; ++row) {
      rows[5 * row] += static_cast<float>(shift[parts_.node(slot)]);
    }
  }
  for (std::size_t k = 0; k < part.node_merge_count; ++k) {
    const auto [to, from] = part.node_merges[k];
    for (std::size_t n = 0; n < kRowFloats; ++n) {
      part_diagonals_[kRowFloats * to + n] += own_diagonals_[kRowFloats * from + n];
    }
  }
  for (std::size_t k = 0; k < part.owned_count; ++k) {
    float* const rows = &part_diagonals_[kRowFloats * part.owned[k]];
    rows[4] = rows[1];  // symmetric to the last bit
    rows[8] = rows[2];
    rows[9] = rows[6];
  }
}

/// ∂v_j/∂x_i
Vec4f KernelElements::column_gradient(std::size_t pair) const {
  const float* const block = &blocks_[block_place(pair)];
  return {block[3], block[3 + kTetrahedronLanes], block[3 + 2 * kTetrahedronLanes], 0};
}

/// Forces and diagonal of the nodes this part owns.
void KernelElements::collect(const ElementPart& part) {
  const float* const diagonals = with_volumes_ ? whole_diagonals_.data() : part_diagonals_.data();
  for (std::size_t k = 0; k < part.owned_count; ++k) {
    const std::size_t node = parts_.node(part.owned[k]);
    Vec3 force = Vec3::Zero();
    Eigen::Matrix<float, 4, 3> rows = Eigen::Matrix<float, 4, 3>::Zero();
    for (const std::uint32_t slot : parts_.slots(node)) {
      force += Eigen::Map<const Vec3>(&part_forces_[4 * slot]);
      rows += Eigen::Map<const Eigen::Matrix<float, 4, 3>>(diagonals + kRowFloats * slot);
    }
    forces_[node] = force;
    const Mat3 block = rows.topRows<3>().cast<double>();
    diagonal_[node] = 0.5 * (block + block.transpose());
  }
}

void KernelElements::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) {
  arrays_.vectors = p.data()->data();
  arrays_.products = out.data()->data();
  const auto multiply = with_volumes_ ? functions_.multiply : functions_.multiply_blocks;
  for_parts([&](const ElementPart& part) { multiply(part, arrays_); });
  if (with_volumes_) {
    for_parts([&](const ElementPart& part) { functions_.push(part, arrays_); });
  }
  for_parts([&](const ElementPart& part) { functions_.collect(part, arrays_); });
}

void KernelElements::add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const {
  for (const std::uint32_t node : patch.nodes) {
    const int a = patch.place(node);
    const float* const rows = &part_diagonals_[kRowFloats * parts_.slots(node)[0]];
    for (int k = 0; k < 3; ++k) {
      sum.block<1, 3>(3 * a + k, 3 * a) +=
          share * Eigen::Map<const Eigen::RowVector3f>(rows + 4 * k);
    }
  }
  std::vector<int> places(parts_.slot_count(), -1);  // of the slots
  for (const std::uint32_t node : patch.nodes) {
    for (const std::uint32_t slot : parts_.slots(node)) places[slot] = patch.place(node);
  }
  std::vector<Touching> touching;  // pairs of which one node at least is of the patch
  for_pairs([&](std::uint32_t row, std::uint32_t column, std::uint32_t pair) {
    const int a = places[row], b = places[column];
    if (a < 0 && b < 0) return;
    touching.push_back({parts_.node(row), parts_.node(column), pair, a, b});
    if (a >= 0 && b >= 0) add_pair(pair, share, a, b, sum);
  });
  if (with_volumes_) add_volume_block(patch, touching, share, sum);
}

void KernelElements::add_pair(std::size_t pair, float share, int a, int b,
                              Eigen::MatrixXf& sum) const {
  const float* const rows = &blocks_[block_place(pair)];
  for (int k = 0; k < 3; ++k) {
    const Eigen::RowVector3f values =
        share * Eigen::Map<const Eigen::RowVector3f>(rows + kTetrahedronLanes * k);
    if (b < a) {
      sum.block<1, 3>(3 * a + k, 3 * b) += values;
    } else {
      sum.block<3, 1>(3 * b, 3 * a + k) += values.transpose();
    }
  }
}

/// Row by row of the volumes' matrix: a node and those of its neighbours that are of the patch.
void KernelElements::add_volume_block(const Patch& patch, std::span<const Touching> touching,
                                      float share, Eigen::MatrixXf& sum) const {
  constexpr std::uint32_t kNone = ~0u;
  struct Entry {
    int place;
    std::uint32_t next;  ///< of the same row
    Eigen::Vector3f gradient;
  };
  std::vector<Entry> entries;
  std::vector<std::uint32_t> heads(mesh_.node_count, kNone);  // of the rows
  const auto note = [&](std::uint32_t node, int place, const Vec4f& gradient) {
    if (place < 0) return;
    entries.push_back({place, heads[node], gradient.head<3>()});
    heads[node] = static_cast<std::uint32_t>(entries.size() - 1);
  };
  for (const std::uint32_t node : patch.nodes) {
    const float* const own = &part_diagonals_[kRowFloats * parts_.slots(node)[0]];
    note(node, patch.place(node), Vec4f(own[3], own[7], own[11], 0));
  }
  for (const Touching& t : touching) {
    note(t.row, t.column_place, Eigen::Map<const Vec4f>(&volume_gradients_[4 * t.pair]));
    note(t.column, t.row_place, column_gradient(t.pair));
  }
  for (std::uint32_t node = 0; node < mesh_.node_count; ++node) {
    if (heads[node] == kNone) continue;
    const float weight = share * slot_weights_[parts_.slots(node)[0]];
    for (std::uint32_t a = heads[node]; a != kNone; a = entries[a].next) {
      const Eigen::Vector3f row = weight * entries[a].gradient;
      for (std::uint32_t b = heads[node]; b != kNone; b = entries[b].next) {
        if (entries[b].place > entries[a].place) continue;
        sum.block<3, 3>(3 * entries[a].place, 3 * entries[b].place) +=
            row * entries[b].gradient.transpose();
      }
    }
  }
}

}  // namespace palpate::deformation
