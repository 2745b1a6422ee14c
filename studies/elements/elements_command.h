// What `palpate elements` does.
#pragma once

#include <iosfwd>

#include "studies/elements/verification.h"

namespace palpate::elements_bench {

struct ElementsOptions {
  std::filesystem::path reference_folder;  ///< of the tables of A, C, D, E
  std::filesystem::path out;               ///< folder for CSV files; empty: none
  std::vector<std::string> cases;          ///< of case_names(); empty: all
  std::vector<double> sizes;               ///< empty: default_sizes()
  bool quick = false;
};

/// Runs the cases from coarse to fine, prints for each a table of errors and the observed orders,
/// and writes elements_<case>.csv. Ends early, with what is done, where `keep_going` throws
/// Interrupted.
/// @return kExitDone, or kExitStopped
/// @throws InputError
int run_elements(const ElementsOptions& options, const std::function<void()>& keep_going,
                 std::ostream& out, std::ostream& log);

/// Order between two meshes from the errors |e| and sizes: ln(e₁/e₂)/ln(h₁/h₂).
double observed_order(double coarse_error, double fine_error, double coarse_size, double fine_size);

}  // namespace palpate::elements_bench
