// What the emulated device tells of itself: a line a second, a table if wanted, a line at the end.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "palpate/device/swing.h"

namespace palpate::launcher {

/// The first line of its table.
inline constexpr const char* kDeviceTable = "source_time_ns,time_s,x_m,y_m,z_m,fx_n,fy_n,fz_n\n";

class DeviceLog {
 public:
  /// A device that stays within a box of this diagonal is said to rest [m].
  static constexpr double kRest = 1e-4;

  /// @param lines  receives the line of each second
  /// @param table  receives CSV rows, below the first line: source time, time, position, force of
  /// the motors; or nullptr
  DeviceLog(std::ostream& lines, std::ostream* table);

  /// @param time      since the hand took the device [s]
  /// @param position  of the body [m]
  /// @param force     of the motors [N]
  void add(std::int64_t now_ns, double time, const Vec3& position, const Vec3& force);

  /// "12.0 s at … mm, force 0.15 N (at most 0.31 N), within 0.1 mm since 1.4 s"
  std::string summary() const;

 private:
  std::ostream& lines_;
  std::ostream* table_;
  Swing swing_;
  double time_ = 0, next_line_ = 1;  ///< [s]
  Vec3 position_ = Vec3::Zero(), force_ = Vec3::Zero();
  double largest_force_ = 0, largest_swing_ = 0;
};

}  // namespace palpate::launcher
