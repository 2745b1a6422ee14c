// A process of a session begins anew under a pressed tool, and hears, and is heard by, the others
// one topic after another.
#include <algorithm>
#include <catch2/catch.hpp>
#include <deque>
#include <map>
#include <random>

#include "collision/stage.h"
#include "deformation/stage.h"
#include "modules/bus/memory_bus.h"
#include "modules/core/data_folder.h"
#include "modules/geometry/winding_number.h"
#include "modules/runtime/kept_state.h"
#include "modules/scene/scene_reader.h"
#include "studies/contact_loop/contact_loop.h"
#include "studies/rigs/poked_organ.h"
#include "tests/times.h"

namespace palpate::contact_loop {
namespace {

/// When a topic of a new process is heard, from its start [ms].
using Joins = std::map<std::string, std::int64_t, std::less<>>;

/// The memory bus as one process hears it: of writers that are new to it, or of all when it is new,
/// each topic from its time on.
class LateBus final : public bus::Bus {
 public:
  explicit LateBus(bus::Bus& carrier) : carrier_(carrier) {
    set_clock([&carrier] { return carrier.now_ns(); });
  }
  /// Samples are late of who writes them for the first time from now on, and of all if `is_new`.
  void join(const Joins& after_ms, bool is_new) {
    late_.clear();
    for (const auto& [topic, ms] : after_ms) late_[topic] = now_ns() + ms * kMs;
    if (is_new) known_.clear();
  }
  std::unique_ptr<bus::RawWriter> raw_writer(const bus::TopicInfo& topic) override {
    return carrier_.raw_writer(topic);
  }
  std::unique_ptr<bus::RawReader> raw_reader(const bus::TopicInfo& topic, bus::Keep keep) override {
    return std::make_unique<LateReader>(*this, topic, carrier_.raw_reader(topic, keep));
  }

 private:
  class LateReader final : public bus::RawReader {
   public:
    LateReader(LateBus& bus, const bus::TopicInfo& topic, std::unique_ptr<bus::RawReader> reader)
        : bus_(bus), topic_(topic), reader_(std::move(reader)) {}
    bool take(bus::RawSample& sample) override {
      while (reader_->take(sample)) {
        if (!bus_.is_late(topic_, sample.writer)) return true;
        if (topic_.delivery == bus::Delivery::kState) waiting_.push_back(sample);
      }
      if (waiting_.empty() || bus_.is_late(topic_, waiting_.front().writer)) return false;
      sample = waiting_.front();
      waiting_.pop_front();
      return true;
    }
    bool wait(double timeout) override { return reader_->wait(timeout); }
    int matched_writers() const override { return reader_->matched_writers(); }

   private:
    LateBus& bus_;
    bus::TopicInfo topic_;
    std::unique_ptr<bus::RawReader> reader_;
    std::deque<bus::RawSample> waiting_;
  };

  bool is_late(const bus::TopicInfo& topic, const bus::WriterId& writer) {
    auto& known = known_[std::string(topic.name)];
    if (std::ranges::find(known, writer) != known.end()) return false;
    const auto late = late_.find(topic.name);
    if (late != late_.end() && now_ns() < late->second) return true;
    known.push_back(writer);
    return false;
  }

  bus::Bus& carrier_;
  std::map<std::string, std::int64_t, std::less<>> late_;
  std::map<std::string, std::vector<bus::WriterId>, std::less<>> known_;
};

/// Of "collision" or "deformation", held pressed for a while.
struct Restart {
  std::string module;
  std::int64_t after_ms = 0, silence_ms = 0;
  Joins joins;
  bool keeps = false;  ///< its successor goes on from what it kept
};

struct Outcome {
  long searches = 0, inside = 0, lost = 0;    ///< after it, with the tissue that there is
  double before = 0, last = 0, greatest = 0;  ///< force, the latter two after it [N]
};

constexpr std::int64_t kBegin = 1000 * kSecond;  ///< [ns]
constexpr std::int64_t kPress = 500,
                       kLook = 900;  ///< how long it is pressed in, and looked at [ms]
constexpr double kApart = 0.002;     ///< at the beginning [m]
const Vec3 kPlace(rigs::kOnStomach.x, 0, rigs::kOnStomach.z);

class Session {
 public:
  Session(const scene::Scene& scene, const session::Assets& assets, const Tool& tool)
      : scene_(scene), assets_(assets), tool_(tool) {
    scene_.probes.clear();
    scene_.probes.push_back({"tool", tool.shape, 0.1, scene::ScriptedDevice{}});
    bus_.set_clock([this] { return now_ns_; });
    make("collision");
    make("deformation");
  }

  /// Pressed by `depth` along y, and held.
  Outcome run(const Vec3& place, double depth, const Restart& restart) {
    const double skin = rigs::front_of(assets_.organs[0].surface, place.x(), place.z());
    const Vec3 from(place.x(), skin - kApart - tool_.reach, place.z());
    const std::int64_t lost_ms = kPress + restart.after_ms, back_ms = lost_ms + restart.silence_ms;
    Outcome outcome;
    for (std::int64_t ms = 0; ms < back_ms + kLook; ++ms) {
      now_ns_ = kBegin + ms * kMs;
      const double way = std::min(1.0, static_cast<double>(ms) / kPress);
      place_tool(from + way * (depth + kApart) * Vec3::UnitY());
      if (ms == lost_ms) {
        outcome.before = deformation_->world().force(0).norm();
        lose(restart.module);
      }
      if (ms == back_ms) come_back(restart);
      if (ms % 4 == 1 && collision_) collision_->cycle(cycle(ms));
      if (ms % 4 == 1) judge(ms >= back_ms ? ms - back_ms : -1, restart, outcome);
      if (ms % 4 != 3 || !deformation_) continue;
      cycle_deformation(ms, restart.keeps);
      outcome.last = deformation_->world().force(0).norm();
      if (ms >= back_ms) outcome.greatest = std::max(outcome.greatest, outcome.last);
    }
    return outcome;
  }

 private:
  runtime::Cycle cycle(std::int64_t ms) const { return {ms * kMs, now_ns_, true, false, 0.004}; }
  void cycle_deformation(std::int64_t ms, bool keeps) {
    runtime::Cycle now = cycle(ms);
    kept_->tell({}, now);
    deformation_->cycle(now);
    if (keeps) kept_->keep(*deformation_, {}, now_ns_);
  }
  void lose(const std::string& module) {
    if (module == "collision") collision_.reset();
    if (module == "deformation") deformation_.reset();
  }
  void make(const std::string& module) {
    if (module == "collision") {
      collision_ = std::make_unique<collision::CollisionStage>(
          scene_, collision::probes_of(scene_, {tool_.mesh}), collision_bus_);
    } else {
      deformation_ =
          std::make_unique<deformation::DeformationStage>(scene_, assets_.organs, deformation_bus_);
      kept_.emplace(memory_.descriptor(), "scene");
      kept_->give_back(*deformation_, now_ns_);
    }
  }
  void come_back(const Restart& restart) {
    collision_bus_.join(restart.joins, restart.module == "collision");
    deformation_bus_.join(restart.joins, restart.module == "deformation");
    make(restart.module);
  }
  void place_tool(const Vec3& at) {
    ProbeState state;
    state.header.source_time_ns = now_ns_;
    state.pose = {at, tool_.rotation};
    REQUIRE(probes_.write(state));
  }

  /// @param since_ms  of the restart; before it nothing is judged. A search on tissue of which
  ///                  nothing can have been heard is none.
  void judge(std::int64_t since_ms, const Restart& restart, Outcome& outcome) {
    bool any = false;
    while (contacts_.take(newest_)) any = true;
    if (!any || since_ms < 0) return;
    constexpr std::int64_t kPeriod = 4;
    const std::int64_t heard_ms =
        std::max(restart.joins.at("surface"), restart.joins.at("node_positions")) + 2 * kPeriod;
    if (restart.module == "deformation" && since_ms < heard_ms) return;
    ++outcome.searches;
    if (!is_inside()) return;
    ++outcome.inside;
    outcome.lost += !(newest_.deepest_gap() < 0);
  }
  bool is_inside() const {
    const auto& world = deformation_->world();
    const auto& model = world.model(0);
    const std::span<const Vec3> nodes = world.positions(0).first(model.surface_node_count);
    return std::ranges::any_of(tool_.inside, [&](const Vec3& p_P) {
      const Vec3 p = newest_.probe_pose.to_world(p_P);
      return geometry::winding_number(p, nodes, model.triangles) > 0.5;
    });
  }

  scene::Scene scene_;
  const session::Assets& assets_;
  const Tool& tool_;
  std::int64_t now_ns_ = kBegin - kMs;
  bus::MemoryBus bus_;
  LateBus collision_bus_{bus_}, deformation_bus_{bus_};
  bus::Writer<ProbeState> probes_ = bus_.writer(bus::kProbeState);
  bus::Reader<Contacts> contacts_ = bus_.reader(bus::kContacts);
  Contacts newest_;
  std::unique_ptr<collision::CollisionStage> collision_;
  std::unique_ptr<deformation::DeformationStage> deformation_;
  runtime::KeptMemory memory_;
  std::optional<runtime::KeptState> kept_;
};

}  // namespace

TEST_CASE(
    "late join: whatever a process that begins anew hears first, its first search holds the tool") {
  // Oracle: whether a surface that deformation made encloses a point of the tool's core is counted
  // by solid angles; then a contact has to push. The force that comes back is that from before.
  const auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  std::mt19937_64 random(1);
  const auto ms_below = [&](std::uint64_t end) {
    return static_cast<std::int64_t>(random() % end);
  };
  long inside = 0;
  for (const char* tool_name : {"ball", "needle"}) {
    const Tool tool = make_tool(tool_name, 0.008);
    for (const std::string module : {"collision", "deformation"}) {
      for (const double depth : {0.004, 0.014}) {
        for (int k = 0; k < 4; ++k) {
          Restart restart{module, 300 + ms_below(4), ms_below(150), {}};
          for (const char* topic : {"probe_state", "surface", "node_positions", "contacts"}) {
            restart.joins[topic] = ms_below(120);
          }
          CAPTURE(tool_name, module, depth, restart.silence_ms, restart.joins["probe_state"],
                  restart.joins["surface"], restart.joins["node_positions"],
                  restart.joins["contacts"]);
          const Outcome outcome = Session(scene, assets, tool).run(kPlace, depth, restart);
          CHECK(outcome.searches > 100);
          CHECK(outcome.lost == 0);
          inside += outcome.inside;
          if (tool_name != std::string("ball")) continue;
          CHECK(outcome.greatest < 1.1 * outcome.before);
          CHECK(outcome.last > 0.9 * outcome.before);
        }
      }
    }
  }
  CHECK(inside > 150);  // else nothing was tried
}

TEST_CASE("late join: the hand gets no blow from tissue, however long collision was away") {
  // Oracle: the force from before, which is what the same pose gives again. Tissue that was let go
  // when contacts were given up met the probe at a speed: 3 to 5 times the force.
  auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  scene.organs[0].tissue.youngs_modulus = 30e3;
  const session::Assets assets = session::load_assets(scene);
  const Tool tool = make_tool("ball", 0.008);
  const Vec3 place(0.008, 0, -0.049);
  for (const double depth : {0.002, 0.016}) {
    for (const std::int64_t silence : {40, 52, 56, 60, 64, 100, 400}) {
      const Restart restart{
          "collision",
          300,
          silence,
          {{"probe_state", 0}, {"surface", 0}, {"node_positions", 0}, {"contacts", 0}}};
      const Outcome outcome = Session(scene, assets, tool).run(place, depth, restart);
      CAPTURE(depth, silence, outcome.before, outcome.greatest, outcome.last);
      CHECK(outcome.greatest < 1.1 * outcome.before);
      CHECK(outcome.last > 0.9 * outcome.before);
    }
  }
}

TEST_CASE("late join: a deformation that goes on from what was kept swings no tool's tissue") {
  // Oracle: solid angles and the force from before, as above.
  const auto scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  std::mt19937_64 random(2);
  const auto ms_below = [&](std::uint64_t end) {
    return static_cast<std::int64_t>(random() % end);
  };
  for (const char* tool_name : {"ball", "needle", "rod", "wire"}) {
    const Tool tool = make_tool(tool_name, 0.008);
    for (const double depth : {0.004, 0.014}) {
      for (int k = 0; k < 2; ++k) {
        Restart restart{"deformation", 1500 + ms_below(4), ms_below(600), {}, true};
        for (const char* topic : {"probe_state", "surface", "node_positions", "contacts"}) {
          restart.joins[topic] = ms_below(120);
        }
        CAPTURE(tool_name, depth, restart.silence_ms, restart.joins["probe_state"],
                restart.joins["surface"], restart.joins["node_positions"],
                restart.joins["contacts"]);
        const Outcome outcome = Session(scene, assets, tool).run(kPlace, depth, restart);
        CAPTURE(outcome.before, outcome.greatest, outcome.last);
        CHECK(outcome.searches > 100);
        CHECK(outcome.lost == 0);
        CHECK(outcome.greatest < 1.1 * outcome.before);
        CHECK(outcome.last > 0.9 * outcome.before);
      }
    }
  }
}

}  // namespace palpate::contact_loop
