#include "palpate/device/swing.h"

#include <algorithm>
#include <cmath>

namespace palpate::launcher {
namespace {

constexpr double kOnGrid = 1e-9;  // [s]

}  // namespace

void Swing::add(double time, const Vec3& position) {
  const Box place{position, position};
  const auto span = static_cast<std::size_t>(std::floor((time + kOnGrid) / kSpan));
  while (boxes_.size() <= span) boxes_.push_back(place);
  boxes_.back().include(place);
}

double Swing::last_second() const {
  if (boxes_.empty()) return 0;
  const auto spans = static_cast<std::size_t>(std::lround(1 / kSpan));
  Box all = boxes_.back();
  for (std::size_t i = boxes_.size() - std::min(spans, boxes_.size()); i < boxes_.size(); ++i) {
    all.include(boxes_[i]);
  }
  return all.diagonal();
}

std::optional<double> Swing::rests_since(double diagonal) const {
  if (boxes_.empty()) return std::nullopt;
  Box all = boxes_.back();
  std::size_t first = boxes_.size();
  for (; first > 0; --first) {
    all.include(boxes_[first - 1]);
    if (all.diagonal() > diagonal) break;
  }
  if (first + 1 >= boxes_.size()) return std::nullopt;
  return kSpan * static_cast<double>(first);
}

}  // namespace palpate::launcher
