#pragma once
// Registry of plug-ins by name. A plug-in file holds one line
//   const Registration<Stimulus::Factory> kRegistered{{"sine", ...}};
// and is linked from an OBJECT library (self-registering objects vanish from static libraries).

#include <algorithm>
#include <cassert>
#include <string>
#include <string_view>
#include <vector>

namespace forcegate {

/// Entry must have a member `std::string name`.
template <class Entry>
class Registry {
 public:
  static Registry& instance() {
    static Registry registry;
    return registry;
  }

  void add(Entry entry) {
    assert(find(entry.name) == nullptr && "two plug-ins of one name");
    const auto at = std::lower_bound(entries_.begin(), entries_.end(), entry,
                                     [](const Entry& a, const Entry& b) { return a.name < b.name; });
    entries_.insert(at, std::move(entry));
  }

  /// Sorted by name, so that no listing depends on link order. Pointers stay valid after start-up.
  const std::vector<Entry>& all() const { return entries_; }

  /// nullptr when there is none of that name.
  const Entry* find(std::string_view name) const {
    for (const Entry& entry : entries_)
      if (entry.name == name) return &entry;
    return nullptr;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const Entry& entry : entries_) out.push_back(entry.name);
    return out;
  }

 private:
  std::vector<Entry> entries_;
};

template <class Entry>
struct Registration {
  explicit Registration(Entry entry) { Registry<Entry>::instance().add(std::move(entry)); }
};

}  // namespace forcegate
