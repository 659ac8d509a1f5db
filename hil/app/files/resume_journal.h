#pragma once
// Finished pieces of a long job, one JSON line each, so that an interrupted job goes on where it stopped. The first line
// says what the pieces follow from (seed, digest of the program ...): those of another job are not mixed in.

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

class ResumeJournal {
 public:
  /// header: one line of JSON without a line feed. An empty path keeps nothing. Errors: io; config when the file has
  /// another header or is no journal, with the way out; it is left as it is. A last line cut short (power, interrupt) is dropped: that piece is made again.
  static Result<ResumeJournal> open(const std::filesystem::path& path, const std::string& header);

  bool keeps() const { return file_ != nullptr; }
  /// The whole line of a finished piece, a JSON object with this "id"; null when it is not there.
  const std::string* find(const std::string& id) const;
  /// Appends one line of JSON with its "id" and flushes. From any thread.
  void keep(const std::string& line);
  /// The first failure to write.
  Result<void> status() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::unique_ptr<std::mutex> turn_ = std::make_unique<std::mutex>();
  std::map<std::string, std::string> finished_;  ///< id -> line
  std::string path_;
  bool failed_ = false;
};

}  // namespace forcegate
