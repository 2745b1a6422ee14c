#include "modules/trajectories/table.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/text.h"
#include "modules/core/units.h"
#include "modules/trajectories/pose_collector.h"
#include "modules/trajectories/table_columns.h"

namespace palpate::trajectories {
namespace {

constexpr double kLongestFromZero = 1e6;     // [s]; later times are counted from the first
constexpr std::size_t kEstimateFrom = 4096;  // lines

double seconds_per(scene::TrajectoryDevice::TimeUnit unit) {
  return std::array{1.0, 1e-3, 1e-6, 1e-9}[static_cast<std::size_t>(unit)];
}

bool to_number(std::string_view field, double& value) {
  const char* const end = field.data() + field.size();
  const auto parsed = std::from_chars(field.data(), end, value);
  return parsed.ec == std::errc{} && parsed.ptr == end && std::isfinite(value);
}

/// The whole part of a number without an exponent, and what follows it: of a stamp since 1970 a
/// double alone keeps 0.2 µs.
struct Stamp {
  std::int64_t whole = 0;
  double rest = 0;
};

Stamp stamp_of(std::string_view field, double value) {
  Stamp stamp;
  if (field.find_first_of("eE") != std::string_view::npos) return {0, value};
  const char* const end = field.data() + field.size();
  const auto parsed = std::from_chars(field.data(), end, stamp.whole);
  if (parsed.ec != std::errc{} || (parsed.ptr != end && *parsed.ptr != '.')) return {0, value};
  if (parsed.ptr == end || parsed.ptr + 1 == end) return stamp;
  if (std::from_chars(parsed.ptr, end, stamp.rest).ptr != end) return {0, value};
  if (field.front() == '-') stamp.rest = -stamp.rest;
  return stamp;
}

class TableReader {
 public:
  TableReader(const scene::TrajectoryDevice& config, std::vector<std::string>& warnings,
              const Progress& progress)
      : config_(config),
        progress_(progress),
        second_(seconds_per(config.time_unit)),
        metre_(metres_per_unit(config.length_unit)),
        poses_(config.file.string(), ":", warnings) {}

  std::vector<TimedPose> read() {
    std::ifstream stream = open_input(config_.file);
    refuse_database(stream);
    const double bytes = double(std::filesystem::file_size(config_.file));
    double read = 0;
    for (std::string line; next_line(stream, line);) {
      if (++line_ == 1) drop_byte_order_mark(line);
      read += double(line.size() + 1);
      take(line);
      if (line_ == kEstimateFrom) poses_.expect(std::size_t(1.01 * bytes / read * double(line_)));
      if (progress_ && line_ % kProgressEvery == 0) progress_(read / bytes, poses_.size());
    }
    if (stream.bad()) refuse("recording cannot be read further");
    if (columns_.count == 0) refuse("holds no line that is not a comment");
    return std::move(poses_).finish(line_);
  }

 private:
  void refuse_database(std::istream& stream) const {
    constexpr std::string_view kBegins = "SQLite format 3";
    std::string first(kBegins.size(), '\0');
    stream.read(first.data(), std::ssize(first));
    if (stream.gcount() == std::ssize(first) && first == kBegins) {
      throw InputError(fmt::format(
          "{0}: is a bag of ROS 2 in SQLite, which is not read; make one in MCAP of it: `ros2 bag "
          "convert -i {0} -o out.yaml`, where out.yaml holds `output_bags: [{{uri: bag, "
          "storage_id: "
          "mcap, all: true}}]`",
          config_.file.string()));
    }
    stream.clear();
    stream.seekg(0);
  }

  /// Line ends of old Macs: the file would be one line, and its rows columns.
  void refuse_carriage_returns(std::string_view line) const {
    const std::size_t at = line.find('\r');
    if (at == std::string_view::npos || line.find_first_not_of('\r', at) == std::string_view::npos)
      return;
    refuse("its lines end with a carriage return alone; write line feeds (tr '\\r' '\\n')");
  }

  /// Bounded: a long file may have no end of a line.
  bool next_line(std::istream& stream, std::string& line) {
    stream.getline(buffer_.data(), std::ssize(buffer_));
    const std::streamsize count = stream.gcount();
    if (stream.fail()) {
      if (count + 1 < std::ssize(buffer_)) return false;
      ++line_;
      refuse_carriage_returns({buffer_.data(), static_cast<std::size_t>(count)});
      refuse("the line is longer than 64 KiB");
    }
    line.assign(buffer_.data(), static_cast<std::size_t>(stream.eof() ? count : count - 1));
    return true;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", config_.file.string(), line_, printable(what)));
  }

  void drop_byte_order_mark(std::string& line) const {
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")) {
      refuse("is UTF-16; save it as UTF-8");
    }
  }

  void take(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || line[begin] == '#') return;
    if (columns_.count == 0) {
      refuse_carriage_returns(line);
      find_columns_in(line);
      if (columns_.headed) return;
    }
    take_row(line);
  }

  void find_columns_in(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) refuse("holds a zero byte: it is no text");
    separator_ = separator_of(line);
    using Order = scene::TrajectoryDevice::QuaternionOrder;
    try {
      columns_ = find_columns(fields_of(line, separator_), config_.columns,
                              config_.quaternion == Order::kWxyz);
    } catch (const InputError& error) {
      refuse(error.what());
    }
    slot_of_.assign(columns_.count, -1);
    for (std::size_t slot = 0; slot < 8; ++slot) {
      if (slot < columns_.wanted) slot_of_[columns_.of[slot]] = int(slot);
    }
  }

  /// Fills value_ and time_. @returns what is wrong, empty if nothing
  std::string parse(std::string_view line) {
    std::string_view field;
    std::size_t column = 0;
    for (bool more = true; next_field(line, more, separator_, field); ++column) {
      const int slot = column < slot_of_.size() ? slot_of_[column] : -1;
      if (slot < 0) continue;
      double& value = value_[std::size_t(slot)];
      if (!to_number(field, value)) return wrong_field(column, field);
      if (slot == 0) time_ = time_of(field, value);
    }
    if (column == columns_.count) return {};
    std::string text = fmt::format("has {} columns, the first line {}", column, columns_.count);
    if (separator_ == ',' && column > columns_.count) {
      text += " (decimal commas are not read: write points)";
    }
    return text;
  }

  std::string wrong_field(std::size_t column, std::string_view field) const {
    if (separator_ != ',' && field.find(',') != std::string_view::npos) {
      refuse(fmt::format("column {} is '{}': decimal commas are not read, write points", column + 1,
                         field.substr(0, 40)));
    }
    return fmt::format("column {} is '{}', not a finite number", column + 1, field.substr(0, 40));
  }

  /// [s]
  double time_of(std::string_view field, double value) {
    if (poses_.size() == 0) {
      origin_ = std::abs(value) * second_ > kLongestFromZero ? stamp_of(field, value).whole : 0;
    }
    if (origin_ == 0) return second_ * value;
    const Stamp stamp = stamp_of(field, value);
    return second_ * (double(stamp.whole - origin_) + stamp.rest);
  }

  void take_row(std::string_view line) {
    value_ = {0, 0, 0, 0, 0, 0, 0, 1};
    if (const std::string wrong = parse(line); !wrong.empty()) {
      return poses_.leave_out(line_, printable(wrong));
    }
    const auto& [t, x, y, z, qx, qy, qz, qw] = value_;
    poses_.add(line_, time_, {metre_ * Vec3(x, y, z), Quat(qw, qx, qy, qz)});
  }

  const scene::TrajectoryDevice& config_;
  const Progress& progress_;
  double second_, metre_;
  PoseCollector poses_;
  std::vector<char> buffer_ = std::vector<char>(1 << 16);  ///< a line
  std::size_t line_ = 0;
  char separator_ = ',';
  TableColumns columns_;
  std::vector<int> slot_of_;  ///< of each column; -1: not read
  std::array<double, 8> value_{};
  double time_ = 0;
  std::int64_t origin_ = 0;
};

}  // namespace

std::vector<TimedPose> read_table(const scene::TrajectoryDevice& config,
                                  std::vector<std::string>& warnings, const Progress& progress) {
  return TableReader(config, warnings, progress).read();
}

}  // namespace palpate::trajectories
