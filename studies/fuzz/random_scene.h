// A random scene, with what is done to its messages, from two numbers alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modules/scene/scene.h"
#include "studies/fuzz/shape_store.h"

namespace palpate::fuzz {

/// What happens to messages on their way, or to a device.
enum class Fault : std::uint8_t {
  kPoseNotANumber,
  kPoseInfinite,
  kPoseDenormal,
  kPoseHuge,
  kRotationZero,
  kGapNotANumber,
  kNormalNotANumber,
  kNormalDenormal,
  kPointInfinite,
  kPointHuge,
  kGapHuge,
  kUnknownOrgan,
  kUnknownTriangle,
  kUnknownProbe,
  kManyContacts,
  kModelNotANumber,
  kModelHuge,
  kDeviceNotANumber,
  kLost,
  kLate,
  kTwice
};
inline constexpr std::size_t kFaultCount = 21;
const char* name_of(Fault fault);

struct TimedFault {
  Fault fault = Fault::kPoseNotANumber;
  std::uint32_t probe = 0;
  double time = 0;  ///< simulated [s]
};

struct RandomScene {
  scene::Scene scene;
  std::vector<PlacedShape> organ_shapes;  ///< one per organ
  std::vector<PlacedShape> probe_shapes;  ///< one per probe; used where its shape names a mesh
  std::vector<TimedFault> faults;
};

/// @param number  k: scenes of one seed differ by it alone
RandomScene random_scene(std::uint64_t seed, std::uint64_t number);

/// YAML, the shapes and faults as comments: all there is.
std::string text_of(const RandomScene& scene);

}  // namespace palpate::fuzz
