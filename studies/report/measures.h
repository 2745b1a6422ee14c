// What every measurement needs to speak of itself.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "modules/core/text.h"

namespace palpate::report {

using palpate::text_of;

/// The middle value; the upper one of the two middle ones. @param values  not empty
double median(std::vector<double> values);

/// The least value that `part` (0, 1] of them do not exceed; 0 if there are none.
double quantile(std::vector<double> values, double part);

/// Processor time of this thread [s]: what other programs take of the core does not count.
double processor_time();

/// Processor and number of cores of this machine, in words.
std::string machine_name();

/// Makes the folder of --out. @throws InputError if it cannot be made
void make_out_folder(const std::filesystem::path& folder, const std::string& option = "--out");

}  // namespace palpate::report
