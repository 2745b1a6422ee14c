#include "modules/recording/foxglove_messages.h"

#include <bit>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/recording/mcap_bytes.h"

namespace palpate::recording::foxglove {
namespace {

// Types in the order in which they need each other. Names and fields are Foxglove's: it looks for
// them.
constexpr std::string_view kBasics = R"(
  struct Time { uint32 sec; uint32 nsec; };
  struct Vector3 { double x; double y; double z; };
  struct Quaternion { double x; double y; double z; double w; };
  struct Pose { Vector3 position; Quaternion orientation; };
)";

constexpr std::string_view kPoseIdl = R"(
  struct PoseInFrame { Time timestamp; string frame_id; Pose pose; };
)";

constexpr std::string_view kTransformIdl = R"(
  struct FrameTransform {
    Time timestamp;
    string parent_frame_id;
    string child_frame_id;
    Vector3 translation;
    Quaternion rotation;
  };
)";

constexpr std::string_view kSceneIdl = R"(
  struct Duration { int32 sec; uint32 nsec; };
  struct Point3 { double x; double y; double z; };
  struct Color { double r; double g; double b; double a; };
  struct KeyValuePair { string key; string value; };
  enum SceneEntityDeletionType { MATCHING_ID, ALL };
  struct SceneEntityDeletion { Time timestamp; SceneEntityDeletionType type; string id; };
  struct ArrowPrimitive {
    Pose pose;
    double shaft_length;
    double shaft_diameter;
    double head_length;
    double head_diameter;
    Color color;
  };
  struct CubePrimitive { Pose pose; Vector3 size; Color color; };
  struct SpherePrimitive { Pose pose; Vector3 size; Color color; };
  struct CylinderPrimitive {
    Pose pose;
    Vector3 size;
    double bottom_scale;
    double top_scale;
    Color color;
  };
  enum LineType { LINE_STRIP, LINE_LOOP, LINE_LIST };
  struct LinePrimitive {
    LineType type;
    Pose pose;
    double thickness;
    boolean scale_invariant;
    sequence<Point3> points;
    Color color;
    sequence<Color> colors;
    sequence<uint32> indices;
  };
  struct TriangleListPrimitive {
    Pose pose;
    sequence<Point3> points;
    Color color;
    sequence<Color> colors;
    sequence<uint32> indices;
  };
  struct TextPrimitive {
    Pose pose;
    boolean billboard;
    double font_size;
    boolean scale_invariant;
    Color color;
    string text;
  };
  struct ModelPrimitive {
    Pose pose;
    Vector3 scale;
    Color color;
    boolean override_color;
    string url;
    string media_type;
    sequence<uint8> data;
  };
  struct SceneEntity {
    Time timestamp;
    string frame_id;
    string id;
    Duration lifetime;
    boolean frame_locked;
    sequence<KeyValuePair> metadata;
    sequence<ArrowPrimitive> arrows;
    sequence<CubePrimitive> cubes;
    sequence<SpherePrimitive> spheres;
    sequence<CylinderPrimitive> cylinders;
    sequence<LinePrimitive> lines;
    sequence<TriangleListPrimitive> triangles;
    sequence<TextPrimitive> texts;
    sequence<ModelPrimitive> models;
  };
  struct SceneUpdate { sequence<SceneEntityDeletion> deletions; sequence<SceneEntity> entities; };
)";

constexpr std::string_view kWrenchIdl = R"(
module palpate { module plot {
  struct Wrench {
    foxglove::Time timestamp;
    string frame_id;
    foxglove::Vector3 force_n;
    foxglove::Vector3 torque_n_m;
    double force_size_n;
  };
}; };
)";

std::string foxglove_module(std::string_view types) {
  return "module foxglove {" + std::string(kBasics) + std::string(types) + "};\n";
}

// Plain CDR: every number lies at a multiple of its size, counted from behind the encapsulation.
class Cdr {
 public:
  Cdr() : bytes_{0, 1, 0, 0}, out_(bytes_) {}

  void flag(bool value) { out_.u8(value ? 1 : 0); }
  void u32(std::uint32_t value) {
    align(4);
    out_.u32(value);
  }
  void count(std::size_t value) { u32(static_cast<std::uint32_t>(value)); }
  void real(double value) {
    align(8);
    out_.u64(std::bit_cast<std::uint64_t>(value));
  }
  void text(std::string_view value) {
    align(4);
    out_.u32(static_cast<std::uint32_t>(value.size() + 1));
    out_.raw({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
    out_.u8(0);
  }
  void time(std::uint64_t ns) {
    u32(static_cast<std::uint32_t>(ns / std::uint64_t(kNanosecondsPerSecond)));
    u32(static_cast<std::uint32_t>(ns % std::uint64_t(kNanosecondsPerSecond)));
  }
  void vector(const Vec3& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  }
  void rotation(const Quat& q) {
    for (int i = 0; i < 4; ++i) real(q.coeffs()[i]);  // x, y, z, w
  }
  void pose(const Pose& pose) {
    vector(pose.position);
    rotation(pose.rotation);
  }
  void color(const Color& color) {
    for (const double part : {color.r, color.g, color.b, color.a}) real(part);
  }
  Payload take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kEncapsulation = 4;
  void align(std::size_t size) {
    bytes_.resize(kEncapsulation + (bytes_.size() - kEncapsulation + size - 1) / size * size);
  }

  Payload bytes_;
  ByteWriter out_;
};

void put(Cdr& cdr, const Arrow& arrow) {
  cdr.pose(arrow.pose);
  cdr.real(arrow.shaft_length);
  cdr.real(arrow.shaft_diameter);
  cdr.real(arrow.head_length);
  cdr.real(arrow.head_diameter);
  cdr.color(arrow.color);
}

void put(Cdr& cdr, const Triangles& triangles) {
  cdr.pose(Pose{});
  cdr.count(triangles.points.size());
  for (const Vec3& point : triangles.points) cdr.vector(point);
  cdr.color(triangles.color);
  cdr.count(0);  // colours of points
  cdr.count(3 * triangles.places.size());
  for (const auto& places : triangles.places) {
    for (const std::uint32_t place : places) cdr.u32(place);
  }
}

void put(Cdr& cdr, std::uint64_t time_ns, const Entity& entity) {
  cdr.time(time_ns);
  cdr.text(entity.frame);
  cdr.text(entity.id);
  cdr.time(0);  // lifetime: until it is replaced
  cdr.flag(entity.follows_frame);
  cdr.count(entity.metadata.size());
  for (const auto& [key, value] : entity.metadata) cdr.text(key), cdr.text(value);
  cdr.count(entity.arrows.size());
  for (const Arrow& arrow : entity.arrows) put(cdr, arrow);
  for (int kind = 0; kind < 4; ++kind) cdr.count(0);  // cubes, spheres, cylinders, lines
  cdr.count(entity.triangles.size());
  for (const Triangles& triangles : entity.triangles) put(cdr, triangles);
  for (int kind = 0; kind < 2; ++kind) cdr.count(0);  // texts, models
}

}  // namespace

std::string idl_of(std::string_view type) {
  if (type == kPose) return foxglove_module(kPoseIdl);
  if (type == kTransform) return foxglove_module(kTransformIdl);
  if (type == kScene) return foxglove_module(kSceneIdl);
  PALPATE_DEMAND(type == kWrench);
  return foxglove_module("") + std::string(kWrenchIdl);
}

Payload pose_in_frame(std::uint64_t time_ns, std::string_view frame, const Pose& pose) {
  Cdr cdr;
  cdr.time(time_ns);
  cdr.text(frame);
  cdr.pose(pose);
  return cdr.take();
}

Payload frame_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                        const Pose& pose) {
  Cdr cdr;
  cdr.time(time_ns);
  cdr.text(parent);
  cdr.text(child);
  cdr.pose(pose);
  return cdr.take();
}

Payload scene_update(std::uint64_t time_ns, const Entity& entity) {
  Cdr cdr;
  cdr.count(0);  // deletions
  cdr.count(1);
  put(cdr, time_ns, entity);
  return cdr.take();
}

Payload wrench(std::uint64_t time_ns, std::string_view frame, const Vec3& force,
               const Vec3& torque) {
  Cdr cdr;
  cdr.time(time_ns);
  cdr.text(frame);
  cdr.vector(force);
  cdr.vector(torque);
  cdr.real(force.norm());
  return cdr.take();
}

}  // namespace palpate::recording::foxglove
