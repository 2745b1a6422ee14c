#include "modules/trajectories/ros_message.h"

#include <array>
#include <bit>
#include <cstring>

namespace palpate::trajectories {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kEncapsulation = 4;  // bytes before the first value of CDR

struct Layout {
  std::string_view name;
  bool child_frame, rotation;
};
constexpr std::array kLayouts{
    Layout{"PoseStamped", false, true}, Layout{"PoseWithCovarianceStamped", false, true},
    Layout{"TransformStamped", true, true}, Layout{"PointStamped", false, false}};

const Layout* layout_of(std::string_view type) {
  for (const std::string_view package : {"geometry_msgs/msg/", "geometry_msgs/"}) {
    if (!type.starts_with(package)) continue;
    for (const Layout& layout : kLayouts) {
      if (type.substr(package.size()) == layout.name) return &layout;
    }
  }
  return nullptr;
}

/// Values in order; after one that does not fit, none does.
class Values {
 public:
  Values(RosEncoding encoding, std::span<const std::uint8_t> bytes)
      : aligned_(encoding == RosEncoding::kCdr), bytes_(bytes) {}

  template <class T>
  T next() {
    if (aligned_) at_ += (sizeof(T) - at_ % sizeof(T)) % sizeof(T);
    T value{};
    fits_ = fits_ && at_ + sizeof(T) <= bytes_.size();
    if (!fits_) return value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// Without the zero that ends it in CDR.
  std::string_view text() {
    const auto size = next<std::uint32_t>();
    fits_ = fits_ && size <= bytes_.size() - at_;
    if (!fits_) return {};
    const std::string_view text(reinterpret_cast<const char*>(bytes_.data()) + at_, size);
    at_ += size;
    return text.substr(0, text.find('\0'));
  }
  bool fits() const { return fits_; }

 private:
  bool aligned_;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool fits_ = true;
};

}  // namespace

bool is_pose_type(std::string_view type) { return layout_of(type) != nullptr; }

std::string decode_pose(std::string_view type, RosEncoding encoding,
                        std::span<const std::uint8_t> bytes, StampedPose& out) {
  const Layout& layout = *layout_of(type);
  if (encoding == RosEncoding::kCdr) {
    if (bytes.size() < kEncapsulation) return "is shorter than its type";
    if (bytes[0] != 0 || bytes[1] != 1) return "is not little-endian CDR";
    bytes = bytes.subspan(kEncapsulation);
  }
  Values values(encoding, bytes);
  if (encoding == RosEncoding::kRos1) values.next<std::uint32_t>();  // seq
  out.seconds = encoding == RosEncoding::kRos1 ? std::int64_t{values.next<std::uint32_t>()}
                                               : std::int64_t{values.next<std::int32_t>()};
  out.nanoseconds = values.next<std::uint32_t>();
  out.frame = values.text();
  out.child_frame = layout.child_frame ? values.text() : std::string_view();
  out.pose = {};
  for (double& x : out.pose.position) x = values.next<double>();
  if (layout.rotation) {
    for (double& x : out.pose.rotation.coeffs()) x = values.next<double>();
  }
  if (!values.fits()) return "is shorter than its type";
  if (out.seconds == 0 && out.nanoseconds == 0) return "its header has no stamp";
  return {};
}

}  // namespace palpate::trajectories
