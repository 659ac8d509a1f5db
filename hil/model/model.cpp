#include "hil/model/model.h"

#include "hil/base/read_file.h"

namespace forcegate {

std::vector<std::string> Model::effect_names() const {
  std::vector<std::string> out;
  for (const ModelEffect& e : effects) out.push_back(e.effect);
  return out;
}

Result<Model> read_model(const std::filesystem::path& path) {
  const Result<std::string> text = read_file(path);
  std::error_code unknown;
  if (!text)
    return fail(ErrorCode::io, std::filesystem::exists(path, unknown) ? "cannot read the model" : "there is no such model file", path.string(),
                "check the name; the models that come with the program are flexiforce and fsr");
  return parse_model(*text, path.string());
}

}  // namespace forcegate
