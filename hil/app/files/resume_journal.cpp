#include "hil/app/files/resume_journal.h"

#include <fstream>
#include <nlohmann/json.hpp>

namespace forcegate {

namespace {

// A header is one object of JSON; of one that was cut short what there is agrees.
bool is_beginning_of_header(const std::string& line, const std::string& header) {
  return header.starts_with(line) || nlohmann::json::parse(line, nullptr, false).is_object();
}

}  // namespace

Result<ResumeJournal> ResumeJournal::open(const std::filesystem::path& path, const std::string& header) {
  ResumeJournal journal;
  if (path.empty()) return journal;
  journal.path_ = path.string();
  std::uintmax_t whole = 0;
  if (std::ifstream old(path, std::ios::binary); old) {
    std::string line;
    bool first = true;
    while (std::getline(old, line)) {
      if (first && !is_beginning_of_header(line, header))
        return fail(ErrorCode::config, "this file is no journal", journal.path_, "it stays as it is: name another file, which is made where it does not exist");
      if (old.eof()) break;
      whole += line.size() + 1;
      if (first && line != header)
        return fail(ErrorCode::config, "the journal belongs to another job or another build", journal.path_,
                    "remove it, or name another file");
      if (!first) {
        const auto j = nlohmann::json::parse(line, nullptr, false);
        if (j.is_object() && j.contains("id") && j["id"].is_string()) journal.finished_[j["id"]] = line;
      }
      first = false;
    }
  }
  std::error_code failed;
  if (whole > 0) std::filesystem::resize_file(path, whole, failed);
  journal.file_.reset(std::fopen(journal.path_.c_str(), whole > 0 ? "ab" : "wb"));
  if (!journal.file_ || failed)
    return fail(ErrorCode::io, "the journal cannot be written", journal.path_, "create its folder first");
  if (whole == 0) journal.keep(header);
  return journal;
}

const std::string* ResumeJournal::find(const std::string& id) const {
  const auto at = finished_.find(id);
  return at == finished_.end() ? nullptr : &at->second;
}

void ResumeJournal::keep(const std::string& line) {
  if (!file_) return;
  const std::string whole = line + "\n";
  const std::lock_guard lock(*turn_);
  failed_ |= std::fwrite(whole.data(), 1, whole.size(), file_.get()) != whole.size() ||
             std::fflush(file_.get()) != 0;
}

Result<void> ResumeJournal::status() const {
  if (failed_)
    return fail(ErrorCode::io, "the journal could not be written to the end", path_, "is the disk full?");
  return {};
}

}  // namespace forcegate
