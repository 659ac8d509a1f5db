// The folder is the list: a plug-in's name is its file's, and the registry holds exactly the files.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "hil/cli/command.h"
#include "hil/interface/controller.h"
#include "hil/interface/dut.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

// A source with a header beside it is a helper of the others, no entry of its own.
std::set<std::string> stems(const std::string& folder) {
  std::set<std::string> out;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(FORCEGATE_SOURCE_DIR "/") + folder)) {
    std::filesystem::path header = entry.path();
    if (header.extension() == ".cpp" && !std::filesystem::exists(header.replace_extension(".h")))
      out.insert(entry.path().stem().string());
  }
  return out;
}

template <class Entry>
std::set<std::string> registered() {
  const auto names = Registry<Entry>::instance().names();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size()) << "a name twice";
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end())) << "listings must not depend on link order";
  return {names.begin(), names.end()};
}

TEST(Registries, StimuliAreTheFilesOfTheirFolder) { EXPECT_EQ(registered<StimulusKind>(), stems("stimuli")); }

// A verb of two words is the file first_second.cpp.
TEST(Registries, VerbsAreTheFilesOfTheirFolder) {
  std::set<std::string> verbs;
  for (std::string name : registered<Command>()) {
    std::replace(name.begin(), name.end(), ' ', '_');
    verbs.insert(std::move(name));
  }
  EXPECT_EQ(verbs, stems("hil/cli/verbs"));
}

TEST(Registries, LanesRigsAndControllersAreLinkedIn) {
  for (const char* lane : {"native", "block", "uart"})
    EXPECT_TRUE(registered<LaneKind>().contains(lane)) << lane;
  for (const char* rig : {"emulated", "replay"}) EXPECT_TRUE(registered<RigKind>().contains(rig)) << rig;
  for (const char* controller : {"open_loop", "force_integral"})
    EXPECT_TRUE(registered<ControllerKind>().contains(controller)) << controller;
}

TEST(Registries, EveryEntrySaysWhatItIs) {
  for (const auto& kind : Registry<StimulusKind>::instance().all())
    EXPECT_GT(kind.doc.size(), 10u) << kind.name;
  for (const auto& kind : Registry<LaneKind>::instance().all()) EXPECT_GT(kind.doc.size(), 10u) << kind.name;
  for (const auto& kind : Registry<RigKind>::instance().all()) EXPECT_GT(kind.doc.size(), 10u) << kind.name;
  for (const auto& kind : Registry<ControllerKind>::instance().all())
    EXPECT_GT(kind.doc.size(), 10u) << kind.name;
}

TEST(CommandTable, RowsAreCompleteAndTheirNamesUnique) {
  for (const Command& row : Registry<Command>::instance().all()) {
    EXPECT_TRUE(row.run) << row.name;
    EXPECT_GT(row.summary.size(), 10u) << row.name;
    EXPECT_NE(row.summary.back(), '.') << row.name;
    EXPECT_FALSE(row.group.empty()) << row.name;
    EXPECT_FALSE(row.exit_codes.empty()) << row.name;
    if (!row.hidden) {
      EXPECT_GT(row.description.size(), 60u) << row.name << " must teach";
      EXPECT_FALSE(row.examples.empty()) << row.name;
    }
    for (const Example& e : row.examples)
      EXPECT_NE(e.command.find("forcegate " + row.name), std::string::npos) << row.name;
    std::set<std::string> names = {"json", "color", "quiet", "help", "version"};
    std::set<char> letters = {'q', 'h'};
    for (const Option& o : row.options) {
      EXPECT_TRUE(names.insert(o.name).second) << row.name << " --" << o.name;
      if (o.letter != 0) {
        EXPECT_TRUE(letters.insert(o.letter).second) << row.name << " -" << o.letter;
      }
      EXPECT_FALSE(o.doc.empty()) << row.name << " --" << o.name;
      EXPECT_FALSE(o.value_name.empty() && (o.required || !o.fallback.empty()))
          << row.name << " --" << o.name;
    }
    for (std::size_t i = 0; i < row.positionals.size(); ++i) {
      EXPECT_TRUE(names.insert(row.positionals[i].name).second) << row.name;
      EXPECT_FALSE(row.positionals[i].repeatable && i + 1 < row.positionals.size())
          << row.name << ": only the last";
    }
  }
}

// Whoever writes a verb says which of its values are files: only then does no output of it replace an input.
TEST(CommandTable, EveryValueThatIsAFileSaysWhetherItIsReadOrWritten) {
  const std::set<std::string> files = {"FILE", "FOLDER", "DIR", "CAMPAIGN", "MODEL", "PLAN", "RUN", "FIRMWARE", "JOURNAL", "FROM", "TO", "TABLE", "RESULT",
                                       "RUN_A", "RUN_B", "SOURCE", "IMAGE|RUN", "NAME|FILE"};
  // gone on with, or a folder that twins share
  const std::set<std::string> by_themselves = {"journal", "history", "attach", "folder"};
  for (const Command& row : Registry<Command>::instance().all()) {
    if (row.hidden) continue;
    for (const Option& o : row.options)
      EXPECT_TRUE(!files.contains(o.value_name) || by_themselves.contains(o.name) || o.names != Names::nothing) << row.name << " --" << o.name;
    for (const Positional& p : row.positionals)
      EXPECT_TRUE(!files.contains(p.name) || p.names != Names::nothing) << row.name << " " << p.name;
  }
}

}  // namespace
}  // namespace forcegate
