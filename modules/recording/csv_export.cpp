#include "modules/recording/csv_export.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "modules/core/files_of_kind.h"
#include "modules/core/output_file.h"
#include "modules/messages/csv.h"

namespace palpate::recording {
namespace {

constexpr const char* kTimeColumns = "time_s,sim_time_s,latency_s,sequence";
constexpr FileKind kTables{"", ".csv", kTimeColumns, "tables of a recording"};

// A module's name comes from outside: it must not leave the folder.
std::string file_part(const std::string& key) {
  std::string part = key;
  for (char& letter : part) {
    if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-') letter = '_';
  }
  return part;
}

/// A loop of links, or a name too long, is for who makes it to refuse.
bool is_there(const std::filesystem::path& folder) {
  std::error_code none;
  return std::filesystem::exists(folder, none);
}

std::string times_of(const Header& header, std::int64_t received_ns, std::int64_t start_ns) {
  std::ostringstream stream;
  messages::write_seconds(stream, received_ns - start_ns);
  messages::write_seconds(stream << ',', header.sim_time_ns);
  messages::write_seconds(stream << ',', received_ns - header.source_time_ns);
  stream << ',' << header.sequence;
  return stream.str();
}

}  // namespace

void check_no_tables(const std::filesystem::path& folder) {
  check_none_of_kind(folder, kTables, "--csv");
}

CsvExport::CsvExport(std::filesystem::path folder, bool overwrite)
    : folder_(std::move(folder)), overwrite_(overwrite), is_new_(!is_there(folder_)) {
  if (!overwrite) check_no_tables(folder_);
  make_writable_folder(folder_, "--csv");
}

CsvExport::~CsvExport() {
  files_.clear();
  std::error_code not_empty;
  if (is_new_) std::filesystem::remove(folder_, not_empty);
}

std::ostream& CsvExport::file(const std::string& name, const std::string& columns) {
  const auto [place, is_new] =
      files_.try_emplace(name, folder_ / (name + ".csv"), kTimeColumns, "table of samples");
  std::ostream& stream = place->second.stream();
  if (is_new) stream << ',' << columns << '\n';
  return stream;
}

void CsvExport::add(const RecordedSample& sample, const messages::AnyMessage& message,
                    std::int64_t start_ns) {
  const std::string key = messages::key_text(message);
  std::string name(sample.topic->name);
  if (!key.empty()) name.append("_").append(file_part(key));
  const std::string times =
      times_of(messages::header_of(message), sample.received_time_ns, start_ns);
  std::ostream& stream = file(name, messages::csv_columns(message));
  stream << times << ',';
  messages::write_csv_values(stream, message);
  stream << '\n';
  if (const auto* status = std::get_if<ModuleStatus>(&message)) add_inputs(*status, times);
}

void CsvExport::add_inputs(const ModuleStatus& status, const std::string& times) {
  for (const ModuleStatus::Input& input : status.inputs) {
    std::ostream& stream =
        file("module_inputs_" + file_part(status.module), messages::csv_columns(input));
    stream << times << ',';
    messages::write_csv_values(stream, input);
    stream << '\n';
  }
}

void CsvExport::close() {
  auto left = overwrite_ ? files_of_kind(folder_, kTables) : std::vector<std::filesystem::path>();
  std::erase_if(left, [&](const auto& file) { return files_.contains(file.stem().string()); });
  for (auto& [name, file] : files_) file.finish();
  remove_files(left);
  is_new_ = false;
}

}  // namespace palpate::recording
