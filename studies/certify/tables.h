// The tables that the pictures of a certificate are drawn from.
#pragma once

#include <filesystem>

#include "studies/certify/law.h"
#include "studies/certify/loop.h"
#include "studies/certify/slide.h"
#include "studies/certify/still_force.h"
#include "studies/certify/timing.h"

namespace palpate::certify {

void write_law(const std::vector<LawStiffness>& law, const std::filesystem::path& folder);
void write_still_force(const std::vector<StillForce>& forces, const std::filesystem::path& folder);
void write_ticks(const std::vector<Tick>& ticks, const std::filesystem::path& file);
/// Periods and latencies, the share of them that is no longer.
void write_timing(const Timing& timing, const std::filesystem::path& folder);
void write_slide(const std::vector<SlideTick>& ticks, const std::filesystem::path& folder);

}  // namespace palpate::certify
