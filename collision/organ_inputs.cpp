#include "collision/organ_inputs.h"

#include <algorithm>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/messages/message_checks.h"
#include "modules/messages/message_state.h"
#include "modules/runtime/wiring.h"

namespace palpate::collision {
namespace {

/// Surfaces of an organ that wait for their positions.
constexpr std::size_t kMostTold = 8;

void read_boxes(std::span<const float> from, std::vector<geometry::BlockBox>& boxes) {
  boxes.resize(from.size() / 6);
  for (geometry::BlockBox& box : boxes) {
    std::copy_n(from.begin(), 3, box.lower.begin());
    std::copy_n(from.begin() + 3, 3, box.upper.begin());
    from = from.subspan(6);
  }
}

}  // namespace

OrganInputs::OrganInputs(bus::Bus& bus, std::vector<geometry::ProbeForm> probes,
                         const std::vector<scene::Organ>& organs)
    : surfaces_(bus.reader(bus::kSurface)),
      positions_(bus.reader(bus::kNodePositions)),
      probes_(std::move(probes)),
      organs_(organs.size()) {
  for (std::size_t i = 0; i < organs.size(); ++i) {
    organs_[i].follows = organs[i].solid.refine.follow;
  }
}

void OrganInputs::take() {
  while (surfaces_.take(surface_)) take_surface();
  while (positions_.take(newest_)) take_positions();
}

void OrganInputs::hear_anew(std::int64_t since_ns) {
  since_ns_ = since_ns;
  if (finder_) finder_->reset();
  for (OrganInput& organ : organs_) organ.placed = false;
}

bool OrganInputs::placed() const { return std::ranges::all_of(organs_, &OrganInput::placed); }

void OrganInputs::tell_generations(std::vector<std::uint32_t>& generations) const {
  generations.clear();
  for (const OrganInput& organ : organs_) generations.push_back(organ.generation);
}

bool OrganInputs::boxes_misfit() const {
  return std::ranges::any_of(organs_, &OrganInput::boxes_misfit);
}

void OrganInputs::exchange(StateArchive& archive) {
  archive.same(organs_.size());
  for (OrganInput& organ : organs_) archive(organ);
  bool has_finder = finder_.has_value();
  archive(has_finder, interval_);
  if (archive.reads() && has_finder) make_finder();
  if (finder_) archive(*finder_);
}

void OrganInputs::OrganInput::exchange(StateArchive& archive) {
  archive(generation, triangles, triangle_blocks, surface_node_count, rest_positions, block_count,
          boxes_misfit, placed, anew, came_ns);
  std::size_t told = next.size();
  archive(told);
  if (told > kMostTold || (archive.reads() && !is_surface()))
    throw InputError("its state holds surfaces that cannot be");
  next.resize(told);
  for (SurfaceTopology& surface : next) messages::exchange_message(archive, surface);
}

bool OrganInputs::OrganInput::is_surface() const {
  if (rest_positions.empty()) return surface_node_count == 0 && triangles.empty();
  SurfaceTopology surface;
  surface.header.sequence = 1;  // this and a name are of whoever said it
  surface.name = "organ";
  surface.surface_node_count = static_cast<std::uint32_t>(surface_node_count);
  surface.rest_positions = rest_positions;
  surface.triangles = triangles;
  surface.triangle_blocks = triangle_blocks;
  return surface.surface_node_count == surface_node_count &&
         messages::first_invalid_field(surface) == nullptr;
}

/// The first surface puts its organ at rest. One of the same triangles starts it anew: what was
/// remembered of the search before no longer holds. It has not if positions told after it are
/// there already: of a deformation that begins anew they may be heard first. One of the same
/// generation is told by a process that may go on where the one before it was: until positions come
/// the organ is there, too. One of other triangles waits for its positions likewise, and of an
/// organ that follows one of a later generation: it may have changed inside alone.
void OrganInputs::take_surface() {
  if (surface_.organ >= organs_.size()) return;
  OrganInput& organ = organs_[surface_.organ];
  if (!finder_ || surface_.triangles.empty()) {
    know(surface_, organ);
    organ.placed = surface_.header.source_time_ns == runtime::CycleGrid::kSetUp;
    return make_finder();
  }
  const bool changed_inside = organ.follows && surface_.generation > organ.generation;
  if (!organ.next.empty() || changed_inside || organ.triangles != surface_.triangles ||
      organ.triangle_blocks != surface_.triangle_blocks) {
    if (organ.next.size() == kMostTold) organ.next.erase(organ.next.begin());
    organ.next.push_back(surface_);
    return;
  }
  const bool same = surface_.generation == organ.generation;
  const bool heard_late = same && surface_.header.source_time_ns < organ.came_ns;
  know(surface_, organ);
  if (heard_late) return;
  if (same) {
    organ.anew = true;
    return;
  }
  finder_->reset();
  put_at_rest(surface_.organ);
}

void OrganInputs::know(const SurfaceTopology& surface, OrganInput& organ) {
  organ.generation = surface.generation;
  organ.surface_node_count = surface.surface_node_count;
  organ.triangles = surface.triangles;
  organ.triangle_blocks = surface.triangle_blocks;
  organ.block_count = 0;
  for (const std::uint32_t block : organ.triangle_blocks) {
    organ.block_count = std::max(organ.block_count, std::size_t{block} + 1);
  }
  organ.rest_positions = surface.rest_positions;
}

std::vector<Vec3> OrganInputs::rest_of(const OrganInput& organ) {
  std::vector<Vec3> rest;
  for (std::size_t i = 0; i < organ.surface_node_count; ++i) {
    const float* x = organ.rest_positions.data() + 3 * i;
    rest.emplace_back(x[0], x[1], x[2]);
  }
  return rest;
}

/// The surface told last that positions of a generation are of, if it waits for them.
void OrganInputs::take_next(std::size_t index, std::uint32_t generation) {
  OrganInput& organ = organs_[index];
  const auto told = std::find_if(
      organ.next.rbegin(), organ.next.rend(),
      [&](const SurfaceTopology& surface) { return surface.generation == generation; });
  if (told == organ.next.rend()) return;
  const std::vector<Vec3> before = rest_of(organ);
  know(*told, organ);
  organ.next.erase(organ.next.begin(), told.base());
  finder_->change_organ(index, organ.triangles, organ.triangle_blocks, before, rest_of(organ));
}

void OrganInputs::put_at_rest(std::size_t organ) {
  std::vector<float> positions = organs_[organ].rest_positions;
  std::vector<geometry::BlockBox> boxes;
  finder_->take_organ(organ, positions, boxes);
}

void OrganInputs::make_finder() {
  finder_.reset();
  std::vector<std::vector<geometry::Triangle>> triangles;
  std::vector<std::vector<std::uint32_t>> blocks;
  for (const OrganInput& organ : organs_) {
    if (organ.triangles.empty()) return;
    triangles.push_back(organ.triangles);
    blocks.push_back(organ.triangle_blocks);
  }
  finder_.emplace(std::move(triangles), probes_, blocks);
  for (std::size_t i = 0; i < organs_.size(); ++i) put_at_rest(i);
}

/// Positions of another generation than the surface's wait for their surface.
void OrganInputs::take_positions() {
  if (newest_.organ >= organs_.size() || !finder_) return;
  OrganInput& organ = organs_[newest_.organ];
  if (newest_.generation != organ.generation) take_next(newest_.organ, newest_.generation);
  if (newest_.generation != organ.generation ||
      newest_.positions.size() < 3 * organ.surface_node_count) {
    return;
  }
  read_boxes(newest_.block_boxes, boxes_);
  organ.boxes_misfit = !boxes_.empty() && boxes_.size() != organ.block_count;
  if (std::exchange(organ.anew, false)) finder_->reset();
  finder_->take_organ(newest_.organ, newest_.positions, boxes_);
  organ.placed |= newest_.header.source_time_ns >= since_ns_;
  const std::int64_t before_ns = organ.came_ns;
  organ.came_ns = newest_.header.source_time_ns;
  if (newest_.organ == 0 && before_ns != 0) interval_ = seconds_from_ns(organ.came_ns - before_ns);
}

}  // namespace palpate::collision
