#include "studies/fuzz/minimise.h"

namespace palpate::fuzz {
namespace {

using Change = std::function<void(RandomScene&)>;

template <class T>
void erase(std::vector<T>& list, std::size_t i) {
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
}

void drop_probe(RandomScene& s, std::size_t i) {
  erase(s.scene.probes, i);
  erase(s.probe_shapes, i);
  std::erase_if(s.faults, [i](const TimedFault& fault) { return fault.probe == i; });
  for (TimedFault& fault : s.faults) fault.probe -= fault.probe > i;
}

void add_organ_changes(std::size_t i, bool several, std::vector<Change>& changes) {
  const auto organ = [&](auto change) {
    changes.push_back([i, change](RandomScene& s) { change(s.scene.organs[i]); });
  };
  if (several) {
    changes.push_back([i](RandomScene& s) {
      erase(s.scene.organs, i);
      erase(s.organ_shapes, i);
    });
  }
  organ([](scene::Organ& o) { o.fixed.clear(); });
  organ([](scene::Organ& o) { o.filling = {}; });
  organ([](scene::Organ& o) { o.springs = {}; });
  organ([](scene::Organ& o) { o.solid = {}; });
  organ([](scene::Organ& o) { o.volume_corrections = 0; });
  organ([](scene::Organ& o) { o.integrator = scene::Integrator::kAutomatic; });
  organ([](scene::Organ& o) { o.pose = {}; });
  organ([](scene::Organ& o) { o.tissue = {}; });
  organ([](scene::Organ& o) { o.tissue.youngs_modulus = scene::Tissue{}.youngs_modulus; });
  organ([](scene::Organ& o) { o.tissue.wall_thickness = scene::Tissue{}.wall_thickness; });
  organ([](scene::Organ& o) { o.tissue.density = scene::Tissue{}.density; });
  organ([](scene::Organ& o) { o.tissue.damping_ratio = scene::Tissue{}.damping_ratio; });
  organ([](scene::Organ& o) { o.tissue.drag = scene::Tissue{}.drag; });
  for (std::size_t smaller = 0; smaller < kShapeCount; ++smaller) {
    changes.push_back([i, smaller](RandomScene& s) {
      Shape& shape = s.organ_shapes[i].shape;
      if (static_cast<std::size_t>(shape) > smaller) shape = static_cast<Shape>(smaller);
    });
  }
  changes.push_back([i](RandomScene& s) { s.organ_shapes[i].size.setConstant(0.1); });
}

void add_probe_changes(std::size_t i, bool several, std::vector<Change>& changes) {
  const auto probe = [&](auto change) {
    changes.push_back([i, change](RandomScene& s) { change(s.scene.probes[i]); });
  };
  if (several) changes.push_back([i](RandomScene& s) { drop_probe(s, i); });
  probe([](scene::Probe& p) { p.shape = scene::SphereShape{}; });
  probe([](scene::Probe& p) { p.friction = 0; });
  probe([](scene::Probe& p) {
    if (auto* way = std::get_if<scene::ScriptedDevice>(&p.device)) {
      way->rotation = Quat::Identity();
    }
  });
  probe([](scene::Probe& p) {
    const auto* held = std::get_if<scene::EmulatedDevice>(&p.device);
    if (held) p.device = scene::ScriptedDevice{held->start, held->rotation, held->hand.moves};
  });
  probe([](scene::Probe& p) {
    if (auto* held = std::get_if<scene::EmulatedDevice>(&p.device)) held->transport_delay = 0;
  });
  probe([](scene::Probe& p) {
    auto* way = std::get_if<scene::ScriptedDevice>(&p.device);
    if (way != nullptr && !way->moves.empty()) way->moves.pop_back();
  });
}

std::vector<Change> changes_of(const RandomScene& scene) {
  std::vector<Change> changes;
  const std::size_t probes = scene.scene.probes.size(), organs = scene.scene.organs.size();
  changes.push_back([](RandomScene& s) { s.faults.clear(); });
  for (std::size_t i = 0; i < probes; ++i) add_probe_changes(i, probes > 1, changes);
  for (std::size_t i = 0; i < organs; ++i) add_organ_changes(i, organs > 1, changes);
  for (std::size_t i = 0; i < scene.faults.size(); ++i) {
    changes.push_back([i](RandomScene& s) { erase(s.faults, i); });
  }
  changes.push_back([](RandomScene& s) { s.scene.gravity.setZero(); });
  changes.push_back([](RandomScene& s) { s.scene.rates = {}; });
  changes.push_back([](RandomScene& s) { s.scene.haptics = {}; });
  changes.push_back([](RandomScene& s) {
    if (s.scene.duration > 2e-3) s.scene.duration /= 2;
  });
  return changes;
}

}  // namespace

RandomScene minimised(RandomScene scene, const std::function<bool(const RandomScene&)>& fails) {
  for (bool simpler = true; simpler;) {
    simpler = false;
    for (const Change& change : changes_of(scene)) {
      RandomScene candidate = scene;
      change(candidate);
      if (text_of(candidate) == text_of(scene) || !fails(candidate)) continue;
      scene = std::move(candidate);
      simpler = true;
      break;  // lists have changed
    }
  }
  return scene;
}

}  // namespace palpate::fuzz
