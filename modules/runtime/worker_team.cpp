#include "modules/runtime/worker_team.h"

#include "modules/core/error.h"

namespace palpate::runtime {
namespace {

/// About 20 µs of looking before sleeping: longer than the serial part between two runs of a step.
constexpr int kSpins = 2000;

constexpr std::uint64_t kClosed = ~std::uint64_t{0};  ///< a ticket whose chunk is beyond any count

void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

WorkerTeam::WorkerTeam(std::size_t threads) {
  PALPATE_DEMAND(threads >= 1);
  try {
    for (std::size_t i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
  } catch (...) {  // no thread more: those that run are not left behind
    end();
    throw;
  }
}

WorkerTeam::~WorkerTeam() { end(); }

void WorkerTeam::end() {
  stop_ = true;
  ++run_;
  run_.notify_all();
  for (auto& worker : workers_) worker.join();
}

void WorkerTeam::run(std::size_t count, ChunkBody body) {
  // The ticket is closed while the run changes, or a worker late from the last one takes its end
  // for a chunk.
  ticket_ = kClosed;
  body_ = &body;  // cppcheck-suppress danglingLifetime; all chunks end before this returns
  count_ = count;
  done_ = 0;
  const std::uint32_t run = run_ + 1;
  ticket_ = std::uint64_t{run} << 32;
  run_ = run;
  if (count > 1) run_.notify_all();
  take_chunks(run);
  while (done_ < count) relax();  // at most one chunk per worker is still under way
}

void WorkerTeam::work() {
  std::uint32_t run = 0;
  while (true) {
    run = await_run(run);
    if (stop_) return;
    take_chunks(run);
  }
}

std::uint32_t WorkerTeam::await_run(std::uint32_t last_run) const {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (run_.load() != last_run) return run_.load();
    relax();
  }
  run_.wait(last_run);
  return run_.load();
}

void WorkerTeam::take_chunks(std::uint32_t run) {
  std::uint64_t ticket = ticket_;
  while (true) {
    // Read before the chunk is claimed: as long as one is left, the run cannot end and change them.
    const ChunkBody* const body = body_;
    const std::size_t count = count_, chunk = ticket & 0xffffffffu;
    if (ticket >> 32 != run || chunk >= count) return;
    if (!ticket_.compare_exchange_weak(ticket, ticket + 1)) continue;
    (*body)(chunk);
    ++done_;
    ticket = ticket_;
  }
}

}  // namespace palpate::runtime
