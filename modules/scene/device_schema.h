// The schema's part of devices: every key of what moves a probe (schema.h tells how it is read).
#pragma once

#include <array>
#include <optional>

#include "modules/scene/about.h"
#include "modules/scene/motion_file.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

template <>
struct Words<EmulatedDevice::Kind> {
  static constexpr std::array texts{"touch", "omega"};
};

template <>
struct Words<TrajectoryDevice::TimeUnit> {
  static constexpr std::array texts{"s", "ms", "us", "ns"};
};
template <>
struct Words<TrajectoryDevice::QuaternionOrder> {
  static constexpr std::array texts{"xyzw", "wxyz"};
};

template <class V>
void describe(V& v, TrajectoryDevice& device) {
  v.field(
      "file", device.file,
      plain("a table (CSV, text) with a header, or a bag of ROS 1 (.bag) or 2 (.mcap)").needed());
  v.field("columns", device.columns,
          plain("of a table, as its header names them or numbers from 1: time, x, y, z and the "
                "four of the quaternion, or the first four alone")
              .otherwise("t, x, y, z, qx, qy, qz, qw, in any order, among others"));
  v.field("time_unit", device.time_unit, plain("of a table's times"));
  About unit = plain("of positions: m, dm, cm, mm, um or in");
  unit.is_length_unit = true;
  v.field("length_unit", device.length_unit, unit);
  v.field("quaternion", device.quaternion, plain("order of the quaternion's four columns"));
  v.field("topic", device.topic,
          plain("of a bag: geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped "
                "or PointStamped")
              .otherwise("the only one of these"));
  v.require(device.columns.empty() || device.columns.size() == 4 || device.columns.size() == 8,
            "columns must name 4 (time, x, y, z) or 8 (and the quaternion)");
  using Default = TrajectoryDevice;
  const bool of_table = !device.columns.empty() || device.time_unit != Default{}.time_unit ||
                        device.quaternion != Default{}.quaternion;
  const bool is_bag = motion_file_of(device.file) != MotionFile::kTable;
  v.require(!is_bag || !of_table,
            "columns, time_unit and quaternion are of tables; a bag's messages need none");
  v.require(is_bag || !device.topic, "topic is of bags (.bag, .mcap)");
  describe_pose(v, device.offset, "where the recording's origin is in W",
                "unit quaternion, of the recording's frame");
  v.field("loop", device.loop, plain("start again at the end; else hold the last pose"));
}

/// Either `to_m` and `duration_s`, or `wait_s`.
template <class V>
void describe(V& v, ScriptedDevice::Move& move) {
  std::optional<double> duration, wait;
  (move.to ? duration : wait) = move.duration;
  v.field("to_m", move.to, point("where the move ends").otherwise("a wait"));
  v.field("duration_s", duration,
          ranged("s", 1e-3, 3600, "of the move; highest speed is 1.875 × distance / duration")
              .otherwise("a wait"));
  v.field("wait_s", wait, ranged("s", 1e-3, 3600, "stay where it is").otherwise("a move"));
  v.require(move.to ? duration && !wait : wait && !duration,
            "must hold either to_m and duration_s, or wait_s alone");
  move.duration = duration ? *duration : wait.value_or(move.duration);
}

template <class V>
void describe(V& v, ScriptedDevice& device) {
  v.field("start_m", device.start, point("where it starts").needed());
  v.field("rotation_xyzw", device.rotation, plain("unit quaternion, kept throughout"));
  v.field("moves", device.moves,
          plain("minimum-jerk moves, one after the other; ends holding the last point").needed());
}

template <class V>
void describe(V& v, TopicDevice& device) {
  v.field("start_m", device.start, point("where it is until the first sample").needed());
  v.field("rotation_xyzw", device.rotation, plain("unit quaternion until the first sample"));
}

template <class V>
void describe(V& v, MouseDevice& device) {
  v.field("start_m", device.start, point("where it is until it is first dragged").needed());
  v.field("rotation_xyzw", device.rotation, plain("unit quaternion until it is first dragged"));
}

template <class V>
void describe(V& v, EmulatedDevice::Hand& hand) {
  v.field("mass_kg", hand.mass, ranged("kg", 0, 5, "moves along with the device"));
  v.field("damping_n_s_per_m", hand.damping, ranged("N·s/m", 0, 100, "to its target's velocity"));
  v.field("stiffness_n_per_m", hand.stiffness, ranged("N/m", 0, 5000, "to its target"));
  v.field("push_n", hand.push, ranged("N", -100, 100, "constant force on the device, in W"));
  v.field("moves", hand.moves, plain("minimum-jerk moves of its target, which begins at start_m"));
}

template <class V>
void describe(V& v, EmulatedDevice& device) {
  v.field("kind", device.kind, plain("whose sizes it has where they are not given"));
  v.field("start_m", device.start, point("where it starts").needed());
  v.field("rotation_xyzw", device.rotation, plain("unit quaternion, kept throughout"));
  v.field("axis", device.axis,
          ranged("", -1, 1, "in W: moves along it only, as on a rail").otherwise("moves freely"));
  v.require(!device.axis || device.axis->norm() > 0.1, "axis must be a direction");
  v.field("mass_kg", device.mass,
          ranged("kg", 0.01, 10, "at the grip").otherwise("0.1 of a touch, 0.2 of an omega"));
  v.field("damping_n_s_per_m", device.damping,
          ranged("N·s/m", 0, 100, "of the device itself").otherwise("0.2"));
  v.field("max_force_n", device.max_force,
          ranged("N", 0.1, 100, "of its motors").otherwise("3.3 of a touch, 12 of an omega"));
  v.field("encoder_step_m", device.encoder_step,
          ranged("m", 0, 0.01, "in which positions are read; 0 = exact")
              .otherwise("55e-6 of a touch, 1e-5 of an omega"));
  v.field("rate_hz", device.rate, ranged("Hz", 100, 10000, "of its own loop"));
  v.field("transport_delay_s", device.transport_delay,
          ranged("s", 0, 0.1, "of poses and of forces, each; in whole periods of its loop"));
  v.field("hand", device.hand, plain("what holds it"));
}

template <class V>
void describe(V& v, Device& device) {
  v.template option<ScriptedDevice>("scripted", device, plain("moves written in the scene"));
  v.template option<TrajectoryDevice>("trajectory", device, plain("a recorded pose over time"));
  v.template option<TopicDevice>("topic", device,
                                 plain("a real one: its driver writes topic probe_input"));
  v.template option<MouseDevice>("mouse", device,
                                 plain("dragged in the live window, followed smoothly"));
  v.template option<EmulatedDevice>("emulated", device,
                                    plain("a haptic device and a hand, by numbers"));
}

}  // namespace palpate::scene
