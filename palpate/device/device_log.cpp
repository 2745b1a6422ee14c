#include "palpate/device/device_log.h"

#include <algorithm>
#include <cstdio>
#include <ostream>

namespace palpate::launcher {
namespace {

constexpr double kMm = 1e3;

/// "at -60.00 -64.00 -93.00 mm, force 0.150 N"
std::string place_and_force(const Vec3& position, const Vec3& force) {
  const Vec3 mm = kMm * position;
  char text[120];
  std::snprintf(text, sizeof text, "at %.2f %.2f %.2f mm, force %.3f N", mm.x(), mm.y(), mm.z(),
                force.norm());
  return text;
}

}  // namespace

DeviceLog::DeviceLog(std::ostream& lines, std::ostream* table) : lines_(lines), table_(table) {
  if (table_) table_->precision(9);
}

void DeviceLog::add(std::int64_t now_ns, double time, const Vec3& position, const Vec3& force) {
  time_ = time;
  position_ = position;
  force_ = force;
  largest_force_ = std::max(largest_force_, force.norm());
  swing_.add(time, position);
  if (table_) {
    *table_ << now_ns << ',' << time << ',' << position.x() << ',' << position.y() << ','
            << position.z() << ',' << force.x() << ',' << force.y() << ',' << force.z() << '\n';
  }
  if (time < next_line_) return;
  next_line_ += 1;
  const double swing = swing_.last_second();
  largest_swing_ = std::max(largest_swing_, swing);
  char text[60];
  std::snprintf(text, sizeof text, ", swing %.3f mm, at most %.3f mm", kMm * swing,
                kMm * largest_swing_);
  char second[20];
  std::snprintf(second, sizeof second, "%6.1f s  ", time);
  lines_ << second << place_and_force(position, force) << text << std::endl;
}

std::string DeviceLog::summary() const {
  const auto rest = swing_.rests_since(kRest);
  char text[120];
  if (rest) {
    std::snprintf(text, sizeof text, " (at most %.3f N), within %.1f mm since %.1f s",
                  largest_force_, kMm * kRest, *rest);
  } else {
    std::snprintf(text, sizeof text, " (at most %.3f N), not at rest: swing %.3f mm",
                  largest_force_, kMm * swing_.last_second());
  }
  char time[20];
  std::snprintf(time, sizeof time, "%.1f s ", time_);
  return time + place_and_force(position_, force_) + text;
}

}  // namespace palpate::launcher
