#include "hil/diagnose/refit/replaced_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "hil/base/text.h"

namespace forcegate::diagnose {
namespace {

std::set<std::string> forms_of(const Model& model, const std::string& effect) {
  std::set<std::string> out;
  for (const ModelEffect& e : model.effects)
    if (e.effect == effect) out.insert(e.form);
  return out;
}

std::string listed(const std::set<std::string>& forms) {
  return (forms.size() > 1 ? "forms " : "form ") + join(std::vector<std::string>(forms.begin(), forms.end()), " and ");
}

}  // namespace

std::vector<std::string> replaced_forms(const Model& before, const Model& after) {
  std::vector<std::string> notes;
  std::set<std::string> seen;
  for (const ModelEffect& e : before.effects) {
    if (!seen.insert(e.effect).second) continue;
    const std::set<std::string> was = forms_of(before, e.effect), is = forms_of(after, e.effect);
    if (!is.empty() && is != was) notes.push_back(fmt::format("{}: {} of the model {} replaced by {}, which these records ask for", e.effect, listed(was), was.size() > 1 ? "were" : "was", listed(is)));
  }
  return notes;
}

}  // namespace forcegate::diagnose
