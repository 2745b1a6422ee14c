#include "studies/report/progress.h"

#include <iomanip>
#include <ostream>

namespace palpate::report {
namespace {

constexpr std::chrono::seconds kLineEvery{2};

}  // namespace

Progress::Progress(std::ostream& log, std::function<bool()> stop)
    : log_(log), stop_(std::move(stop)) {}

void Progress::begin(const std::string& job) {
  job_ = job;
  log_ << job_ << std::endl;
  next_line_ = std::chrono::steady_clock::now() + kLineEvery;
}

void Progress::at(double done, double total, const char* unit) {
  if (stop_()) throw Stopped{};
  const auto now = std::chrono::steady_clock::now();
  if (now < next_line_) return;
  next_line_ = now + kLineEvery;
  log_ << job_ << ": " << std::fixed << std::setprecision(total < 100 ? 1 : 0) << done << " of "
       << total << ' ' << unit << std::endl;
}

}  // namespace palpate::report
