// Writes a recording down in a thread of its own: whoever takes samples off the bus waits neither
// for the disk nor for compression.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "modules/recording/session_samples.h"

namespace palpate::recording {

class WritingThread {
 public:
  /// What may wait to be written [bytes]: a minute of most scenes. Then samples are lost.
  static constexpr std::size_t kMostWaiting = 64u << 20;

  struct Job {
    std::function<void(const TopicSample&)> write;
    std::function<void()> end_round;  ///< behind all that had come by then
  };

  /// @param job  called by the thread alone, until finish() returns
  explicit WritingThread(Job job, std::size_t most_waiting = kMostWaiting);
  ~WritingThread();  ///< as finish(); what went wrong is not told

  /// Keeps a copy. False if too much waits already, or writing has failed.
  bool add(const TopicSample& sample);
  /// @throws what the job threw; after that nothing more is written
  void check();
  /// Writes all that waits, and ends the thread. @throws as check()
  void finish();

 private:
  // Places keep their memory for other samples.
  struct Batch {
    std::vector<TopicSample> samples;
    std::size_t count = 0, bytes = 0;
  };

  void run();
  bool write(Batch& batch);

  Job job_;
  std::size_t most_waiting_;
  std::mutex mutex_;  ///< of all below
  std::condition_variable wake_;
  Batch waiting_;
  std::exception_ptr failure_;
  bool finishing_ = false;
  std::thread thread_;
};

}  // namespace palpate::recording
