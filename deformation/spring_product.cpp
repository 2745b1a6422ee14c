#include "deformation/spring_product.h"

#include <array>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

using kernel::kBlockNumbers;
using kernel::kLanes;

const kernel::ProductFunctions& functions_of(InstructionSet set) {
#if defined(__x86_64__)
  if (set != InstructionSet::kPortable) return kernel::avx2_product_functions();
#endif
  PALPATE_DEMAND(set == InstructionSet::kPortable);
  return kernel::portable_product_functions();
}

std::vector<float> to_float(const double* values, std::size_t count) {
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<float>(values[i]);
  return result;
}

/// xx, xy, xz, yy, yz, zz and what is added to all of the diagonal.
Mat3 symmetric(const std::array<double, kBlockNumbers>& n, double mass) {
  Mat3 block;
  block << n[0], n[1], n[2], n[1], n[3], n[4], n[2], n[4], n[5];
  block.diagonal().array() += n[6] + mass;
  return block;
}

const float* floats(const std::vector<Vec4f>& nodes) { return nodes.data()->data(); }

}  // namespace

SpringProduct::SpringProduct(const OrganModel& model, ChunkRunner* runner, InstructionSet set)
    : model_(model), runner_(runner), functions_(functions_of(set)), layout_(model) {
  const kernel::Layout layout = layout_.view();
  scalars_.surface_node_count = layout.surface_node_count;
  scalars_.virtual_node_count = layout.virtual_node_count;
  scalars_.slice_count = layout.slice_count;
  scalars_.slices_per_chunk = layout.slices_per_chunk;
  scalars_.chunk_count = layout.chunk_count;
  scalars_.slices = layout.slices;
  scalars_.structural_stiffness = static_cast<float>(layout.structural_stiffness);
  scalars_.bending_stiffness = static_cast<float>(layout.bending_stiffness);
  scalars_.structural_damping =
      static_cast<float>(layout.structural_damping_time * layout.structural_stiffness);
  scalars_.bending_damping =
      static_cast<float>(layout.bending_damping_time * layout.bending_stiffness);
  add_rows(layout);
  positions_.assign(model.node_count(), Vec4f::Zero());
  diagonal_.assign(model.node_count(), Mat3::Zero());
  const std::size_t virtual_parts = layout.virtual_node_count * layout.chunk_count * kLanes;
  blocks_.resize(kBlockNumbers * kLanes * layout.slice_count);
  virtual_blocks_.resize(kBlockNumbers * virtual_parts);
  virtual_sums_.resize(3 * virtual_parts);
}

void SpringProduct::add_rows(const kernel::Layout& layout) {
  const std::size_t rows = layout.slice_count * kLanes;
  const kernel::Slice& last = layout.slices[layout.slice_count - 1];
  const std::size_t half_springs = (last.first_slot + last.slots) * kLanes;
  for (std::size_t i = 0; i < half_springs; ++i) neighbours_.push_back(layout.neighbours[i] / 3);
  for (std::size_t i = 0; i < rows; ++i) row_nodes_.push_back(layout.row_nodes[i] / 3);
  rest_lengths_ = to_float(layout.rest_lengths, half_springs);
  ring_sizes_ = to_float(layout.ring_sizes, rows);
  along_.resize(half_springs);
  across_.resize(half_springs);
  masses_.resize(rows + layout.virtual_node_count);
  if (layout.virtual_node_count == 0) return;
  const auto first_virtual = static_cast<std::uint32_t>(layout.surface_node_count);
  for (std::size_t i = 0; i < last.first_link + last.link_count; ++i) {
    links_.push_back({layout.links[i].virtual_node, {}});
    std::copy_n(layout.links[i].weights, kLanes, links_.back().weights);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    inner_nodes_.push_back(first_virtual + layout.inner_nodes[i] / 3);
  }
  inner_rest_lengths_ = to_float(layout.inner_rest_lengths, rows);
  inner_stiffnesses_ = to_float(layout.inner_stiffnesses, rows);
  inner_dampings_ = to_float(layout.inner_dampings, rows);
  inner_along_.resize(rows);
  inner_across_.resize(rows);
}

kernel::ProductLayout SpringProduct::view() const {
  kernel::ProductLayout layout = scalars_;
  layout.links = links_.data();
  layout.neighbours = neighbours_.data();
  layout.rest_lengths = rest_lengths_.data();
  layout.row_nodes = row_nodes_.data();
  layout.ring_sizes = ring_sizes_.data();
  layout.inner_nodes = inner_nodes_.data();
  layout.inner_rest_lengths = inner_rest_lengths_.data();
  layout.inner_stiffnesses = inner_stiffnesses_.data();
  layout.inner_dampings = inner_dampings_.data();
  return layout;
}

kernel::Couplings SpringProduct::couplings() {
  return {h_,
          floats(positions_),
          along_.data(),
          across_.data(),
          inner_along_.data(),
          inner_across_.data()};
}

void SpringProduct::run(ChunkBody body) {
  SerialRunner serial;
  (runner_ == nullptr ? serial : *runner_).run(scalars_.chunk_count, body);
}

void SpringProduct::linearise(const std::vector<Vec3>& positions, double h) {
  PALPATE_DEMAND(positions.size() == model_.node_count());
  h_ = static_cast<float>(h);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions_[i] = wide(positions[i] - positions[0]);
  }
  const kernel::ProductLayout layout = view();
  const kernel::Couplings out = couplings();
  const std::size_t stride = kBlockNumbers * kLanes * layout.virtual_node_count;
  run([&](std::size_t chunk) {
    functions_.linearise(layout, out, chunk, blocks_.data(),
                         virtual_blocks_.data() + stride * chunk);
  });
  take_diagonal(h);
}

void SpringProduct::take_diagonal(double h) {
  const std::size_t surface_count = scalars_.surface_node_count;
  const std::size_t rows = scalars_.slice_count * kLanes;
  const double mass_factor = 1 + h * model_.drag;
  std::array<double, kBlockNumbers> numbers;
  for (std::size_t i = 0; i < surface_count; ++i) {
    const float* const block = &blocks_[kBlockNumbers * kLanes * (i / kLanes) + i % kLanes];
    for (std::size_t n = 0; n < kBlockNumbers; ++n) numbers[n] = block[n * kLanes];
    masses_[i] = static_cast<float>(mass_factor * model_.masses[i]);
    diagonal_[i] = symmetric(numbers, mass_factor * model_.masses[i]);
  }
  for (std::size_t k = 0; k < scalars_.virtual_node_count; ++k) {
    numbers.fill(0);
    for (std::size_t chunk = 0; chunk < scalars_.chunk_count; ++chunk) {
      const std::size_t part = chunk * scalars_.virtual_node_count + k;
      const float* number = &virtual_blocks_[kBlockNumbers * kLanes * part];
      for (std::size_t n = 0; n < kBlockNumbers; ++n) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) numbers[n] += *number++;
      }
    }
    const double mass = mass_factor * model_.masses[surface_count + k];
    masses_[rows + k] = static_cast<float>(mass);
    diagonal_[surface_count + k] = symmetric(numbers, mass);
  }
}

void SpringProduct::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) {
  const kernel::ProductLayout layout = view();
  const kernel::Couplings in = couplings();
  const std::size_t stride = 3 * kLanes * layout.virtual_node_count;
  run([&](std::size_t chunk) {
    functions_.apply(layout, in, chunk, masses_.data(), floats(p), out.data()->data(),
                     virtual_sums_.data() + stride * chunk);
  });
  for (std::size_t k = 0; k < layout.virtual_node_count; ++k) {
    const std::size_t node = layout.surface_node_count + k;
    std::array<float, 3 * kLanes> lanes{};
    for (std::size_t chunk = 0; chunk < layout.chunk_count; ++chunk) {
      const float* const part = &virtual_sums_[stride * chunk + 3 * kLanes * k];
      for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i] += part[i];
    }
    Vec4f sum = masses_[layout.slice_count * kLanes + k] * p[node];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sum += Vec4f(lanes[lane], lanes[kLanes + lane], lanes[2 * kLanes + lane], 0);
    }
    out[node] = sum;
  }
}

}  // namespace palpate::deformation
