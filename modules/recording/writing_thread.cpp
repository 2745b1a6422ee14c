#include "modules/recording/writing_thread.h"

#include <chrono>
#include <utility>

namespace palpate::recording {
namespace {

/// Nobody wakes the thread: it looks.
constexpr std::chrono::milliseconds kRound{50};

}  // namespace

WritingThread::WritingThread(Job job, std::size_t most_waiting)
    : job_(std::move(job)), most_waiting_(most_waiting), thread_([this] { run(); }) {}

WritingThread::~WritingThread() {
  try {
    finish();
  } catch (...) {  // the file is whole up to its last chunk
  }
}

bool WritingThread::add(const TopicSample& sample) {
  const std::lock_guard lock(mutex_);
  if (failure_ || waiting_.bytes + sample.payload.size() > most_waiting_) return false;
  if (waiting_.count == waiting_.samples.size()) waiting_.samples.emplace_back();
  waiting_.samples[waiting_.count++] = sample;
  waiting_.bytes += sample.payload.size();
  return true;
}

void WritingThread::check() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

void WritingThread::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
  check();
}

void WritingThread::run() {
  Batch batch;
  for (bool last = false; !last;) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, kRound, [this] { return finishing_; });
      last = finishing_;
      std::swap(batch, waiting_);
    }
    if (!write(batch)) return;
  }
}

bool WritingThread::write(Batch& batch) {
  try {
    for (std::size_t i = 0; i < batch.count; ++i) job_.write(batch.samples[i]);
    job_.end_round();
    batch.count = batch.bytes = 0;
    return true;
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    return false;
  }
}

}  // namespace palpate::recording
