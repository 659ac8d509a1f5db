#pragma once
// The folder of a run. It is filled under a temporary name and renamed when it is complete; result.json is
// the last file. Whatever kills the program, the final name holds a whole result or none.

#include <filesystem>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/run_result.h"

namespace forcegate {

/// The run of that name that lies aside as NAME.older-PID since a run was killed, the youngest of them; "" without one.
std::filesystem::path run_put_aside(const std::filesystem::path& final_path);

class RunFolder {
 public:
  /// Puts an older run of that name aside at once, as NAME.older-PID (while this one lasts it must not be taken for it), takes over one that a killed run left
  /// aside, and removes
  /// what else killed runs left and nothing else, but traces: those stay under the name NAME.unfinished-PID. Refuses (usage) a folder that holds anything but a result
  /// of ours, one that another run is filling now (one of the two would be lost), one that the process stands in or that one of
  /// `inputs` lies in, and a symbolic link that leads nowhere; another link is followed.
  static Result<RunFolder> open(const std::filesystem::path& final_path, const std::vector<std::filesystem::path>& inputs = {});
  RunFolder(RunFolder&& other) noexcept;
  RunFolder& operator=(RunFolder&&) = delete;
  ~RunFolder();  ///< if it was not published: removes the temporary folder, but see keep_traces(), and gives the older run its name again

  /// What a bench has played cannot be played again: unless the run is published, its traces stay. Where they will be.
  std::filesystem::path keep_traces();
  /// Journals and traces that are there now, as they will be called when they stay. Empty where none will.
  std::vector<std::filesystem::path> traces_that_stay() const;
  /// Folders of traces that runs which died left under that name, now NAME.unfinished-PID.
  const std::vector<std::filesystem::path>& left_by_others() const { return left_; }

  /// The older run, aside until this one is published; empty without one.
  const std::filesystem::path& older() const { return older_; }
  /// It stays for good: it holds traces that a bench has played.
  bool older_stays() const;

  /// Where to put files before publish().
  const std::filesystem::path& path() const { return temporary_; }

  /// Writes every reporter's file, result.json last, syncs and renames, and removes the older run. Where somebody else has taken the name meanwhile
  /// the folder stays as NAME.run-PID, which the error names.
  Result<void> publish(const RunResult& result);

 private:
  RunFolder() = default;
  void remove_older() const;
  std::filesystem::path final_, temporary_;
  bool keeps_traces_ = false;
  std::vector<std::filesystem::path> left_;
  std::filesystem::path older_;
};

/// The decision stands although its folder does not: RunResult::not_written, and a note of it.
void note_not_written(RunResult& result, Error why);

}  // namespace forcegate
