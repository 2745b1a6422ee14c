#include "haptics/devices/trajectory_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <optional>
#include <string_view>

#include "modules/core/error.h"
#include "modules/core/tolerances.h"

namespace palpate::haptics {
namespace {

constexpr std::string_view kPoseHeader = "t,x,y,z,qx,qy,qz,qw";
constexpr std::string_view kPoseAndForceHeader = "t,x,y,z,qx,qy,qz,qw,fx,fy,fz";
constexpr std::size_t kPoseColumns = 8, kMaxColumns = 11;
constexpr double kShortestStep = 1e-6;  ///< [s]
constexpr double kLongestStep = 0.1;    ///< more is a gap [s]
constexpr double kGapOverMedian = 5;
constexpr std::size_t kReportedInFull = 20;

using Row = std::array<double, kMaxColumns>;

std::string place(const std::filesystem::path& file, std::size_t line) {
  return file.string() + ":" + std::to_string(line) + ": ";
}

std::string text(double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, 6);
  return {buffer.data(), end.ptr};
}

std::string_view trimmed(std::string_view s) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = s.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(kBlank) - first + 1);
}

std::string without_blanks(std::string_view s) {
  std::string result;
  std::copy_if(s.begin(), s.end(), std::back_inserter(result),
               [](char c) { return c != ' ' && c != '\t' && c != '\r'; });
  return result;
}

/// Splits `line` into `row`. @returns what is wrong, empty if nothing
std::string parse_row(std::string_view line, std::size_t columns, Row& row) {
  const auto found = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  if (found != columns) {
    return "has " + std::to_string(found) + " columns, the header " + std::to_string(columns);
  }
  for (std::size_t i = 0; i < columns; ++i) {
    const std::size_t comma = line.find(',');
    const std::string_view field = trimmed(line.substr(0, comma));
    const char* const end = field.data() + field.size();
    const auto parsed = std::from_chars(field.data(), end, row[i]);
    if (parsed.ec != std::errc{} || parsed.ptr != end || !std::isfinite(row[i])) {
      return "column " + std::to_string(i + 1) + " is '" + std::string(field) +
             "', not a finite number";
    }
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  }
  return {};
}

/// Fills `sample` from `row`. @returns what is wrong, empty if nothing
std::string check_row(const Row& row, const TimedPose* previous, TimedPose& sample) {
  sample.time = row[0];
  sample.pose = {Vec3(row[1], row[2], row[3]), Quat(row[7], row[4], row[5], row[6])};
  if (previous && !(sample.time - previous->time >= kShortestStep)) {
    return "t = " + text(sample.time) + " s is not at least 1e-6 s after the previous " +
           text(previous->time) + " s";
  }
  if (!(sample.pose.position.stableNorm() <= kWorldReach)) {
    return "position is beyond " + text(kWorldReach) + " m (metres expected)";
  }
  const double length = sample.pose.rotation.coeffs().stableNorm();
  if (!(std::abs(length - 1) <= kWrittenUnitTolerance)) {
    return "quaternion has length " + text(length) + ", must be 1 within " +
           text(kWrittenUnitTolerance);
  }
  sample.pose.rotation.normalize();
  return {};
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, std::vector<std::string>& warnings)
      : file_(file), warnings_(warnings) {}

  std::vector<TimedPose> read() {
    std::ifstream stream(file_);
    if (!stream || std::filesystem::is_directory(file_)) {
      throw InputError(file_.string() + ": recording cannot be opened");
    }
    for (std::string line; std::getline(stream, line);) {
      ++line_;
      const std::string_view content = trimmed(line);
      if (content.empty() || content.front() == '#') continue;
      columns_ == 0 ? read_header(content) : read_row(content);
    }
    if (stream.bad()) throw InputError(place(file_, line_) + "recording cannot be read further");
    check_count();
    report_gaps();
    return std::move(samples_);
  }

 private:
  void read_header(std::string_view content) {
    const std::string header = without_blanks(content);
    if (header == kPoseHeader) {
      columns_ = kPoseColumns;
    } else if (header == kPoseAndForceHeader) {
      columns_ = kMaxColumns;
    } else {
      throw InputError(place(file_, line_) + "header is '" + header.substr(0, 80) + "', must be '" +
                       std::string(kPoseHeader) + "', with or without ',fx,fy,fz'");
    }
  }

  void read_row(std::string_view content) {
    Row row{};
    TimedPose sample;
    std::string wrong = parse_row(content, columns_, row);
    if (wrong.empty()) {
      wrong = check_row(row, samples_.empty() ? nullptr : &samples_.back(), sample);
    }
    if (wrong.empty()) {
      samples_.push_back(sample);
      lines_.push_back(line_);
    } else if (++bad_rows_ <= kReportedInFull) {
      warnings_.push_back(place(file_, line_) + "row skipped: " + wrong);
    }
  }

  void check_count() {
    if (bad_rows_ > kReportedInFull) {
      warnings_.push_back(place(file_, line_) + "in all " + std::to_string(bad_rows_) +
                          " rows skipped");
    }
    if (columns_ == 0) {
      throw InputError(place(file_, line_) + "no header, must be '" + std::string(kPoseHeader) +
                       "', with or without ',fx,fy,fz'");
    }
    if (samples_.size() < 2) {
      throw InputError(place(file_, line_) + "only " + std::to_string(samples_.size()) +
                       " usable rows, at least 2 are needed" +
                       (warnings_.empty() ? "" : " (last: " + warnings_.back() + ")"));
    }
  }

  double longest_regular_step() const {
    std::vector<double> steps(samples_.size() - 1);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      steps[i] = samples_[i + 1].time - samples_[i].time;
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return std::min(kLongestStep, kGapOverMedian * *middle);
  }

  void report_gaps() {
    const double longest_regular = longest_regular_step();
    std::size_t gaps = 0, longest_line = 0;
    double longest = 0;
    for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
      const double step = samples_[i + 1].time - samples_[i].time;
      if (step <= longest_regular) continue;
      if (step > longest) longest = step, longest_line = lines_[i + 1];
      if (++gaps <= kReportedInFull) {
        warnings_.push_back(place(file_, lines_[i + 1]) + "gap of " + text(step) +
                            " s before t = " + text(samples_[i + 1].time) +
                            " s, bridged by interpolation");
      }
    }
    if (gaps > kReportedInFull) {
      warnings_.push_back(place(file_, longest_line) + "in all " + std::to_string(gaps) +
                          " gaps, the longest, here, of " + text(longest) + " s");
    }
  }

  const std::filesystem::path& file_;
  std::vector<std::string>& warnings_;
  std::size_t line_ = 0, columns_ = 0, bad_rows_ = 0;
  std::vector<TimedPose> samples_;
  std::vector<std::size_t> lines_;  ///< of each sample
};

}  // namespace

std::vector<TimedPose> read_trajectory(const std::filesystem::path& file,
                                       std::vector<std::string>& warnings) {
  return Reader(file, warnings).read();
}

}  // namespace palpate::haptics
