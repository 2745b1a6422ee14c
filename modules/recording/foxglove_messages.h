// Messages that Foxglove's panels know (https://docs.foxglove.dev/docs/sdk/schemas), as CDR, and
// the IDL of each: pictures of a session for whoever has no program of ours.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/core/types.h"

namespace palpate::recording::foxglove {

using Payload = std::vector<std::uint8_t>;

/// The types that recordings are translated to.
inline constexpr std::string_view kPose = "foxglove::PoseInFrame";
inline constexpr std::string_view kTransform = "foxglove::FrameTransform";
inline constexpr std::string_view kScene = "foxglove::SceneUpdate";
inline constexpr std::string_view kWrench = "palpate::plot::Wrench";  ///< Foxglove has none
inline constexpr std::array kTypes{kPose, kTransform, kScene, kWrench};

/// IDL of one of them, with all types it is made of.
std::string idl_of(std::string_view type);

struct Color {
  double r = 1, g = 1, b = 1, a = 1;
};
/// From its pose's origin along its x.
struct Arrow {
  Pose pose;
  double shaft_length = 0, shaft_diameter = 0;  ///< [m]
  double head_length = 0, head_diameter = 0;    ///< [m]
  Color color;
};
struct Triangles {
  std::vector<Vec3> points;                          ///< [m]
  std::vector<std::array<std::uint32_t, 3>> places;  ///< in `points`, three each
  Color color;
};
/// Something to be seen. It takes the place of what had its id.
struct Entity {
  std::string frame, id;
  bool follows_frame = false;  ///< else it stays where its frame was
  std::vector<std::pair<std::string, std::string>> metadata;
  std::vector<Arrow> arrows;
  std::vector<Triangles> triangles;
};

Payload pose_in_frame(std::uint64_t time_ns, std::string_view frame, const Pose& pose);
Payload frame_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                        const Pose& pose);
Payload scene_update(std::uint64_t time_ns, const Entity& entity);
Payload wrench(std::uint64_t time_ns, std::string_view frame, const Vec3& force,
               const Vec3& torque);

}  // namespace palpate::recording::foxglove
