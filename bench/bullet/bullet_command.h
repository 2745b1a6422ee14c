// The squeezed ball by Bullet's soft body and by ours, in one run.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "bench/bullet/squeezed_ball.h"

namespace palpate::bench {

struct BulletOptions {
  std::filesystem::path out;                   ///< folder for bullet.csv; empty: none
  std::vector<std::size_t> nodes{642, 19362};  ///< sizes of the ball
  bool quick = false;                          ///< few settings, 642 nodes, one timing each
};

/// One line of the table.
struct TableRow {
  std::size_t nodes = 0;
  bool ours = false;
  std::string setting;
  Outcome outcome;  ///< us_per_step: median of all runs of it
  int runs = 1;
};

/// Runs every setting once, then the fastest and the most accurate stable one of Bullet and all of
/// ours again, in turn, so that a machine whose speed drifts slows all.
/// @param keep_going  asked at every step; may throw
std::vector<TableRow> compare(const BulletOptions& options, std::ostream& log,
                              const std::function<void()>& keep_going);

void print_table(const std::vector<TableRow>& rows, std::ostream& out);
/// For each size: how many times fewer µs per step than Bullet's cheapest stable setting, and how
/// many times smaller a held volume error than its most accurate stable one.
void print_ratios(const std::vector<TableRow>& rows, std::ostream& out);
void write_table(const std::vector<TableRow>& rows, const std::filesystem::path& file);

/// The whole command. @return an exit code
int run_bullet(const BulletOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::bench
