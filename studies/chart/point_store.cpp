#include "studies/chart/point_store.h"

#include <spdlog/fmt/fmt.h>

#include <sstream>

#include "studies/report/measures.h"
#include "studies/report/reference_table.h"
#include "studies/report/table_file.h"

namespace palpate::chart {
namespace {

/// Of what is stored; raised when a case, a model or its constants change.
constexpr int kVersion = 4;

/// Visits all that is stored of a measurement and one of its samples, as numbers.
template <class Visit>
void visit_numbers(const Visit& visit) {
  const auto count = [&](const char* name, std::size_t Measurement::*member) {
    visit(name, [=](Measurement& m, Sample&, double* value) {
      if (value != nullptr) m.*member = static_cast<std::size_t>(*value);
      return static_cast<double>(m.*member);
    });
  };
  const auto flag = [&](const char* name, bool Measurement::*member) {
    visit(name, [=](Measurement& m, Sample&, double* value) {
      if (value != nullptr) m.*member = *value != 0;
      return static_cast<double>(m.*member);
    });
  };
  const auto number = [&](const char* name, double Measurement::*member) {
    visit(name, [=](Measurement& m, Sample&, double* value) {
      return value != nullptr ? m.*member = *value : m.*member;
    });
  };
  const auto answer = [&](const std::string& name, auto&& place) {
    visit(name, [=](Measurement&, Sample& s, double* value) {
      return value != nullptr ? place(s) = *value : place(s);
    });
  };
  count("surface_nodes", &Measurement::surface_nodes);
  count("inner_nodes", &Measurement::inner_nodes);
  count("tetrahedra", &Measurement::tetrahedra);
  number("step_s", &Measurement::step);
  number("cost_s_per_s", &Measurement::cost);
  number("volume_error", &Measurement::volume_error);
  flag("diverged", &Measurement::diverged);
  flag("is_course", &Measurement::is_course);
  count("troubled_places", &Measurement::troubled_places);
  answer("load", [](Sample& s) -> double& { return s.load; });
  answer("place", [](Sample& s) -> double& { return s.place; });
  answer("force", [](Sample& s) -> double& { return s.force; });
  answer("force_bar", [](Sample& s) -> double& { return s.force_bar; });
  answer("reference_force", [](Sample& s) -> double& { return s.reference_force; });
  answer("reference_force_bar", [](Sample& s) -> double& { return s.reference_force_bar; });
  answer("estimated_error", [](Sample& s) -> double& { return s.estimated_error; });
  answer("shape_m", [](Sample& s) -> double& { return s.shape; });
  answer("reference_shape_m", [](Sample& s) -> double& { return s.reference_shape; });
  answer("field_error_m", [](Sample& s) -> double& { return s.field_error; });
  answer("contact_radius_m", [](Sample& s) -> double& { return s.contact_radius; });
  answer("reference_contact_radius_m",
         [](Sample& s) -> double& { return s.reference_contact_radius; });
  for (std::size_t i = 0; i < kProfilePlaces.size(); ++i) {
    answer(fmt::format("profile_at_{:g}_m", kProfilePlaces[i]),
           [i](Sample& s) -> double& { return s.profile[i]; });
  }
}

}  // namespace

std::string reference_key(int level) { return fmt::format("reference-{}", level); }

PointStore::PointStore(const std::filesystem::path& folder, std::ostream& log)
    : files_(folder, log) {
  report::make_out_folder(folder);
}

std::string PointStore::name_of(const Case& of, const std::string& key) {
  return fmt::format("{}-{}-v{}", of.name, key, kVersion);
}

bool PointStore::read(const Case& of, const std::string& key, Measurement& out) const {
  const std::string name = name_of(of, key) + ".csv";
  const auto text = files_.read(name);
  if (!text) return false;
  std::istringstream lines(*text);
  const report::ReferenceTable table(name, lines);
  out = {};
  for (std::size_t row = 0; row < table.size(); ++row) {
    Sample& sample = out.samples.emplace_back();
    visit_numbers([&](const std::string& column, const auto& access) {
      double value = table.at(column, row);
      access(out, sample, &value);
    });
  }
  return !out.samples.empty();
}

void PointStore::write(const Case& of, const std::string& key,
                       const Measurement& measurement) const {
  std::vector<std::string> columns;
  visit_numbers([&](const std::string& name, const auto&) { columns.push_back(name); });
  std::string text = report::table_line(columns);
  Measurement whole = measurement;
  for (Sample& sample : whole.samples) {
    std::vector<double> row;
    visit_numbers([&](const std::string&, const auto& access) {
      row.push_back(access(whole, sample, nullptr));
    });
    text += report::table_line(row);
  }
  files_.write(name_of(of, key) + ".csv", text);
}

}  // namespace palpate::chart
