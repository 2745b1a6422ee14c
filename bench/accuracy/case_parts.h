// What the cases have in common. Each measure_…() is one case of cases.h.
#pragma once

#include <map>

#include "bench/accuracy/cases.h"
#include "bench/accuracy/stage.h"

namespace palpate::accuracy {

inline constexpr double kYoungsModulus = 5e3;    // of the references [Pa]
inline constexpr double kDensity = 1060;         // [kg/m³]
inline constexpr double kPoissonRatio = 0.499;   // Solid's default
inline constexpr std::size_t kVirtualNodes = 6;  // of what has a dominant axis
inline constexpr double kLongestSettling = 3;    // [s]

/// Columns by name. @throws InputError naming the file, its line and the value
class ReferenceTable {
 public:
  explicit ReferenceTable(const std::filesystem::path& file);
  std::size_t size() const { return rows_; }
  double at(const std::string& column, std::size_t row) const;
  /// The row whose `column` is `value`. @throws InputError if there is none
  std::size_t row_of(const std::string& column, double value) const;

 private:
  std::filesystem::path file_;
  std::map<std::string, std::vector<double>> columns_;
  std::size_t rows_ = 0;
};

/// A plane, solid on the side `up` (±z) does not point to, at `height`.
Pose plate(double height, bool facing_up);

/// Moves all probes in a straight line at `speed` [m/s] from `from` to `to`, then lets them settle.
void move_and_settle(Stage& stage, std::vector<Pose>& poses, const std::vector<Vec3>& to,
                     double speed, const KeepGoing& keep_going);

/// Sizes, step, cost and volume error of the stage so far.
Measurement summary(const Stage& stage, const geometry::OrganShape& shape);

Measurement measure_ball(const Setting& setting, const Source& source, const KeepGoing& keep_going);
Measurement measure_block(const Setting& setting, const Source& source,
                          const KeepGoing& keep_going);
Measurement measure_indent(const Setting& setting, const Source& source,
                           const KeepGoing& keep_going);
Measurement measure_vibration(const Setting& setting, const Source& source,
                              const KeepGoing& keep_going);
Measurement measure_truth_cube(const Setting& setting, const Source& source,
                               const KeepGoing& keep_going);
Measurement measure_beam(const Setting& setting, const Source& source, const KeepGoing& keep_going);
Measurement measure_liver(const Setting& setting, const Source& source,
                          const KeepGoing& keep_going);
Measurement measure_stomach(const Setting& setting, const Source& source,
                            const KeepGoing& keep_going);

}  // namespace palpate::accuracy
