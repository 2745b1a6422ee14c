#include "modules/recording/foxglove_export.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <map>

#include "modules/core/error.h"
#include "modules/core/rotation_vector.h"
#include "modules/core/text.h"
#include "modules/core/whole_file.h"
#include "modules/recording/foxglove_messages.h"
#include "modules/recording/idl_text.h"
#include "modules/recording/mcap_writer.h"
#include "modules/recording/recorder.h"
#include "modules/recording/sample_reader.h"
#include "modules/scene/assets.h"
#include "modules/scene/probe_shape.h"
#include "modules/scene/scene_reader.h"

namespace palpate::recording {
namespace {

constexpr const char* kWorld = "world";
constexpr double kPatchOfPlane = 0.5;      // side of what stands for a half-space [m]
constexpr double kShaft = 0.002;           // thickness of arrows [m]
constexpr double kShortestArrow = 0.0005;  // [m]

constexpr std::array<foxglove::Color, 4> kOrganColors{
    {{0.80, 0.45, 0.40, 1}, {0.75, 0.60, 0.45, 1}, {0.60, 0.45, 0.60, 1}, {0.50, 0.60, 0.70, 1}}};
constexpr foxglove::Color kProbeColor{0.75, 0.78, 0.80, 1};
constexpr foxglove::Color kPlaneColor{0.75, 0.78, 0.80, 0.35};
constexpr foxglove::Color kForceColor{0.95, 0.75, 0.10, 1};

std::string frame_of(std::uint32_t probe) { return fmt::format("probe_{}", probe); }

foxglove::Entity entity_of(const SurfaceTopology& surface, const NodePositions& nodes) {
  foxglove::Triangles triangles;
  for (std::size_t i = 0; i < surface.surface_node_count; ++i) {
    const float* x = nodes.positions.data() + 3 * i;
    triangles.points.emplace_back(x[0], x[1], x[2]);
  }
  triangles.places = surface.triangles;
  triangles.color = kOrganColors[surface.organ % kOrganColors.size()];
  return {.frame = kWorld,
          .id = fmt::format("organ_{}", surface.organ),
          .follows_frame = false,
          .metadata = {{"name", surface.name}},
          .arrows = {},
          .triangles = {std::move(triangles)}};
}

foxglove::Entity entity_of(const scene::Probe& probe, std::uint32_t index) {
  const auto form = scene::form_of(probe.shape, scene::load_probe_mesh(probe));
  const auto surface = geometry::surface_of(form, kPatchOfPlane);
  const bool plane = std::holds_alternative<geometry::HalfSpace>(form);
  return {.frame = frame_of(index),
          .id = frame_of(index),
          .follows_frame = true,
          .metadata = {{"name", probe.name}},
          .arrows = {},
          .triangles = {{surface.nodes, surface.triangles, plane ? kPlaneColor : kProbeColor}}};
}

foxglove::Entity entity_of(const HapticForce& force, const Vec3& origin) {
  foxglove::Entity entity{
      .frame = kWorld,
      .id = fmt::format("force_{}", force.probe),
      .follows_frame = false,
      .metadata = {{"metres_per_newton", fmt::format("{}", kFoxgloveMetresPerNewton)}},
      .arrows = {},
      .triangles = {}};
  const double length = kFoxgloveMetresPerNewton * force.force.norm();
  if (length < kShortestArrow) return entity;  // what was there goes
  const double head = std::min(2 * kShaft, length / 2);
  const Quat along = rotation_between(Vec3::UnitX(), force.force);
  entity.arrows.push_back({{origin, along}, length - head, kShaft, head, 2 * kShaft, kForceColor});
  return entity;
}

class Export {
 public:
  Export(const std::filesystem::path& file, const std::filesystem::path& named)
      : writer_(file, named) {}

  void begin(const McapMap& session) {
    if (!session.empty()) writer_.add_metadata({kSessionMetadata, session});
  }

  void add(const RecordedSample& sample, const McapMap& about_channel) {
    copy(sample, about_channel);
    messages::AnyMessage message;
    if (sample.topic->type->decode(sample.payload, message) != nullptr) return;
    const std::uint64_t time_ns = sample.log_time_ns;
    const std::string_view topic = sample.topic->name;
    if (topic == bus::kScene.name) add_shapes(time_ns, std::get<SceneDescription>(message));
    if (topic == bus::kSurface.name) take(std::get<SurfaceTopology>(message));
    if (topic == bus::kNodePositions.name) add(time_ns, std::get<NodePositions>(message));
    if (topic == bus::kProbeState.name) add(time_ns, std::get<ProbeState>(message));
    if (topic == bus::kHapticForce.name) add(time_ns, std::get<HapticForce>(message));
  }

  FoxgloveReport close(const McapMap& scene) {
    if (!scene.empty()) writer_.add_metadata({kSceneMetadata, scene});
    writer_.close();
    report_.translations = writer_.statistics().message_count - report_.samples;
    return std::move(report_);
  }

 private:
  void copy(const RecordedSample& sample, const McapMap& about_channel) {
    auto channel = copies_.find(sample.channel);
    if (channel == copies_.end()) {
      const auto& type = *sample.topic->type;
      const std::uint16_t id = add_channel(sample.topic->name, type.wire_name,
                                           std::string(idl_text_of(type)), about_channel);
      channel = copies_.emplace(sample.channel, id).first;
    }
    const Header header = messages::header_of(sample.payload);
    writer_.add_message({.channel_id = channel->second,
                         .sequence = static_cast<std::uint32_t>(header.sequence),
                         .log_time_ns = sample.log_time_ns,
                         .publish_time_ns = sample.publish_time_ns,
                         .data = {}},
                        sample.payload);
    ++report_.samples;
  }

  void put(const std::string& topic, std::string_view type, std::uint64_t time_ns,
           const foxglove::Payload& payload) {
    Translation& to = translations_[topic];
    if (to.channel == 0) to.channel = add_channel(topic, type, foxglove::idl_of(type), {});
    writer_.add_message({.channel_id = to.channel,
                         .sequence = ++to.count,
                         .log_time_ns = time_ns,
                         .publish_time_ns = time_ns,
                         .data = {}},
                        payload);
  }

  std::uint16_t add_channel(std::string_view topic, std::string_view type, std::string idl,
                            const McapMap& about) {
    auto schema = schemas_.find(type);
    if (schema == schemas_.end()) {
      const auto id = writer_.add_schema({0, std::string(type), "omgidl", std::move(idl)});
      schema = schemas_.emplace(type, id).first;
    }
    return writer_.add_channel({0, schema->second, std::string(topic), "cdr", about});
  }

  /// Of what is looked at, the first in each period.
  bool is_due(const std::string& topic, std::uint64_t time_ns) {
    const auto period = std::int64_t(1e-9 * double(time_ns) * kFoxglovePictureHz);
    const auto [newest, first] = newest_period_.try_emplace(topic, period);
    if (!first && newest->second == period) return false;
    newest->second = period;
    return true;
  }

  void add_shapes(std::uint64_t time_ns, const SceneDescription& description) {
    std::uint32_t index = 0;
    try {
      const auto scene = scene::parse_scene(description.resolved_text, "recorded scene");
      for (const auto& probe : scene.probes) {
        const auto entity = entity_of(probe, index++);
        put("/" + entity.frame + "/shape", foxglove::kScene, time_ns,
            foxglove::scene_update(time_ns, entity));
      }
    } catch (const InputError& error) {
      report_.warnings.push_back(fmt::format("the shape of {} is not shown: {}", frame_of(index),
                                             printable(error.what())));
    }
  }

  void take(const SurfaceTopology& surface) { surfaces_[surface.organ] = surface; }

  void add(std::uint64_t time_ns, const NodePositions& nodes) {
    const auto surface = surfaces_.find(nodes.organ);
    if (surface == surfaces_.end() || surface->second.generation != nodes.generation) return;
    if (nodes.positions.size() < 3 * std::size_t{surface->second.surface_node_count}) return;
    const std::string topic = fmt::format("/organ_{}/surface", nodes.organ);
    if (!is_due(topic, time_ns)) return;
    put(topic, foxglove::kScene, time_ns,
        foxglove::scene_update(time_ns, entity_of(surface->second, nodes)));
  }

  void add(std::uint64_t time_ns, const ProbeState& probe) {
    const std::string frame = frame_of(probe.probe);
    origins_[probe.probe] = probe.pose.position;
    put("/" + frame + "/pose", foxglove::kPose, time_ns,
        foxglove::pose_in_frame(time_ns, kWorld, probe.pose));
    if (!is_due(frame, time_ns)) return;
    put("/tf", foxglove::kTransform, time_ns,
        foxglove::frame_transform(time_ns, kWorld, frame, probe.pose));
  }

  void add(std::uint64_t time_ns, const HapticForce& force) {
    const std::string topic = "/" + frame_of(force.probe);
    put(topic + "/wrench", foxglove::kWrench, time_ns,
        foxglove::wrench(time_ns, kWorld, force.force, force.torque));
    const auto origin = origins_.find(force.probe);
    if (origin == origins_.end() || !is_due(topic + "/force", time_ns)) return;
    put(topic + "/force", foxglove::kScene, time_ns,
        foxglove::scene_update(time_ns, entity_of(force, origin->second)));
  }

  struct Translation {
    std::uint16_t channel = 0;
    std::uint32_t count = 0;
  };

  McapWriter writer_;
  FoxgloveReport report_;
  std::map<std::string, std::uint16_t, std::less<>> schemas_;  ///< by type
  std::map<std::uint32_t, std::uint16_t> copies_;              ///< channels, there → here
  std::map<std::string, Translation> translations_;            ///< by topic
  std::map<std::string, std::int64_t> newest_period_;
  std::map<std::uint32_t, SurfaceTopology> surfaces_;  ///< by organ
  std::map<std::uint32_t, Vec3> origins_;              ///< by probe
};

}  // namespace

FoxgloveReport export_to_foxglove(const std::filesystem::path& recording,
                                  const std::filesystem::path& file) {
  SampleReader reader(recording);
  auto sample = reader.next();  // what is no recording leaves no file
  check_recording_target(file);
  if (std::filesystem::exists(file)) {
    throw InputError(file.string() + ": is there already; a translation replaces nothing");
  }
  FileInTheMaking making(file);
  Export translation(making.part(), file);
  translation.begin(reader.metadata(kSessionMetadata));
  for (; sample; sample = reader.next()) {
    translation.add(*sample, reader.about_channel(sample->channel));
  }
  FoxgloveReport report = translation.close(reader.metadata(kSceneMetadata));
  making.finish();
  for (std::string& line : reader.warnings()) report.warnings.push_back(std::move(line));
  return report;
}

}  // namespace palpate::recording
