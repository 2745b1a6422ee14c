#include "deformation/springs/kernel/spring_kernel.h"

#include <algorithm>
#include <array>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

const kernel::Functions& spring_functions_of(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return kernel::avx512_functions();
  if (set == InstructionSet::kAvx2) return kernel::avx2_functions();
#endif
  PALPATE_DEMAND(set == InstructionSet::kPortable);
  return kernel::portable_functions();
}

void repeat(const Vec3& from, double (&to)[3 * kernel::kDoubleLanes]) {
  for (std::size_t i = 0; i < 3 * kernel::kDoubleLanes; ++i) to[i] = from[static_cast<int>(i % 3)];
}

const double* coordinates(const std::vector<Vec3>& nodes) {
  return reinterpret_cast<const double*>(nodes.data());
}

double* coordinates(std::vector<Vec3>& nodes) { return reinterpret_cast<double*>(nodes.data()); }

/// Numbers in which a chunk's force on a virtual node comes: x of all lanes, then y, then z.
constexpr std::size_t kForces = 3 * kernel::kLanes;

/// Floats are taken from a point amid the organ: the mean of some nodes spread over it.
Vec3 packing_origin(const Body& body, const std::vector<Vec3>& positions) {
  constexpr std::size_t kSamples = 16;
  const std::size_t stride = body.surface_node_count / kSamples + 1;
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (std::size_t i = 0; i < body.surface_node_count; i += stride, ++count) {
    sum += positions[i];
  }
  return sum / count;
}

static_assert(sizeof(Vec3) == 3 * sizeof(double));

}  // namespace

SpringKernel::SpringKernel(const Body& body, const SpringNetwork& network, bool with_volume,
                           ChunkRunner* runner, InstructionSet set)
    : body_(body),
      with_volume_(with_volume),
      runner_(runner),
      functions_(spring_functions_of(set)),
      layout_(body, network, with_volume) {
  const kernel::Layout layout = layout_.view();
  virtual_forces_.resize(kForces * layout.virtual_node_count * layout.chunk_count);
  sums_.resize(layout.chunk_count);
  nodes_.resize(kernel::kNodeFloats * body.node_count());
}

void SpringKernel::run(std::size_t count, ChunkBody body) {
  SerialRunner serial;
  (runner_ == nullptr ? serial : *runner_).run(count, body);
}

void SpringKernel::pack(const std::vector<Vec3>& positions, const std::vector<Vec3>* velocities) {
  const std::size_t count = body_.node_count();
  PALPATE_DEMAND(positions.size() == count);
  kernel::Packing packing;
  packing.positions = coordinates(positions);
  packing.velocities = velocities == nullptr ? nullptr : coordinates(*velocities);
  Eigen::Map<Vec3>(packing.origin) = packing_origin(body_, positions);
  packing.nodes = nodes_.data();
  const std::size_t chunks = sums_.size(), share = (count + chunks - 1) / chunks;
  run(chunks, [&](std::size_t chunk) {
    functions_.pack(packing, std::min(chunk * share, count), std::min((chunk + 1) * share, count));
  });
}

/// The kernel reads nodes four doubles at a time. Virtual nodes follow the surface nodes in memory;
/// without any, a copy has one more node behind it.
const double* SpringKernel::readable_beyond(const std::vector<Vec3>& positions) {
  if (positions.size() > body_.surface_node_count) return coordinates(positions);
  padded_positions_ = positions;
  padded_positions_.push_back(Vec3::Zero());
  return coordinates(padded_positions_);
}

kernel::Step SpringKernel::make_step(double h, const std::vector<Vec3>& positions,
                                     const std::vector<Vec3>& velocities, FreeStep& out) {
  out.velocities.resize(body_.node_count());
  if (out.volume.gradient.size() != body_.surface_node_count) {
    out.volume.gradient.assign(body_.surface_node_count, Vec3::Zero());
  }
  kernel::Step step;
  step.h = h;
  step.drag = body_.drag;
  repeat(body_.gravity, step.gravity);
  repeat(positions[0], step.origin);
  step.positions = readable_beyond(positions);
  step.velocities = coordinates(velocities);
  step.nodes = nodes_.data();
  step.new_velocities = coordinates(out.velocities);
  step.gradient = coordinates(out.volume.gradient);
  step.virtual_forces = virtual_forces_.data();
  step.sums = sums_.data();
  return step;
}

void SpringKernel::free_step(double h, const OrganState& state, FreeStep& out) {
  const kernel::Layout layout = layout_.view();
  pack(state.positions, &state.velocities);
  const kernel::Step step = make_step(h, state.positions, state.velocities, out);
  const auto step_chunk =
      with_volume_ ? functions_.step_chunk : functions_.step_chunk_without_volume;
  run(layout.chunk_count, [&](std::size_t chunk) { step_chunk(layout, step, chunk); });
  sum_chunks(out);
  finish_virtual_nodes(h, state, out);
}

void SpringKernel::evaluate_volume(const std::vector<Vec3>& positions, FreeStep& out) {
  PALPATE_DEMAND(positions.size() == body_.node_count() &&
                 out.velocities.size() == positions.size());
  const kernel::Step step = make_step(0, positions, out.velocities, out);
  if (!with_volume_) return;
  const kernel::Layout layout = layout_.view();
  run(layout.chunk_count, [&](std::size_t chunk) { functions_.volume_chunk(layout, step, chunk); });
  sum_chunks(out);
}

void SpringKernel::sum_chunks(FreeStep& out) const {
  kernel::ChunkSums total;
  for (const kernel::ChunkSums& part : sums_) {
    total.volume += part.volume;
    total.denominator += part.denominator;
    total.volume_velocity += part.volume_velocity;
  }
  out.volume.volume = total.volume;
  out.volume.denominator = total.denominator;
  out.volume_velocity = total.volume_velocity;
}

void SpringKernel::finish_virtual_nodes(double h, const OrganState& state, FreeStep& out) const {
  const std::size_t surface_count = body_.surface_node_count;
  const std::size_t virtual_count = body_.node_count() - surface_count;
  for (std::size_t k = 0; k < virtual_count; ++k) {
    std::array<double, kForces> lanes{};
    for (std::size_t chunk = 0; chunk < sums_.size(); ++chunk) {
      const float* const part = &virtual_forces_[kForces * (chunk * virtual_count + k)];
      for (std::size_t i = 0; i < kForces; ++i) lanes[i] += static_cast<double>(part[i]);
    }
    Vec3 force = Vec3::Zero();
    for (std::size_t lane = 0; lane < kernel::kLanes; ++lane) {
      force += Vec3(lanes[lane], lanes[kernel::kLanes + lane], lanes[2 * kernel::kLanes + lane]);
    }
    const std::size_t node = surface_count + k;
    const Vec3& v = state.velocities[node];
    out.velocities[node] =
        v + h * (body_.inverse_masses[node] * force + body_.gravity - body_.drag * v);
  }
}

void SpringKernel::finish_step(double h, double volume_impulse, FreeStep& step, OrganState& state) {
  state.velocities.swap(step.velocities);
  const kernel::Layout layout = layout_.view();
  kernel::Move move;
  move.h = h;
  move.volume_impulse = volume_impulse;
  move.inverse_masses = layout.inverse_masses;
  move.gradient = coordinates(step.volume.gradient);
  move.velocities = coordinates(state.velocities);
  move.positions = coordinates(state.positions);
  const std::size_t count = 3 * layout.surface_node_count;
  const std::size_t stride = 3 * kernel::kLanes * layout.slices_per_chunk;
  run(layout.chunk_count, [&](std::size_t chunk) {
    functions_.move(move, chunk * stride, std::min((chunk + 1) * stride, count));
  });
  for (std::size_t i = layout.surface_node_count; i < body_.node_count(); ++i) {
    state.positions[i] += h * state.velocities[i];
  }
}

double SpringKernel::elastic_energy(const std::vector<Vec3>& positions) {
  const kernel::Layout layout = layout_.view();
  pack(positions, nullptr);
  kernel::Step step;
  step.nodes = nodes_.data();
  run(layout.chunk_count, [&](std::size_t chunk) {
    sums_[chunk].volume = functions_.chunk_energy(layout, step, chunk);
  });
  double energy = 0;
  for (const kernel::ChunkSums& part : sums_) energy += part.volume;
  return energy;
}

}  // namespace palpate::deformation
