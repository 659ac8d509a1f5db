#include "hil/app/power/mutant.h"

#include <algorithm>
#include <map>
#include <set>

#include "hil/base/read_file.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr std::string_view kHead[] = {"kind",  "breaks", "promise", "seen by", "note",  "levels",
                                      "order", "unit",   "expect",  "ports",   "flags", "file"};

Result<std::map<std::string, std::string>> read_head(std::string_view text, const std::string& where) {
  std::map<std::string, std::string> head;
  int number = 0;
  for (const std::string& line : split(text, '\n')) {
    ++number;
    if (line == "<<<<") break;
    if (line.empty()) continue;
    const std::size_t colon = line.find(": ");
    const std::string key = line.substr(0, colon);
    if (colon == std::string::npos || std::find(std::begin(kHead), std::end(kHead), key) == std::end(kHead))
      return fail(ErrorCode::config,
                  "this line of a mutant is not understood: '" + printable_utf8(line) + "'",
                  where + ":" + std::to_string(number), "rigs/firmware/mutants/README.md lists the keys");
    head[key] = std::string(trim(std::string_view(line).substr(colon + 2)));
  }
  return head;
}

std::vector<std::string> words(std::string_view text, char separator) {
  std::vector<std::string> out;
  for (const std::string& part : split(text, separator))
    if (const std::string_view word = trim(part); !word.empty()) out.emplace_back(word);
  return out;
}

Result<double> number(const std::string& word, const std::string& where) {
  const std::optional<double> value = read_number(word);
  if (!value)
    return fail(ErrorCode::config, "a level of a mutant is not a number: '" + printable_utf8(word) + "'",
                where);
  return *value;
}

}  // namespace

Result<std::vector<Mutant>> parse_mutant(std::string_view text, const std::string& name,
                                         const std::string& where) {
  FORCEGATE_TRY(auto head, read_head(text, where));
  for (const char* key : {"kind", "breaks", "seen by"})
    if (head[key].empty())
      return fail(ErrorCode::config, "a mutant without '" + std::string(key) + ":'", where,
                  "rigs/firmware/mutants/README.md lists the keys");
  if (head["kind"] != "bad" && head["kind"] != "equivalent")
    return fail(ErrorCode::config, "kind of a mutant must be bad or equivalent, not '" + head["kind"] + "'",
                where);
  Mutant common;
  common.name = common.family = name;
  common.equivalent = head["kind"] == "equivalent";
  common.breaks = head["breaks"];
  common.promise = head["promise"];
  common.note = head["note"];
  common.unit = head["unit"];
  common.seen_by = words(head["seen by"], ',');
  if (common.seen_by.front() == "nothing" && common.note.empty())
    return fail(ErrorCode::config, "a mutant that nothing sees needs 'note:' with the reason", where);
  const std::vector<std::string> levels = words(head["levels"], ' ');
  if (levels.empty()) return std::vector{common};

  std::vector<std::string> tolerable = words(head["expect"], ' ');
  if (!tolerable.empty() && tolerable.front() != "accepted")
    return fail(ErrorCode::config, "'expect:' wants 'accepted' and levels", where);
  std::vector<Mutant> family;
  for (const std::string& level : levels) {
    Mutant m = common;
    m.name = name + "@" + level;
    FORCEGATE_TRY(m.level, number(level, where));
    m.tolerable = std::find(tolerable.begin(), tolerable.end(), level) != tolerable.end();
    family.push_back(std::move(m));
  }
  const bool falling = head["order"] == "falling";
  if (!falling && !head["order"].empty())
    return fail(ErrorCode::config, "order of levels must be 'falling', or not given", where);
  std::stable_sort(family.begin(), family.end(), [falling](const Mutant& a, const Mutant& b) {
    return falling ? *a.level > *b.level : *a.level < *b.level;
  });
  return family;
}

Result<std::vector<Mutant>> read_mutants(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::set<fs::path> descriptions;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".mutant") descriptions.insert(entry.path());
  if (descriptions.empty())
    return fail(ErrorCode::usage, "there are no mutants", folder.string(),
                "build them: cmake --build build --target mutants");
  std::vector<Mutant> all;
  for (const fs::path& path : descriptions) {
    FORCEGATE_TRY(const std::string text, read_file(path));
    FORCEGATE_TRY(std::vector<Mutant> family, parse_mutant(text, path.stem().string(), path.string()));
    for (Mutant& m : family) {
      for (const char* ending : {".native.so", "-m4f.block.elf", "-m3.block.elf", ".uart.elf"})
        if (const fs::path image = folder / (m.name + ending); fs::is_regular_file(image, error))
          m.images.push_back(image);
      all.push_back(std::move(m));
    }
  }
  return all;
}

}  // namespace forcegate
