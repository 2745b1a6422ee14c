// A motion's velocity, by its poses alone.
#pragma once

#include <array>

#include "modules/core/rotation_vector.h"
#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::haptics {

class PoseSpeed {
 public:
  /// @param span  over so long, where there are poses enough [s]  @param longest  not longer [s]
  PoseSpeed(double span, double longest) : span_(span), longest_(longest) {}

  void clear() { count_ = 0; }
  /// @param time  later than that of the pose before [s]
  void add(double time, const Pose& pose) {
    newest_ = (newest_ + 1) % kKept;
    kept_[newest_] = {time, pose};
    count_ = count_ < kKept ? count_ + 1 : kKept;
  }
  /// From the oldest pose within the span, or else the last but one, to the newest; zero where that
  /// is too long ago or there is none.
  Twist twist() const {
    std::size_t back = 1;
    while (back + 1 < count_ && kept_[newest_].time - of(back + 1).time <= span_) ++back;
    if (back >= count_) return {};
    const Kept &from = of(back), &to = kept_[newest_];
    const double time = to.time - from.time;
    if (!(time > 0 && time <= longest_)) return {};
    return {(to.pose.position - from.pose.position) / time,
            vector_from_rotation(to.pose.rotation * from.pose.rotation.conjugate()) / time};
  }

  void exchange(StateArchive& archive) {
    for (Kept& kept : kept_) archive(kept.time, kept.pose);
    archive(newest_, count_);
    if (newest_ >= kKept || count_ > kKept) throw InputError("its state is of no motion");
  }

 private:
  static constexpr std::size_t kKept = 16;
  struct Kept {
    double time = 0;
    Pose pose;
  };
  const Kept& of(std::size_t back) const { return kept_[(newest_ + kKept - back) % kKept]; }

  double span_, longest_;
  std::array<Kept, kKept> kept_;
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace palpate::haptics
