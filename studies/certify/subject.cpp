#include "studies/certify/subject.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "modules/core/error.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_reader.h"

namespace palpate::certify {
namespace {

constexpr double kReachWithin = 30;   // [s]
constexpr double kStraightAt = 0.03;  // [m/s]

/// Of the probe's contacts that touch: one of them, turned by all.
std::optional<Place> place_of(const Contacts& contacts, double time) {
  Vec3 normal = Vec3::Zero();
  const Contact* deepest = nullptr;
  for (const Contact& contact : contacts.contacts) {
    if (contact.gap > 0) continue;
    normal += contacts.probe_pose.rotation * contact.normal_P;
    if (deepest == nullptr || contact.gap < deepest->gap) deepest = &contact;
  }
  if (deepest == nullptr || normal.norm() == 0) return std::nullopt;
  Place place;
  place.organ = deepest->organ;
  place.into = -normal.normalized();
  place.pose = contacts.probe_pose;
  place.pose.position += deepest->gap * place.into;
  place.tip = place.pose.to_world(deepest->point_P);
  place.time = time;
  return place;
}

std::optional<Place> first_touch(const scene::Scene& scene, const session::Assets& assets,
                                 double longest, const KeepGoing& keep_going) {
  session::InProcess session(scene, assets);
  while (session.time() < longest) {
    keep_going();
    session.tick();
    if (const auto place = place_of(session.contacts(0), session.time())) return place;
  }
  return std::nullopt;
}

/// From where the probe starts to the nearest node of an organ.
scene::ScriptedDevice straight_to_an_organ(const scene::Scene& scene,
                                           const session::Assets& assets) {
  std::vector<std::string> warnings;
  const Pose start =
      haptics::make_device(scene.probes[0].device, scene.haptics, warnings)->read(0).pose;
  double least = std::numeric_limits<double>::infinity();
  Vec3 nearest = start.position;
  for (const auto& organ : assets.organs) {
    for (const Vec3& node : organ.surface.nodes) {
      if ((node - start.position).norm() >= least) continue;
      least = (node - start.position).norm();
      nearest = node;
    }
  }
  return {start.position, start.rotation, {{nearest, std::max(0.1, least / kStraightAt)}}};
}

}  // namespace

Pose pose_below(const Place& place, double below) {
  return {place.pose.position + below * place.into, place.pose.rotation};
}

Subject load_subject(const std::filesystem::path& file, const KeepGoing& keep_going) {
  Subject subject;
  subject.scene = scene::in_one_process(scene::load_scene(file));
  subject.scene.probes.resize(1);
  subject.assets = session::load_assets(subject.scene);
  scene::Probe& probe = subject.scene.probes[0];
  const double duration = subject.scene.duration;
  auto place =
      first_touch(subject.scene, subject.assets,
                  duration > 0 ? std::min(duration, kReachWithin) : kReachWithin, keep_going);
  if (!place) {
    scene::Scene straight = subject.scene;
    straight.probes[0].device = straight_to_an_organ(subject.scene, subject.assets);
    place = first_touch(straight, subject.assets, kReachWithin, keep_going);
  }
  if (!place) {
    throw InputError(fmt::format("{}: probe '{}' comes to no organ: nothing can be certified",
                                 file.string(), probe.name));
  }
  subject.place = *place;
  if (const auto* emulated = std::get_if<scene::EmulatedDevice>(&probe.device)) {
    subject.device = *emulated;
    subject.device.hand = {};
  }
  subject.device.start = place->pose.position;
  subject.device.rotation = place->pose.rotation;
  return subject;
}

}  // namespace palpate::certify
