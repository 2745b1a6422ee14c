// What a calibration prints and writes.
#pragma once

#include <iosfwd>
#include <vector>

#include "studies/calibration/calibration.h"

namespace palpate::calibration {

/// The settings the case is compared with.
void print_settings(const Case& calibrated, std::ostream& out);

/// One line per mesh and compression: force, pressure, equatorial radius and bulge beside the
/// reference, errors in per cent. '*' marks a row that had not come to rest.
void print_comparisons(const Case& calibrated, const std::vector<Comparison>& comparisons,
                       std::ostream& out);

/// Largest error of force, pressure and equatorial radius at 30 to 50 % compression.
double worst_error(const Case& calibrated, const Comparison& comparison);

void print_fit_header(const Case& calibrated, std::ostream& out);
void print_fit(const Case& calibrated, const Fit& fit, std::ostream& out);

/// CSV, one header line; SI units in the column names.
inline constexpr const char* kCsvHeader =
    "case,nodes,compression,settled,force_n,reference_force_n,pressure_pa,"
    "reference_pressure_pa,equatorial_radius_m,reference_equatorial_radius_m\n";
void write_csv(const Case& calibrated, const std::vector<Comparison>& comparisons,
               std::ostream& out);

}  // namespace palpate::calibration
