// Who reads the sockets of samples.
#pragma once

#include <memory>

namespace palpate::bus {

class PolledSockets;
class SampleShortcut;

/// How what arrives is read.
enum class Arrivals {
  kAtOnce,
  /// Some later, up to GatheringPause::kLongest (packet_gatherer.h), and with the times of arrival
  /// all the same: that takes a third of the processor. Of streams every sample is kept for its
  /// reader (sample_shortcut.h). On one host; over hosts as kAtOnce.
  kGathered,
  /// By the thread that reads or waits, which is woken once for it and not by another one; nothing
  /// is heard meanwhile. On one host; over hosts as kAtOnce.
  kPolled,
};

/// A thread of the library's for each socket, unless one of these is given.
struct Hearing {
  /// They are read many at a time (packet_gatherer.h); samples bear the time of their arrival
  /// (packet_stamp.h).
  std::shared_ptr<SampleShortcut> shortcut;
  /// Who waits for samples reads them (polled_sockets.h).
  std::shared_ptr<PolledSockets> polled;

  bool by_library() const { return !shortcut && !polled; }
};

}  // namespace palpate::bus
