#include "deformation/following_organ.h"

#include <algorithm>
#include <utility>

#include "deformation/model/mesh_change.h"
#include "deformation/models.h"
#include "modules/core/error.h"
#include "modules/scene/probe_shape.h"

namespace palpate::deformation {
namespace {

/// Without a need: as in `palpate new`.
constexpr double kUsualForceError = 0.1;

bool is_quadratic(const geometry::OrganShape& shape) { return !shape.edge_nodes.empty(); }

double growth_of(const scene::Refinement& refine, const geometry::OrganShape& coarse) {
  using scene::Refinement;
  return refine.growth.value_or(is_quadratic(coarse) ? Refinement::kQuadraticGrowth
                                                     : Refinement::kGrowth);
}

std::size_t most_nodes(const scene::Refinement& refine, const geometry::OrganShape& coarse) {
  using scene::Refinement;
  return refine.nodes.value_or(is_quadratic(coarse) ? Refinement::kQuadraticNodes
                                                    : Refinement::kNodes);
}

/// Contacts are a search old, and the search had positions of an advance before it.
constexpr std::size_t kMostEarlier = 8;

}  // namespace

FollowingOrgan::FollowingOrgan(const scene::Scene& scene, scene::Organ organ,
                               const geometry::OrganShape& coarse, ChunkRunner* runner)
    : organ_(std::move(organ)),
      gravity_(scene.gravity),
      period_(1 / scene.rates.deformation),
      runner_(runner),
      mesh_(coarse, growth_of(organ_.solid.refine, coarse),
            most_nodes(organ_.solid.refine, coarse)) {
  const double error = scene.needs.force_error.value_or(kUsualForceError);
  const bool quadratic = is_quadratic(coarse);
  const double over_radius =
      quadratic ? quadratic_edge_over_radius(error) : edge_over_radius(error);
  for (const scene::Probe& probe : scene.probes) {
    touches_.emplace_back(scene::form_of(probe.shape), organ_.solid.refine.edge_length,
                          over_radius);
  }
}

OrganMesh FollowingOrgan::made(std::uint32_t generation) {
  OrganMesh mesh{generation, mesh_.fine_at(places_), nullptr, nullptr, nullptr};
  OrganModel model = build_organ_model(organ_, gravity_, mesh.refined.shape);
  hold_as_coarse(mesh.refined, model);
  mesh.model = std::make_unique<const OrganModel>(std::move(model));
  mesh.compliance = make_compliance(*mesh.model, runner_);
  return mesh;
}

OrganMesh FollowingOrgan::with_dynamics(OrganMesh mesh) const {
  mesh.dynamics = make_dynamics(organ_, *mesh.model, period_, runner_);
  return mesh;
}

OrganMesh FollowingOrgan::begin(std::uint32_t generation) {
  for (TouchFollower& touch : touches_) touch.reset();
  places_.clear();
  present_.clear();
  next_.reset();
  earlier_.clear();
  return with_dynamics(made(generation));
}

void FollowingOrgan::look(std::span<const Pose> poses, const OrganModel& model,
                          std::span<const Vec3> positions, std::uint32_t generation) {
  newest_.clear();
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    touches_[i].look(poses[i], model, positions, newest_);
  }
  if (newest_ == places_) return;
  places_ = newest_;
  next_ = made(generation);
}

OrganMesh FollowingOrgan::take_next(std::uint32_t generation, const OrganModel& model) {
  PALPATE_DEMAND(next_);
  OrganMesh next = with_dynamics(*std::exchange(next_, std::nullopt));
  present_ = places_;
  const auto surface_nodes = [](const OrganModel& of) {
    return std::span(of.rest_positions).first(of.surface_node_count);
  };
  earlier_.push_back(
      {generation, geometry::SurfaceTransfer(surface_nodes(model), model.triangles,
                                             surface_nodes(*next.model), next.model->triangles)});
  if (earlier_.size() > kMostEarlier) earlier_.pop_front();
  return next;
}

void FollowingOrgan::exchange(StateArchive& archive, std::uint32_t generation) {
  bool has_next = next_.has_value();
  for (TouchFollower& touch : touches_) archive(touch);
  archive(places_, present_, has_next, earlier_);
  if (!archive.reads()) return;
  next_.reset();
  if (has_next) next_ = made(generation + 1);
}

OrganMesh FollowingOrgan::present(std::uint32_t generation) {
  places_.swap(present_);
  OrganMesh mesh = made(generation);
  places_.swap(present_);
  return with_dynamics(std::move(mesh));
}

std::size_t FollowingOrgan::first_of(std::uint32_t generation) const {
  const auto found = std::ranges::find(earlier_, generation, &Earlier::generation);
  return static_cast<std::size_t>(found - earlier_.begin());
}

bool FollowingOrgan::carry(std::uint32_t generation, Contact& contact) const {
  const std::size_t first = first_of(generation);
  for (std::size_t i = first; i < earlier_.size(); ++i) {
    if (contact.triangle >= earlier_[i].transfer.triangle_count()) return false;
    const auto place = earlier_[i].transfer.place({contact.triangle, contact.barycentric});
    contact.triangle = place.triangle;
    contact.barycentric = place.weights;
  }
  return first < earlier_.size();
}

bool FollowingOrgan::carry(std::uint32_t generation, std::uint32_t& node) const {
  const std::size_t first = first_of(generation);
  for (std::size_t i = first; i < earlier_.size(); ++i) {
    if (node >= earlier_[i].transfer.node_count()) return false;
    node = earlier_[i].transfer.node(node);
  }
  return first < earlier_.size();
}

}  // namespace palpate::deformation
