#include "studies/report/measures.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

#include "modules/core/error.h"
#include "modules/core/output_file.h"

namespace palpate::report {

double median(std::vector<double> values) {
  PALPATE_DEMAND(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  // 0.07 · 100 is a little more than 7.
  const double rank = std::ceil(part * static_cast<double>(values.size()) - 1e-9);
  const auto at =
      values.begin() + std::max(static_cast<std::ptrdiff_t>(rank) - 1, std::ptrdiff_t{0});
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string machine_name() {
  std::string name;
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    name = after_colon(line);
    break;
  }
  return (name.empty() ? "unknown processor" : name) + ", " +
         std::to_string(std::thread::hardware_concurrency()) + " cores seen";
}

void make_out_folder(const std::filesystem::path& folder, const std::string& option) {
  make_writable_folder(folder, option);
}

}  // namespace palpate::report
