#include "studies/report/progress.h"

#include <iomanip>
#include <ostream>

#include "studies/report/pace.h"

namespace palpate::report {
namespace {

constexpr std::chrono::seconds kLineEvery{2};

}  // namespace

Progress::Progress(std::ostream& log, std::function<bool()> stop)
    : log_(log), stop_(std::move(stop)) {}

void Progress::begin(const std::string& job) {
  job_ = job;
  log_ << job_ << std::endl;
  begin_ = std::chrono::steady_clock::now();
  next_line_ = begin_ + kLineEvery;
}

void Progress::at(double done, double total, const char* unit) {
  if (stop_()) throw Stopped{};
  const auto now = std::chrono::steady_clock::now();
  if (now < next_line_) return;
  next_line_ = now + kLineEvery;
  log_ << job_ << ": " << std::fixed << std::setprecision(total < 100 ? 1 : 0) << done << " of "
       << total << ' ' << unit;
  if (done > 0) {
    const double taken = std::chrono::duration<double>(now - begin_).count();
    log_ << text_of_time_left(taken * (total - done) / done);
  }
  log_ << std::endl;
}

}  // namespace palpate::report
