#include "studies/contact_loop/contact_loop.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <utility>

#include "deformation/contact/contact_solve.h"
#include "modules/bus/tap.h"
#include "modules/core/error.h"
#include "modules/core/rotation_vector.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/winding_number.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::contact_loop {
namespace {

constexpr double kShallow = -7e-3, kDeep = 15e-3;  // the tip below the skin at rest [m]
constexpr double kMiddle = (kShallow + kDeep) / 2, kHalf = (kDeep - kShallow) / 2;
constexpr double kHeldDepth = 10e-3;            // at the end [m]
constexpr double kSideways = 8e-3;              // [m]
constexpr double kTurnX = 0.31, kTurnZ = 0.23;  // of the rate of presses
constexpr double kWait = 0.1, kHold = 0.3;      // before and after the motion [s]
constexpr double kLeastMotion = 1.0;            // [s]
constexpr double kLeastPresses = 2;
constexpr double kWithin = 0.8;     // of a half extent, from a box's or cone's middle
constexpr double kRounding = 1e-7;  // of positions in a message [m]

/// In and out along y, to and fro along x and z, then held where it is.
class Sliding final : public haptics::Device {
 public:
  Sliding(const Vec3& skin, const LoopCase& loop)
      : skin_(skin - loop.tool.reach * Vec3::UnitY()),
        rotation_(loop.tool.rotation),
        rate_(loop.speed / std::hypot(kHalf, kTurnX * kSideways, kTurnZ * kSideways)),
        last_turn_(2 * M_PI * std::ceil(std::max(kLeastPresses, kLeastMotion * rate_ / 2 / M_PI)) +
                   std::acos((kMiddle - kHeldDepth) / kHalf)) {}

  double presses() const { return std::ceil(last_turn_ / 2 / M_PI); }
  double duration() const { return kWait + last_turn_ / rate_ + kHold; }

  haptics::DeviceSample read(double time) override {
    const double turn = std::clamp(rate_ * (time - kWait), 0.0, last_turn_);
    const double depth = kMiddle - kHalf * std::cos(turn);
    haptics::DeviceSample sample;
    sample.pose.rotation = rotation_;
    sample.pose.position = skin_ + Vec3(kSideways * std::sin(kTurnX * turn), depth,
                                        kSideways * std::sin(kTurnZ * turn));
    if (turn <= 0 || turn >= last_turn_) return sample;
    sample.twist.linear =
        rate_ * Vec3(kTurnX * kSideways * std::cos(kTurnX * turn), kHalf * std::sin(turn),
                     kTurnZ * kSideways * std::cos(kTurnZ * turn));
    return sample;
  }

 private:
  Vec3 skin_;
  Quat rotation_;
  double rate_, last_turn_;
};

scene::Scene scene_of(scene::Scene scene, const LoopCase& loop) {
  scene.probes.clear();
  scene.probes.push_back({"tool", loop.tool.shape, 0.1, scene::ScriptedDevice{}});
  scene.rates.haptics = 1000;
  scene.rates.collision = loop.collision_hz;
  scene.rates.deformation = loop.deformation_hz;
  return scene;
}

/// Looks at every search with the surface it was made on.
class Judge {
 public:
  Judge(session::InProcess& session, const Tool& tool)
      : session_(session),
        tool_(tool),
        contacts_(session.bus().reader(bus::kContacts)),
        positions_(session.bus().reader(bus::kNodePositions)),
        topologies_(session.bus().reader(bus::kSurface)),
        laws_(session.bus().reader(bus::kContactModel)) {}

  void look(LoopResult& result) {
    take_surfaces();
    while (contacts_.take(newest_)) judge(result);
    while (laws_.take(law_)) judge_advance(result);
    while (surfaces_.size() > 8) surfaces_.pop_front();
  }

 private:
  /// Positions and the mesh they are of: one that follows a probe changes.
  struct Surface {
    NodePositions nodes;
    std::shared_ptr<const SurfaceTopology> mesh;
  };

  void take_surfaces() {
    SurfaceTopology mesh;
    while (topologies_.take(mesh)) {
      if (mesh.organ == 0) meshes_.push_back(std::make_shared<const SurfaceTopology>(mesh));
    }
    NodePositions nodes;
    while (positions_.take(nodes)) {
      if (nodes.organ != 0) continue;
      const auto mesh_of_it = std::find_if(meshes_.rbegin(), meshes_.rend(), [&](const auto& m) {
        return m->generation == nodes.generation;
      });
      if (mesh_of_it != meshes_.rend()) surfaces_.push_back({nodes, *mesh_of_it});
    }
    while (meshes_.size() > 8) meshes_.pop_front();
  }

  /// The surface that deformation made, at the pose it made it for.
  void judge_advance(LoopResult& result) {
    const auto at = std::find_if(surfaces_.rbegin(), surfaces_.rend(), [&](const Surface& s) {
      return s.nodes.header.sim_time_ns == law_.header.sim_time_ns;
    });
    if (at == surfaces_.rend()) return;
    ++result.advances;
    const bool inside = !points_inside(tool_.within, law_.anchor, *at).empty();
    const bool crossed = inside && !was_inside_;
    result.crossings += crossed;
    result.put_back += crossed && *session_.health("deformation").guard != '\0';
    was_inside_ = inside;
    const long unsolved = session_.contact_troubles().unsolved;
    const bool said = std::exchange(unsolved_, unsolved) != unsolved;
    const double before = left_;
    left_ = std::numeric_limits<double>::infinity();
    if (!tool_.is_round() || inside) return;
    left_ = tissue_in(law_.anchor, *at);
    result.deepest_tissue = std::max(result.deepest_tissue, left_);
    const double allowed = std::max(before, deformation::kUnsolvedDepth) + kRounding;
    if (left_ <= deformation::kUnsolvedDepth + kRounding) known_within_ = false;
    known_within_ |= left_ > allowed && said;
    const bool swallowed = left_ > allowed && !said;
    result.swallowed += swallowed;
    result.swallowed_on += swallowed && known_within_;
  }

  /// How deep tissue that can move and that its core sees is in a round tool [m].
  double tissue_in(const Pose& pose, const Surface& surface) const {
    const Vec3 a = pose.to_world(tool_.inside.front()), b = pose.to_world(tool_.inside.back());
    double deepest = 0;
    for (const auto& triangle : surface.mesh->triangles) {
      const auto corners = corners_of(triangle, surface);
      const auto [core, place] = nearest_to(a, b, corners);
      const Vec3 away = core - place.point;
      const double depth = tool_.radius - away.norm();
      if (depth > deepest && geometry::unit_normal(corners).dot(away) > 0 &&
          can_move(triangle, place.weights, surface)) {
        deepest = depth;
      }
    }
    return deepest;
  }

  static std::pair<Vec3, geometry::PointOnTriangle> nearest_to(
      const Vec3& a, const Vec3& b, const geometry::TriangleCorners& corners) {
    if (a == b) return {a, geometry::closest_on_triangle(a, corners)};
    const auto pair = geometry::closest_of_segment_and_triangle(a, b, corners);
    return {pair.on_segment, pair.on_triangle};
  }

  void judge(LoopResult& result) {
    ++result.searches;
    // What deformation says at an instant, it says after the search of that instant.
    const auto on = std::find_if(surfaces_.rbegin(), surfaces_.rend(), [&](const Surface& s) {
      return s.nodes.header.source_time_ns < newest_.header.source_time_ns &&
             (newest_.generations.empty() || s.nodes.generation == newest_.generations[0]);
    });
    if (on == surfaces_.rend()) return;
    const auto points = points_inside(tool_.inside, newest_.probe_pose, *on);
    if (points.empty()) {
      lost_since_ = -1;
      return;
    }
    ++result.inside;
    for (const Vec3& p : points) {
      result.deepest = std::max(result.deepest, depth_of(p, *on));
    }
    const bool held = newest_.deepest_gap() < 0;
    if (held) {
      lost_since_ = -1;
      return;
    }
    ++result.lost;
    const double now = seconds_from_ns(newest_.header.sim_time_ns);
    if (lost_since_ < 0) lost_since_ = now;
    result.longest_lost =
        std::max(result.longest_lost, now - lost_since_ + 1 / session_.scene().rates.collision);
  }

  static std::vector<Vec3> points_inside(const std::vector<Vec3>& of_tool, const Pose& pose,
                                         const Surface& surface) {
    std::vector<Vec3> points;
    for (const Vec3& p_P : of_tool) {
      const Vec3 p = pose.to_world(p_P);
      if (geometry::winding_number(p, surface.nodes.positions, surface.mesh->triangles) > 0.5) {
        points.push_back(p);
      }
    }
    return points;
  }

  static bool can_move(const geometry::Triangle& triangle, const Vec3& weights,
                       const Surface& surface) {
    bool moves = false;
    for (int k = 0; k < 3; ++k) {
      const auto& fixed = surface.mesh->fixed_nodes;
      moves |= weights[k] > 0 && std::ranges::find(fixed, triangle[k]) == fixed.end();
    }
    return moves;
  }

  double depth_of(const Vec3& p, const Surface& surface) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& triangle : surface.mesh->triangles) {
      const auto q = geometry::closest_on_triangle(p, corners_of(triangle, surface));
      nearest = std::min(nearest, (q.point - p).norm());
    }
    return nearest;
  }

  static geometry::TriangleCorners corners_of(const geometry::Triangle& t, const Surface& surface) {
    const auto at = [&](std::uint32_t node) -> Vec3 {
      return Eigen::Map<const Eigen::Vector3f>(&surface.nodes.positions[3 * node]).cast<double>();
    };
    return {at(t[0]), at(t[1]), at(t[2])};
  }

  session::InProcess& session_;
  const Tool& tool_;
  bus::Reader<Contacts> contacts_;
  bus::Reader<NodePositions> positions_;
  bus::Reader<SurfaceTopology> topologies_;
  bus::Reader<ContactModel> laws_;
  std::deque<Surface> surfaces_;
  std::deque<std::shared_ptr<const SurfaceTopology>> meshes_;
  Contacts newest_;
  ContactModel law_;
  bool was_inside_ = true;  ///< a tool that begins inside has crossed nothing
  double lost_since_ = -1;
  bool known_within_ = true;  ///< tissue that is not out yet: it began with it, or that was said
  long unsolved_ = 0;         ///< of the advances before
  /// Tissue in a round tool, which goes out gently where it was not seen coming [m]
  double left_ = std::numeric_limits<double>::infinity();
};

/// The same samples each time.
session::InProcessOptions options_of(double loss) {
  session::InProcessOptions options;
  if (loss <= 0) return options;
  options.tap = [loss](bus::Bus& carrier) {
    auto tapped = std::make_unique<bus::TappedBus>(carrier);
    std::mt19937_64::result_type seed = 0;
    for (const auto topic : {bus::kContacts.name, bus::kNodePositions.name}) {
      tapped->set_tap(
          topic,
          bus::lose_tap([loss, random = std::mt19937_64(++seed)](const bus::Passing&) mutable {
            return std::uniform_real_distribution<double>()(random) < loss;
          }));
    }
    return tapped;
  };
  return options;
}

Tool ball_of(double radius) {
  return {"ball",
          scene::SphereShape{radius},
          {},
          Quat::Identity(),
          radius,
          radius,
          {Vec3::Zero()},
          {Vec3::Zero()}};
}

Tool needle() {
  const scene::CapsuleShape shape{5e-4, 0.04};
  Tool tool{"needle",     shape, {}, rotation_between(Vec3::UnitZ(), Vec3::UnitY()),
            shape.radius, 0,     {}, {}};
  tool.reach = shape.length / 2 + shape.radius;
  for (int i = 0; i <= 8; ++i)
    tool.inside.push_back((i / 8.0 - 0.5) * shape.length * Vec3::UnitZ());
  tool.within = tool.inside;
  return tool;
}

/// Lying on the wall: its side goes in first, its ends may never.
Tool rod_of(const std::string& name, double radius) {
  const scene::CapsuleShape shape{radius, 0.04};
  Tool tool{name,   shape,  {}, rotation_between(Vec3::UnitZ(), Vec3::UnitX()),
            radius, radius, {}, {}};
  for (int i = 0; i <= 32; ++i)
    tool.inside.push_back((i / 32.0 - 0.5) * shape.length * Vec3::UnitZ());
  tool.within = tool.inside;
  return tool;
}

Tool box_of(const std::string& name, const Vec3& size) {
  Tool tool{name,         scene::BoxShape{size},          {}, Quat::Identity(), 0,
            size.y() / 2, geometry::make_box(size).nodes, {}};
  for (int i = 0; i < 27; ++i) {
    const Vec3 at(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    tool.within.emplace_back(kWithin / 2 * at.cwiseProduct(size));
  }
  return tool;
}

/// No two corners at one distance from the middle.
Tool pebble() {
  Tool tool{"mesh", scene::MeshShape{}, geometry::make_ball(5e-3, 1), Quat::Identity(), 0, 0, {},
            {}};
  for (std::size_t i = 0; i < tool.mesh.nodes.size(); ++i) {
    tool.mesh.nodes[i] *= 1 + 0.1 * std::sin(7.0 * static_cast<double>(i));
    tool.reach = std::max(tool.reach, tool.mesh.nodes[i].y());
  }
  tool.inside = tool.mesh.nodes;
  for (const Vec3& node : tool.mesh.nodes) tool.within.emplace_back(kWithin * node);
  return tool;
}

/// Along the middle of each jaw, from hinge to tip.
void append_within(const scene::GrasperShape& jaws, Tool& tool) {
  const double c = std::cos(jaws.opening / 2), s = std::sin(jaws.opening / 2);
  for (const double side : {1.0, -1.0}) {
    const Vec3 down(0, side * s, -c), out(0, side * c, s);
    for (int i = 0; i <= 8; ++i) {
      const double along = (1 + kWithin * (i / 4.0 - 1)) / 2 * jaws.length;
      tool.within.emplace_back(Vec3(0, 0, jaws.length * c) + along * down +
                               jaws.thickness / 2 * out);
    }
  }
}

/// Along −z of the probe, which is turned into +y of the world.
Tool tips_first(const std::string& name, const scene::ProbeShape& shape) {
  Tool tool{name, shape, {}, rotation_between(-Vec3::UnitZ(), Vec3::UnitY()), 0, 0, {}, {}};
  tool.inside = std::get<geometry::TriangleSurface>(scene::form_of(shape)).nodes;
  if (const auto* cone = std::get_if<scene::ConeShape>(&shape)) {
    for (int i = 0; i <= 8; ++i) {
      tool.within.emplace_back(0, 0, (1 + kWithin * (i / 4.0 - 1)) / 2 * cone->length);
    }
  }
  if (const auto* jaws = std::get_if<scene::GrasperShape>(&shape)) append_within(*jaws, tool);
  return tool;
}

}  // namespace

Tool make_tool(const std::string& name, double radius) {
  if (name == "ball") return ball_of(radius);
  if (name == "needle") return needle();
  if (name == "rod") return rod_of(name, 2e-3);
  if (name == "wire") return rod_of(name, 5e-4);
  if (name == "box") return box_of(name, Vec3::Constant(0.01));
  if (name == "blade") return box_of(name, Vec3(1e-3, 0.02, 0.015));
  if (name == "mesh") return pebble();
  if (name == "cone") return tips_first(name, scene::ConeShape{0.002, 0.02});
  if (name == "grasper") return tips_first(name, scene::GrasperShape{0.015, 0.005, 0.003, 0.4});
  throw InputError("tool '" + name +
                   "': one of ball, needle, rod, wire, box, blade, mesh, cone, grasper");
}

LoopResult run_loop(const scene::Scene& scene, const session::Assets& assets, const Vec3& place,
                    const LoopCase& loop, const std::function<void()>& keep_going) {
  session::InProcess session(scene_of(scene, loop), {assets.organs, {loop.tool.mesh}},
                             options_of(loop.loss));
  const Vec3 skin(place.x(), rigs::front_of(assets.organs[0].surface, place.x(), place.z()),
                  place.z());
  auto device = std::make_unique<Sliding>(skin, loop);
  const double duration = device->duration();
  const long presses = static_cast<long>(device->presses());
  session.haptics().set_device(0, std::move(device));
  LoopResult result;
  result.presses = presses;
  Judge judge(session, loop.tool);
  while (session.time() < duration) {
    keep_going();
    session.tick();
    judge.look(result);
  }
  result.troubles = session.contact_troubles();
  return result;
}

}  // namespace palpate::contact_loop
