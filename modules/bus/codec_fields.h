// Field translations shared by the codecs.
#pragma once

#include <algorithm>
#include <array>

#include "modules/messages/messages.h"

namespace palpate::bus {

template <class Wire>
void encode_header(const Header& header, Wire& wire) {
  wire.sequence_number(header.sequence);
  wire.sim_time_ns(header.sim_time_ns);
  wire.source_time_ns(header.source_time_ns);
}

template <class Wire>
Header decode_header(const Wire& wire) {
  return {wire.sequence_number(), wire.sim_time_ns(), wire.source_time_ns()};
}

inline std::array<double, 3> to_array(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 to_vec3(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

inline std::array<double, 4> to_xyzw(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline Quat to_quat(const std::array<double, 4>& a) { return {a[3], a[0], a[1], a[2]}; }

}  // namespace palpate::bus
