#include "deformation/springs/spring_hessian_product.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "modules/core/error.h"
#include "modules/core/ranges.h"

namespace palpate::deformation {
namespace {

using kernel::kBlockNumbers;
using kernel::kLanes;

const kernel::ProductFunctions& product_functions_of(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return kernel::avx512_product_functions();
  if (set == InstructionSet::kAvx2) return kernel::avx2_product_functions();
#endif
  PALPATE_DEMAND(set == InstructionSet::kPortable);
  return kernel::portable_product_functions();
}

/// xx, xy, xz, yy, yz, zz and what is added to all of the diagonal.
Mat3 symmetric(const std::array<double, kBlockNumbers>& n, double mass) {
  Mat3 block;
  block << n[0], n[1], n[2], n[1], n[3], n[4], n[2], n[4], n[5];
  block.diagonal().array() += n[6] + mass;
  return block;
}

}  // namespace

SpringHessianProduct::SpringHessianProduct(const Body& body, const SpringNetwork& network,
                                           bool with_volume, ChunkRunner* runner,
                                           InstructionSet set)
    : body_(body),
      runner_(runner),
      functions_(product_functions_of(set)),
      layout_(body, network, with_volume) {
  const kernel::Layout layout = layout_.view();
  const std::size_t rows = layout.slice_count * kLanes;
  const kernel::Slice& last = layout.slices[layout.slice_count - 1];
  pairs_.resize((last.first_slot + last.slots) * kLanes);
  masses_.resize(rows + layout.virtual_node_count);
  inner_along_.resize(rows);
  inner_across_.resize(rows);
  nodes_.resize(body.node_count());
  dots_.resize(layout.chunk_count * kLanes);
  diagonal_.assign(body.node_count(), Mat3::Zero());
  all_slices_.resize(layout.slice_count);
  std::iota(all_slices_.begin(), all_slices_.end(), 0u);
  const std::size_t virtual_parts = layout.virtual_node_count * layout.chunk_count * kLanes;
  blocks_.resize(kBlockNumbers * rows);
  virtual_blocks_.resize(kBlockNumbers * virtual_parts);
  virtual_sums_.resize(3 * virtual_parts);
}

kernel::Couplings SpringHessianProduct::couplings() {
  return {h_,
          damping_,
          nodes_.data()->position.data(),
          pairs_.data(),
          inner_along_.data(),
          inner_across_.data()};
}

void SpringHessianProduct::run(std::size_t count, ChunkBody body) {
  SerialRunner serial;
  (runner_ == nullptr ? serial : *runner_).run(count, body);
}

std::size_t SpringHessianProduct::part_count(std::span<const std::uint32_t> slices) const {
  return std::min(layout_.view().chunk_count, (slices.size() + kSlicesInPart - 1) / kSlicesInPart);
}

kernel::SliceList SpringHessianProduct::part_of(std::span<const std::uint32_t> slices,
                                                std::size_t part) const {
  const std::size_t parts = part_count(slices), first = part * slices.size() / parts;
  return {slices.data() + first, (part + 1) * slices.size() / parts - first};
}

kernel::SliceList SpringHessianProduct::slices_of(std::size_t chunk) const {
  const std::size_t most = layout_.view().slices_per_chunk, first = chunk * most;
  return {&all_slices_[first], std::min(most, all_slices_.size() - first)};
}

void SpringHessianProduct::find_slices(std::span<const std::uint32_t> nodes,
                                       std::vector<std::uint32_t>& slices) const {
  slices.clear();
  for (const std::uint32_t node : nodes) {
    slices.push_back(node / static_cast<std::uint32_t>(kLanes));
  }
  std::ranges::sort(slices);
  slices.erase(std::unique(slices.begin(), slices.end()), slices.end());
}

void SpringHessianProduct::take_positions(const std::vector<Vec3>& positions) {
  PALPATE_DEMAND(positions.size() == body_.node_count());
  Ranges(runner_).each(positions.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      nodes_[i].position = wide(positions[i] - positions[0]);
    }
  });
}

// With h = √k and c times d/h, h (c + h k) is d c + k k.
void SpringHessianProduct::linearise(const std::vector<Vec3>& positions, const SpringShares& shares,
                                     std::span<const std::uint32_t> slices) {
  const double h = std::sqrt(shares.stiffness);
  h_ = static_cast<float>(h);
  damping_ = static_cast<float>(shares.damping / h);
  take_positions(positions);
  contacts_.clear();
  const kernel::Layout layout = layout_.view();
  const kernel::Couplings out = couplings();
  const std::size_t stride = kBlockNumbers * kLanes * layout.virtual_node_count;
  run(part_count(slices), [&](std::size_t part) {
    functions_.linearise(layout, out, part_of(slices, part), blocks_.data(),
                         virtual_blocks_.data() + stride * part);
    take_row_diagonals(part_of(slices, part), shares.mass);
  });
}

void SpringHessianProduct::linearise(const std::vector<Vec3>& positions, double h) {
  h_ = static_cast<float>(h);
  damping_ = 1;
  take_positions(positions);
  contacts_.clear();
  const kernel::Layout layout = layout_.view();
  const kernel::Couplings out = couplings();
  const std::size_t stride = kBlockNumbers * kLanes * layout.virtual_node_count;
  run(layout.chunk_count, [&](std::size_t chunk) {
    functions_.linearise(layout, out, slices_of(chunk), blocks_.data(),
                         virtual_blocks_.data() + stride * chunk);
    take_row_diagonals(slices_of(chunk), 1 + h * body_.drag);
  });
  take_virtual_diagonal(h);
}

void SpringHessianProduct::take_row_diagonal(std::size_t node, double mass_share) {
  std::array<double, kBlockNumbers> numbers;
  const float* const block = &blocks_[kBlockNumbers * kLanes * (node / kLanes) + node % kLanes];
  for (std::size_t n = 0; n < kBlockNumbers; ++n) numbers[n] = block[n * kLanes];
  masses_[node] = static_cast<float>(mass_share * body_.masses[node]);
  diagonal_[node] = symmetric(numbers, mass_share * body_.masses[node]);
}

void SpringHessianProduct::take_row_diagonals(const kernel::SliceList& list, double mass_share) {
  for (std::size_t k = 0; k < list.count; ++k) {
    const std::size_t first = list.slices[k] * kLanes, end = first + kLanes;
    for (std::size_t i = first; i < std::min(end, body_.surface_node_count); ++i) {
      take_row_diagonal(i, mass_share);
    }
  }
}

void SpringHessianProduct::take_virtual_diagonal(double h) {
  const kernel::Layout layout = layout_.view();
  const std::size_t surface_count = layout.surface_node_count;
  const std::size_t rows = layout.slice_count * kLanes;
  const double mass_factor = 1 + h * body_.drag;
  std::array<double, kBlockNumbers> numbers;
  for (std::size_t k = 0; k < layout.virtual_node_count; ++k) {
    numbers.fill(0);
    for (std::size_t chunk = 0; chunk < layout.chunk_count; ++chunk) {
      const std::size_t part = chunk * layout.virtual_node_count + k;
      const float* number = &virtual_blocks_[kBlockNumbers * kLanes * part];
      for (std::size_t n = 0; n < kBlockNumbers; ++n) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) numbers[n] += *number++;
      }
    }
    const double mass = mass_factor * body_.masses[surface_count + k];
    masses_[rows + k] = static_cast<float>(mass);
    diagonal_[surface_count + k] = symmetric(numbers, mass);
  }
}

double SpringHessianProduct::apply(std::vector<Vec4f>& out) {
  const kernel::Layout layout = layout_.view();
  const kernel::Couplings in = couplings();
  const std::size_t stride = 3 * kLanes * layout.virtual_node_count;
  run(layout.chunk_count, [&](std::size_t chunk) {
    functions_.apply(layout, in, slices_of(chunk), masses_.data(), out.data()->data(),
                     virtual_sums_.data() + stride * chunk, dots_.data() + kLanes * chunk);
  });
  double dot = 0;
  for (const float part : dots_) dot += static_cast<double>(part);
  for (std::size_t k = 0; k < layout.virtual_node_count; ++k) {
    const std::size_t node = layout.surface_node_count + k;
    std::array<float, 3 * kLanes> lanes{};
    for (std::size_t chunk = 0; chunk < layout.chunk_count; ++chunk) {
      const float* const part = &virtual_sums_[stride * chunk + 3 * kLanes * k];
      for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i] += part[i];
    }
    const Vec4f& p = nodes_[node].vector;
    Vec4f sum = masses_[layout.slice_count * kLanes + k] * p;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sum += Vec4f(lanes[lane], lanes[kLanes + lane], lanes[2 * kLanes + lane], 0);
    }
    out[node] = sum;
    dot += static_cast<double>(p.dot(sum));
  }
  return dot + add_couplings(contacts_, nodes_, out);
}

double SpringHessianProduct::apply(std::span<const std::uint32_t> slices, std::vector<Vec4f>& out) {
  const kernel::Layout layout = layout_.view();
  const kernel::Couplings in = couplings();
  const std::size_t stride = 3 * kLanes * layout.virtual_node_count, parts = part_count(slices);
  run(parts, [&](std::size_t part) {
    functions_.apply(layout, in, part_of(slices, part), masses_.data(), out.data()->data(),
                     virtual_sums_.data() + stride * part, dots_.data() + kLanes * part);
  });
  const auto dots = std::span(dots_).first(kLanes * parts);
  return std::accumulate(dots.begin(), dots.end(), 0.0) + add_couplings(contacts_, nodes_, out);
}

void SpringHessianProduct::couple(std::span<const ContactCoupling> couplings) {
  contacts_.assign(couplings.begin(), couplings.end());
}

SpringMatrix SpringHessianProduct::matrix() {
  return {functions_, layout_.view(), couplings(), masses_.data(), contacts_};
}

double add_couplings(std::span<const ContactCoupling> couplings,
                     const AlignedVector<WideNode>& nodes, std::vector<Vec4f>& out) {
  double dot = 0;
  for (const ContactCoupling& contact : couplings) {
    float speed = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      speed += contact.arms[k].dot(nodes[contact.nodes[k]].vector);
    }
    for (std::size_t k = 0; k < 3; ++k) out[contact.nodes[k]] += speed * contact.arms[k];
    dot += static_cast<double>(speed * speed);
  }
  return dot;
}

}  // namespace palpate::deformation
