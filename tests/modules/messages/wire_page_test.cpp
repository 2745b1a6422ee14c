#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "modules/messages/describe.h"
#include "modules/messages/message_types.h"

// The page's tables: name, type and range by describe(), unit by the name's end, meaning by the
// comment in idl/.
namespace palpate::messages {
namespace {

struct Field {
  std::string type, name, meaning;
};

std::string text_of_file(const std::string& file) {
  std::ifstream stream(PALPATE_SOURCE_DIR "/" + file);
  REQUIRE(stream);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The fields of each struct, and the values of each enumeration as fields without a type.
std::map<std::string, std::vector<Field>> declared_in(const std::string& idl) {
  static const std::regex begin(R"(\s*(?:struct|enum) (\w+) \{)"), comment(R"(\s*// (.*))"),
      field(R"(\s*(?:@key )?([\w<> ]+) (\w+)(\[\d+\])?;(?:\s*// (.*))?)"),
      value(R"(\s*(\w+),?\s*// (.*))");
  std::map<std::string, std::vector<Field>> declared;
  std::vector<Field>* here = nullptr;
  std::istringstream lines(idl);
  std::string above;  // comments on lines of their own
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (std::regex_match(line, found, begin)) {
      here = &declared[found[1]];
    } else if (here != nullptr && std::regex_match(line, found, field)) {
      here->push_back(
          {found[1].str() + found[3].str(), found[2], found[4].matched ? found[4].str() : above});
    } else if (here != nullptr && std::regex_match(line, found, value)) {
      here->push_back({"", found[1], found[2]});
    } else if (std::regex_match(line, found, comment)) {
      above += (above.empty() ? "" : " ") + found[1].str();
      continue;
    }
    above.clear();
  }
  return declared;
}

/// The IDL's type of a number that `T` holds.
template <class T>
std::string idl_type() {
  if constexpr (std::is_same_v<T, double>) return "double";
  if constexpr (std::is_same_v<T, float>) return "float";
  if constexpr (std::is_same_v<T, bool>) return "boolean";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "unsigned long";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "unsigned long long";
  if constexpr (std::is_same_v<T, std::int64_t>) return "long long";
  if constexpr (std::is_same_v<T, std::string>) return "string";
  if constexpr (std::is_same_v<T, Quat>) return "double[4]";
  if constexpr (std::is_same_v<T, Vec3>) return "double[3]";
  if constexpr (std::is_same_v<T, Mat3>) return "double[9]";
  if constexpr (std::is_same_v<T, std::array<std::uint32_t, 3>>) return "unsigned long";
  if constexpr (std::is_same_v<T, ModuleState>) return "ModuleState";
  if constexpr (std::is_same_v<T, SessionCommand>) return "SessionCommand";
  if constexpr (std::is_same_v<T, SpringFamily>) return "octet";
  if constexpr (std::is_same_v<T, FaceContacts>) return "FaceContacts";
  if constexpr (std::is_same_v<T, Contact>) return "Contact";
  if constexpr (std::is_same_v<T, LawRow>) return "LawRow";
  if constexpr (std::is_same_v<T, ModuleStatus::Input>) return "InputStatus";
  if constexpr (std::is_same_v<T, OrganExtremes>) return "OrganExtremes";
  if constexpr (std::is_same_v<T, ProbeExtremes>) return "ProbeExtremes";
  if constexpr (std::is_same_v<T, ClockExchange::Echo>) return "ClockEcho";
}

/// What the page says of a rule, and what the comment in idl/ must say of it.
std::pair<std::string, std::string> words_of(Rule rule) {
  switch (rule) {
    case Rule::kFromOne:
      return {"≥ 1", "from 1"};
    case Rule::kAtLeastZero:
      return {"≥ 0", ">= 0"};
    case Rule::kSinceSetUp:
      return {"≥ −1", ">= -1"};
    case Rule::kAge:
      return {"≥ 0, or infinity", ">= 0; infinity before the first"};
    case Rule::kUnit:
      return {"length 1", "unit"};
    case Rule::kWeights:
      return {"≥ 0, sum 1", ">= 0, sum 1"};
    case Rule::kSymmetric:
      return {"symmetric", "symmetric"};
    case Rule::kForceLimits:
      return {"0 … " + std::to_string(kAllForceLimits), "Bits: "};
    case Rule::kName:
      return {"1 … " + std::to_string(kMaxNameBytes) + " bytes", ""};
    default:
      return {};
  }
}

struct Row {
  std::string type, name, range, in_comment;
};

/// The rows of a message, its header left out, and of the entries of its lists.
class Rows {
 public:
  std::vector<Row> rows;
  void header(const Header&) {}
  template <class T>
  void key(const char* name, const T& value) {
    field(name, value, std::is_same_v<T, std::string> ? Rule::kName : Rule::kPlain);
    if (std::is_same_v<T, std::string>) {
      rows.back().type = "string<" + std::to_string(kMaxNameBytes) + ">";
    }
  }
  template <class T>
  void field(const char* name, const T&, Rule rule) {
    const auto [range, in_comment] = words_of(rule);
    rows.push_back({idl_type<T>(), name, range, in_comment});
    if constexpr (Enumeration<T>) {
      rows.back().range = "0 … " + std::to_string(Words<T>::texts.size() - 1);
    }
  }
  template <class List>
  void numbers(const char* name, const List&, const Bounds& bounds) {
    add_list(name, idl_type<typename List::value_type>(), bounds);
  }
  template <class List, class Parts>
  void numbers(const char* name, const List&, const Bounds& bounds, const Parts& parts) {
    const typename List::value_type entry;
    add_list(name, idl_type<std::decay_t<decltype(*parts(entry)[0])>>(), bounds);
  }
  template <class List>
  void list(const char* name, const List&, std::size_t max, const char*) {
    const typename List::value_type entry{};
    add_list(name, idl_type<typename List::value_type>(), {1, 0, max});
    describe(*this, entry);
  }
  template <class Compute>
  void derived(const char*, const Compute&) {}
  template <class Holds>
  void require(const char*, const Holds&) {}

 private:
  void add_list(const char* name, const std::string& type, const Bounds& bounds) {
    std::ostringstream range;
    if (bounds.max_entries > 0) range << bounds.min_entries << " … " << bounds.max_entries;
    if (bounds.numbers_per_entry > 1) range << " times " << bounds.numbers_per_entry;
    rows.push_back({"sequence<" + type + ">", name, range.str(), ""});
  }
};

/// By the end of a name.
std::string unit_of(const std::string& name) {
  // Longest first: "_m_per_s" ends in "_s".
  for (const auto& [end, unit] :
       std::vector<std::pair<std::string, std::string>>{{"_rad_per_s", "rad/s"},
                                                        {"_m_per_s", "m/s"},
                                                        {"_n_per_m", "N/m"},
                                                        {"_m_per_n", "m/N"},
                                                        {"_per_s", "1/s"},
                                                        {"_n_m", "N·m"},
                                                        {"_m3", "m³"},
                                                        {"_pa", "Pa"},
                                                        {"_hz", "Hz"},
                                                        {"_ns", "ns"},
                                                        {"_n", "N"},
                                                        {"_m", "m"},
                                                        {"_s", "s"},
                                                        {"_j", "J"}}) {
    if (name.ends_with(end)) return unit;
  }
  return "";
}

std::string last_part(const std::string& name) { return name.substr(name.rfind('.') + 1); }

/// Of the fields of `rows` and what the IDL declares of the messages and their entries.
std::string table(const std::vector<Row>& rows, const std::map<std::string, std::string>& meaning) {
  std::string text = "| field | type | unit | range | meaning |\n|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    text += "| `" + row.name + "` | `" + row.type + "` | " + unit_of(row.name) + " | " + row.range +
            " | " + meaning.at(last_part(row.name)) + " |\n";
  }
  return text;
}

std::vector<Row> header_rows() {
  Rows rows;
  const Header header;
  describe(rows, header);
  return rows.rows;
}

/// A message as describe() has it and as its IDL does.
struct Described {
  std::string name;
  std::vector<Row> rows;  ///< without the header's
  std::map<std::string, std::vector<Field>> declared;

  /// All fields that are declared, in the order of `rows`: a list before its entries.
  std::vector<Field> fields(const std::string& type) const {
    std::vector<Field> all;
    for (const Field& field : declared.at(type)) {
      all.push_back(field);
      const std::string entry =
          field.type.starts_with("sequence<") ? field.type.substr(9, field.type.size() - 10) : "";
      if (declared.contains(entry)) {
        const auto inner = fields(entry);
        all.insert(all.end(), inner.begin(), inner.end());
      }
    }
    return all;
  }
  std::map<std::string, std::string> meanings() const {
    std::map<std::string, std::string> all;
    for (const Field& field : fields(name)) all[field.name] = field.meaning;
    return all;
  }
};

std::vector<Described> all_described() {
  std::vector<Described> all;
  for (const AnyMessage& any : one_of_each()) {
    std::visit(
        [&](const auto& message) {
          Rows rows;
          describe(rows, message);
          const std::string name(type_of<std::decay_t<decltype(message)>>().name);
          all.push_back({name, rows.rows, declared_in(text_of_file("idl/" + name + ".idl"))});
        },
        any);
  }
  return all;
}

std::string wire_page() {
  const auto all = all_described();
  std::string page = "### Header\nThe first fields of every message.\n\n" +
                     table(header_rows(), all.front().meanings());
  for (const Described& message : all) {
    page += "\n### " + message.name + "\n" + table(message.rows, message.meanings());
    for (const auto& [type, values] : message.declared) {
      if (values.empty() || !values.front().type.empty()) continue;
      page += "\n" + type + ":";
      for (std::size_t i = 0; i < values.size(); ++i) {
        page += (i > 0 ? ", " : " ") + std::to_string(i) + " `" + values[i].name + "`";
      }
      page += ".\n";
    }
  }
  return page;
}

}  // namespace

TEST_CASE("wire page: docs/topics.md holds it word by word") {
  // Oracle: describe() and idl/. On a difference the new text is in the file named.
  const std::string expected = wire_page(), page = text_of_file("docs/topics.md"),
                    begin = "<!-- begin of the generated tables -->\n\n", end = "\n<!-- end -->";
  const auto first = page.find(begin);
  const auto last = page.find(end, first);
  REQUIRE(last != std::string::npos);
  const std::string found = page.substr(first + begin.size(), last - first - begin.size());
  if (found == expected) return;
  std::ofstream("wire_page.md") << expected;
  FAIL("docs/topics.md differs from the messages; the new tables are in "
       << std::filesystem::absolute("wire_page.md"));
}

TEST_CASE("wire page: idl/ and page say which version of the protocol they describe") {
  // Oracle: kProtocolVersion.
  const std::string told = "this text describes version " + std::to_string(kProtocolVersion);
  CHECK(text_of_file("idl/SceneDescription.idl").find(told + "\n") != std::string::npos);
  CHECK(text_of_file("docs/topics.md").find(told + " |") != std::string::npos);
}

TEST_CASE("wire page: idl/ declares what describe() names, with its type, in its order") {
  // Oracle: the declarations, read as text.
  for (const Described& message : all_described()) {
    std::vector<Row> rows = header_rows();
    rows.insert(rows.end(), message.rows.begin(), message.rows.end());
    const auto fields = message.fields(message.name);
    REQUIRE(fields.size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      INFO(message.name << '.' << rows[i].name);
      CHECK(fields[i].name == last_part(rows[i].name));
      CHECK(fields[i].type == rows[i].type);
    }
  }
}

TEST_CASE("wire page: the comments of idl/ tell the rules that readers check") {
  // Oracle: the words for each rule, looked for in the field's comment.
  for (const Described& message : all_described()) {
    const auto meanings = message.meanings();
    for (const Row& row : message.rows) {
      INFO(message.name << '.' << row.name << ": " << meanings.at(last_part(row.name)));
      CHECK(meanings.at(last_part(row.name)).find(row.in_comment) != std::string::npos);
    }
  }
  const auto enumerations = all_described();
  for (const auto& [message, type, words] :
       {std::tuple("ModuleStatus", "ModuleState", Words<ModuleState>::texts.size()),
        std::tuple("SessionControl", "SessionCommand", Words<SessionCommand>::texts.size())}) {
    for (const Described& described : enumerations) {
      if (described.name == message) CHECK(described.declared.at(type).size() == words);
    }
  }
}

}  // namespace palpate::messages
