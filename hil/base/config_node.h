#pragma once
// A parsed configuration file as plain values with positions, and the strict reader of its tables: every key must be
// known, of the right type and in range; every complaint names file:line:column. Where the values come from (TOML) is
// the business of hil/rig/config.h.

#include <cstddef>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

/// One value of a parsed file and where it stood.
struct ConfigNode {
  enum class Kind { table, array, text, number, integer, boolean, other };
  Kind kind = Kind::other;
  std::string where;  ///< "plan.toml:12:3"
  std::string file;   ///< "plan.toml"
  std::string text;
  double number = 0.0;  ///< also set for integers
  std::int64_t integer = 0;
  bool boolean = false;
  std::vector<std::string> names;  ///< of a table's items, in the file's alphabetical order
  std::vector<ConfigNode> items;   ///< of a table or an array
  const ConfigNode* find(std::string_view name) const;
  std::string_view kind_name() const;
};

/// Reads the keys of one table. The first mistake is kept and later calls do nothing; finish() returns it, or
/// complains about keys nobody asked for.
class ConfigReader {
 public:
  /// `guide` is where a person finds the keys: "docs/plan.md".
  ConfigReader(const ConfigNode& table, std::string what, std::string guide = "docs/plan.md");

  enum Need { optional, required };
  bool text(std::string_view name, std::string& out, Need need = optional);
  bool number(std::string_view name, double& out, double minimum, double maximum, Need need = optional);
  bool integer(std::string_view name, std::int64_t& out, std::int64_t minimum, std::int64_t maximum,
               Need need = optional);
  /// A whole number of things, not below `minimum` >= 0.
  bool count(std::string_view name, std::size_t& out, std::int64_t minimum, std::int64_t maximum,
             Need need = optional);
  bool boolean(std::string_view name, bool& out);
  bool texts(std::string_view name, std::vector<std::string>& out, Need need = optional);
  bool choice(std::string_view name, std::string& out, const std::vector<std::string>& choices,
              Need need = optional);
  /// nullptr when absent or of another kind (which is a mistake).
  const ConfigNode* table(std::string_view name, Need need = optional);
  const ConfigNode* array(std::string_view name, Need need = optional);
  /// Marks a key as known without looking at it.
  const ConfigNode* any(std::string_view name);

  void complain(const ConfigNode& at, std::string text, std::string hint = {});
  Result<void> finish();
  bool good() const { return good_; }

 private:
  const ConfigNode* take(std::string_view name, ConfigNode::Kind kind, Need need);

  const ConfigNode& table_;
  std::string what_, guide_;
  std::vector<std::string> known_;
  bool good_ = true;
  Error error_;
};

}  // namespace forcegate
